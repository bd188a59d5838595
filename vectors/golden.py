"""Well-formed packets: typical, extreme and outside the enumerations."""

import hashlib
import struct
from collections.abc import Iterator

from document import (
    ACKNOWLEDGMENT,
    CAMERA,
    CORE,
    EMERGENCY,
    EXTENDED,
    FPS,
    INF,
    MAX32,
    MAX64,
    MISSION,
    NAN32,
    NAN64,
    SIGNALLING32,
    SIGNALLING64,
    STICK,
    TINY32,
    TINY64,
    WAYPOINT,
    Number,
    frame,
    pack,
    pattern,
    row,
    shown,
    string,
)

Golden = tuple[str, str, int, bytes, dict[str, object]]


def fixed(
    folder: str, pid: int, fields: list[tuple[str, str]], cases: dict[str, tuple[Number, ...]]
) -> Iterator[Golden]:
    """Cases of a packet that is one row of primitive fields."""
    for name, values in cases.items():
        case = row(fields, *values)
        yield folder, name, pid, pack(fields, case), dict(shown(fields, case))


def core_telemetry() -> Iterator[Golden]:
    """ICD 3.1.1."""
    yield from fixed("core_telemetry", 0, CORE, {
        "typical": (1, 44.9731, -93.2359, 287.4, 61.25, 3.5, -1.25, 0.1, 92.5, -4.0, 1.5),
        "on_ground_without_fix": (0,) + (0.0,) * 10,
        "largest": (255, *[MAX64] * 4, *[MAX32] * 3, *[MAX64] * 3),
        "smallest": (1, *[TINY64] * 4, *[TINY32] * 3, *[TINY64] * 3),
        "negative_zero": (1, *[-0.0] * 10),
        "infinite": (1, INF, -INF, INF, -INF, INF, -INF, INF, -INF, INF, -INF),
        "not_a_number": (1, *[NAN64] * 4, *[NAN32] * 3, *[NAN64] * 3),
        "signalling_nan": (2, *[SIGNALLING64] * 4, *[SIGNALLING32] * 3, *[SIGNALLING64] * 3),
        "far_corner": (1, -90.0, 180.0, -430.5, -12.5, -23.0, 23.0, -5.0, -180.0, 90.0, -179.999),
    })  # fmt: skip


def extended_telemetry() -> Iterator[Golden]:
    """ICD 3.1.2."""
    cases: dict[str, tuple[tuple[Number, ...], bytes]] = {
        "typical": ((17, 5, 0, 0, 83, 0, 1, 2, 10, 4711), b"1ZNBH1D00C00FK"),
        "empty_serial": ((0, -1, 0, 0, 0, 2, -1, 0, 255, 0), b""),
        "placeholder_serial": ((9, 3, 0, 0, 50, 1, 0, 1, 3, 0), b"00000"),
        "non_ascii_serial": ((12, 4, 1, 1, 77, 0, 2, 1, 12, 1), "Feldlerche-ä-鷹-🚁".encode()),
        "serial_not_utf8": ((12, 4, 0, 0, 77, 0, 0, 1, 3, 0), b"\xff\xfe\x80 \x1b[31m\x00"),
        "longest_serial": ((12, 4, 0, 0, 77, 0, 0, 1, 3, 0), b"S" * 256),
        "largest": ((65535, 127, 255, 255, 255, 255, 127, 255, 255, 65535), b"X"),
        "smallest": ((0, -128, 0, 0, 0, 0, -128, 0, 0, 0), b"X"),
        "sync_in_serial": ((12, 4, 0, 0, 77, 0, 0, 1, 3, 0), bytes.fromhex("daa70000000b03")),
    }
    for name, (values, serial) in cases.items():
        case = row(EXTENDED, *values)
        fields = shown(EXTENDED, case) | {"serial": serial.hex()}
        yield "extended_telemetry", name, 1, pack(EXTENDED, case) + string(serial), dict(fields)


def image() -> Iterator[Golden]:
    """ICD 3.1.3."""
    hidden = frame(3, b"\x01\xfd")
    cases: dict[str, tuple[Number, int, int, bytes]] = {
        "one_pixel": (1.0, 1, 1, b"\x01\x02\x03"),
        "640x360": (5.0, 360, 640, pattern(640 * 360 * 3)),
        "empty": (0.0, 0, 0, b""),
        "one_row": (29.97, 1, 7, pattern(21)),
        "one_column": (0.5, 7, 1, pattern(21)),
        "fps_nan": (SIGNALLING32, 2, 2, pattern(12)),
        "whole_packet_in_pixels": (1.0, 2, 4, b"\x05" * 6 + hidden + b"\x05" * 7),
    }
    for name, (fps, rows, cols, pixels) in cases.items():
        head = row(FPS, fps)
        payload = pack(FPS, head) + struct.pack(">HH", rows, cols) + pixels
        fields: dict[str, object] = {**shown(FPS, head), "rows": rows, "cols": cols}
        yield (
            "image",
            name,
            2,
            payload,
            {**fields, "pixels_sha256": hashlib.sha256(pixels).hexdigest()},
        )


