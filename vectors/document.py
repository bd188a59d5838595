"""The document's field tables, framing and hash, with `struct` alone."""

import struct
from typing import NamedTuple

SYNC = 55975


class Bits(NamedTuple):
    """A float given by its bits: the only way to write a particular NaN."""

    bits: int


Number = int | float | Bits

# ICD 3.1.1 to 3.2.4: fields in wire order, with struct's letter for their type.
CORE = [
    ("is_flying", "B"), ("latitude_deg", "d"), ("longitude_deg", "d"), ("altitude_m", "d"),
    ("height_above_takeoff_m", "d"), ("velocity_north_mps", "f"), ("velocity_east_mps", "f"),
    ("velocity_down_mps", "f"), ("yaw_deg", "d"), ("pitch_deg", "d"), ("roll_deg", "d"),
]  # fmt: skip
EXTENDED = [
    ("gnss_satellite_count", "H"), ("gnss_signal_level", "b"), ("max_height_reached", "B"),
    ("max_distance_reached", "B"), ("battery_percent", "B"), ("battery_warning", "B"),
    ("wind_level", "b"), ("camera_state", "B"), ("flight_mode", "B"), ("mission_id", "H"),
]  # fmt: skip
WAYPOINT = [
    ("latitude_deg", "d"), ("longitude_deg", "d"), ("altitude_m", "d"), ("corner_radius_m", "f"),
    ("speed_mps", "f"), ("loiter_time_s", "f"), ("gimbal_pitch_deg", "f"),
]  # fmt: skip
ACKNOWLEDGMENT = [("positive", "B"), ("source_pid", "B")]
EMERGENCY = [("action", "B")]
CAMERA = [("action", "B"), ("target_fps_hz", "f")]
STICK = [
    ("mode", "B"), ("yaw_deg", "f"), ("velocity_x_mps", "f"), ("velocity_y_mps", "f"),
    ("height_above_takeoff_m", "f"), ("timeout_s", "f"),
]  # fmt: skip
FPS = [("target_fps_hz", "f")]
MISSION = [("land_at_end", "B"), ("curved_flight", "B")]
TYPE = [("type", "B")]

NAN64, SIGNALLING64 = Bits(0x7FF8000000000000), Bits(0xFFF0000000C0FFEE)
NAN32, SIGNALLING32 = Bits(0x7FC00000), Bits(0xFF8ABCDE)
INF = float("inf")
MAX32, TINY32 = Bits(0x7F7FFFFF), Bits(0x00000001)
MAX64, TINY64 = Bits(0x7FEFFFFFFFFFFFFF), Bits(0x0000000000000001)


def row(fields: list[tuple[str, str]], *values: Number) -> dict[str, Number]:
    """Values by field name."""
    return dict(zip((name for name, _ in fields), values, strict=True))


def pack(fields: list[tuple[str, str]], case: dict[str, Number]) -> bytes:
    """Fields as wire bytes, most significant byte first."""
    packed = b""
    for name, letter in fields:
        value = case[name]
        if isinstance(value, Bits):
            letter, value = {"f": "I", "d": "Q"}[letter], value.bits
        packed += struct.pack(">" + letter, value)
    return packed


def shown(fields: list[tuple[str, str]], case: dict[str, Number]) -> dict[str, int | str]:
    """Fields for the JSON file: integers as they are, floats as the hex of their bits."""
    return {
        name: case[name] if letter in "BbH" else pack([(name, letter)], case).hex()  # type: ignore[misc]
        for name, letter in fields
    }


def checksum(data: bytes) -> bytes:
    """The hash of ICD 3.3.1, as printed there."""
    a = b = 0
    for byte in data:
        a = (a + byte) & 0xFF
        b = (b + a) & 0xFF
    return bytes((a, b))


def frame(pid: int, payload: bytes, size: int | None = None) -> bytes:
    """A frame around `payload`; with a false `size` field when one is given (its hash is good)."""
    head = struct.pack(">HIB", SYNC, len(payload) + 9 if size is None else size, pid)
    return head + payload + checksum(head + payload)


def string(data: bytes) -> bytes:
    """A String of the ICD's table 2."""
    return struct.pack(">I", len(data)) + data


def pattern(count: int) -> bytes:
    """Bytes that repeat late enough to show a displaced pixel."""
    return bytes((7 * i + i // 251) & 0xFF for i in range(count))