def text_and_file() -> Iterator[Golden]:
    """Message String and Compressed Image of the later revisions."""
    messages = {
        "typical": (1, b"Mission uploaded"),
        "empty": (0, b""),
        "warning": (2, b"Compass interference"),
        "non_ascii": (3, "Höhe über 120 m ☂".encode()),
        "not_utf8": (255, b"\xc3\x28\xa0\x1b]0;title\x07"),
        "one_kilobyte": (1, b"0123456789abcdef" * 64),
    }
    for name, (kind, text) in messages.items():
        fields = {"type": kind, "text": text.hex()}
        yield "message_string", name, 4, bytes([kind]) + string(text), dict(fields)
    files: dict[str, tuple[Number, bytes]] = {
        "typical": (2.0, bytes.fromhex("ffd8ffe000104a46494600010100000100010000ffd9")),
        "empty": (0.0, b""),
        "one_byte": (1.0, b"\xff"),
        "no_jpeg_at_all": (1.0, b"not a JPEG file"),
        "fps_nan": (SIGNALLING32, b"\xff\xd8\xff\xd9"),
        "20_kilobytes": (5.0, b"\xff\xd8" + pattern(20_000) + b"\xff\xd9"),
    }
    for name, (fps, jpeg) in files.items():
        head = row(FPS, fps)
        digest = hashlib.sha256(jpeg).hexdigest()
        described: dict[str, object] = {**shown(FPS, head), "jpeg_sha256": digest}
        yield "compressed_image", name, 5, pack(FPS, head) + jpeg, described


def short_packets() -> Iterator[Golden]:
    """ICD 3.1.4, 3.2.1, 3.2.2 and 3.2.4."""
    yield from fixed("acknowledgment", 3, ACKNOWLEDGMENT, {
        "mission_accepted": (1, 253), "mission_refused": (0, 253), "stick_accepted": (1, 252),
        "camera_accepted": (1, 254), "emergency_accepted": (1, 255), "outside": (200, 7),
    })  # fmt: skip
    yield from fixed("emergency_command", 255, EMERGENCY, {
        "hover": (0,), "land_now": (1,), "return_home": (2,), "outside_enumeration": (3,),
        "middle": (128,), "largest": (255,),
    })  # fmt: skip
    yield from fixed("camera_control", 254, CAMERA, {
        "start": (1, 2.0), "stop": (0, 0.0), "slow": (1, 0.1), "fps_nan": (1, SIGNALLING32),
        "fps_infinite": (1, INF), "outside_enumeration": (255, MAX32), "fps_negative": (1, -1.0),
    })  # fmt: skip
    yield from fixed("virtual_stick_command", 252, STICK, {
        "mode_a": (0, 90.0, 5.0, -2.5, 30.0, 0.5), "mode_b": (1, -180.0, 15.0, -15.0, 500.0, 1.0),
        "zeros": (0, 0.0, 0.0, 0.0, 0.0, 0.0), "outside_enumeration": (77, *[MAX32] * 5),
        "not_a_number": (1, *[NAN32] * 5), "signalling_nan": (1, *[SIGNALLING32] * 5),
        "infinite": (1, INF, -INF, INF, -INF, INF),
    })  # fmt: skip


def missions() -> Iterator[Golden]:
    """ICD 3.2.3."""

    def point(i: int, loiter: Number = NAN32, pitch: Number = NAN32) -> dict[str, Number]:
        return row(
            WAYPOINT, 44.97 + i / 8192, -93.23 - i / 4096, 310.0 + i, 0.2, 5.0, loiter, pitch
        )

    cases: dict[str, tuple[int, int, list[dict[str, Number]]]] = {
        "typical": (0, 0, [point(0), point(1, 2.5, -90.0), point(2)]),
        "one_waypoint": (1, 0, [point(0, 5.0, -45.0)]),
        "99_waypoints": (1, 1, [point(i) for i in range(99)]),
        "loiter_not_a_number": (0, 0, [point(0, NAN32, -30.0), point(1, 3.0, NAN32)]),
        "signalling_nan": (
            0,
            0,
            [row(WAYPOINT, *[SIGNALLING64] * 3, *[SIGNALLING32] * 4)],
        ),
        "outside_enumeration": (9, 255, [point(0), point(1)]),
        "largest": (1, 1, [row(WAYPOINT, *[MAX64] * 3, *[MAX32] * 4)] * 2),
    }
    for name, (land, curved, waypoints) in cases.items():
        head = row(MISSION, land, curved)
        payload = pack(MISSION, head) + b"".join(pack(WAYPOINT, point) for point in waypoints)
        fields = shown(MISSION, head) | {"waypoints": [shown(WAYPOINT, p) for p in waypoints]}
        yield "execute_waypoint_mission", name, 253, payload, dict(fields)


def unknown_packets() -> Iterator[Golden]:
    """Well-framed packets with a PID that the document does not have."""
    cases = {
        "empty": (6, b""), "one_byte": (100, b"\x00"), "sync_inside": (200, b"\xda\xa7" * 20),
        "highest_pid": (251, b"payload"), "telemetry_inside": (7, frame(3, b"\x01\xff")),
        "one_kilobyte": (66, pattern(1024)),
    }  # fmt: skip
    for name, (pid, payload) in cases.items():
        yield "unknown_packet", name, pid, payload, {"payload": payload.hex()}


def golden() -> Iterator[Golden]:
    """Every well-formed case: folder, name, PID, payload, fields."""
    yield from core_telemetry()
    yield from extended_telemetry()
    yield from image()
    yield from text_and_file()
    yield from short_packets()
    yield from missions()
    yield from unknown_packets()
