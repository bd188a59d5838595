"""The packet classes: frozen, equal by bits, faithful, and clear about what does not fit."""

import math
import struct
from typing import Any

import pytest
from hypothesis import given
from tests.wire.cases import packets

from recon import wire

ACK = wire.Acknowledgment(positive=1, source_pid=253)


@given(packets)
def test_a_packet_survives_the_wire(packet: wire.Packet) -> None:
    frame = wire.encode(packet)
    decoded = wire.decode(frame)
    assert decoded == packet
    assert wire.encode(decoded) == frame
    assert wire.checksum(frame[:-2]) == tuple(frame[-2:])


def test_the_documents_examples() -> None:
    assert wire.encode(ACK).hex() == "daa70000000b0301fd8d16"
    assert wire.encode(wire.EmergencyCommand(action=0)).hex() == "daa70000000aff008a7d"


def test_the_hash_is_as_weak_as_the_document_makes_it() -> None:
    assert wire.checksum(bytes(3)) == wire.checksum(bytes([1, 254, 1])) == (0, 0)
    assert wire.checksum(bytearray(b"\x01\xff")) == (0, 1)


def test_a_signalling_nan_keeps_its_bits() -> None:
    frame = bytearray(wire.encode(wire.CameraControl(action=1, target_fps_hz=1.0)))
    frame[8:12] = bytes.fromhex("ff8abcde")
    frame[-2:] = bytes(wire.checksum(frame[:-2]))
    packet = wire.decode(frame)
    assert isinstance(packet, wire.CameraControl)
    assert math.isnan(packet.target_fps_hz)
    assert wire.encode(packet) == frame


def test_equality_is_by_bits() -> None:
    def camera(fps_hz: float) -> wire.CameraControl:
        return wire.CameraControl(action=1, target_fps_hz=fps_hz)

    assert camera(math.nan) == camera(math.nan)
    assert hash(camera(math.nan)) == hash(camera(math.nan))
    assert camera(0.0) != camera(-0.0)
    assert camera(1.0) != wire.EmergencyCommand(action=1)
    assert len({camera(1.0), camera(1.0), camera(2.0)}) == 2


@pytest.mark.parametrize("name", ["positive", "source_pid", "PID", "new"])
def test_packets_are_frozen(name: str) -> None:
    with pytest.raises(AttributeError):
        setattr(ACK, name, 1)


def test_packets_print_harmlessly() -> None:
    message = wire.MessageString(type=1, text=b"\x1b[31m\xff")
    assert repr(message) == r'MessageString(type=1, text=b"\x1b[31m\xff")'
    assert repr(ACK) == "Acknowledgment(positive=1, source_pid=253)"
    stick = wire.CameraControl(action=1, target_fps_hz=math.nan)
    assert repr(stick) == "CameraControl(action=1, target_fps_hz=nan)"


def mission(count: int) -> wire.ExecuteWaypointMission:
    waypoint = wire.Waypoint(
        latitude_deg=44.0,
        longitude_deg=-93.0,
        altitude_m=300.0,
        corner_radius_m=0.2,
        speed_mps=5.0,
        loiter_time_s=math.nan,
        gimbal_pitch_deg=math.nan,
    )
    return wire.ExecuteWaypointMission(
        land_at_end=0, curved_flight=0, waypoints=(waypoint for _ in range(count))
    )


@pytest.mark.parametrize(
    ("make", "expected", "came"),
    [
        (lambda: wire.Acknowledgment(positive=256, source_pid=0), "0 to 255", "256"),
        (lambda: wire.EmergencyCommand(action=-1), "0 to 255", "-1"),
        (
            lambda: wire.CameraControl(action=1, target_fps_hz=1e300),
            "at most 3.4028235e38",
            "1e+300",
        ),
        (lambda: wire.encode(mission(0)), "at least 1 waypoint", "0"),
        (lambda: wire.encode(mission(100)), "at most 99 waypoints", "100"),
        (lambda: wire.encode(wire.UnknownPacket(pid=3, payload=b"")), "a PID that", "3"),
        (
            lambda: wire.encode(wire.MessageString(type=0, text=bytes(65537))),
            "at most 65536",
            "65537",
        ),
        (
            lambda: wire.encode(wire.CompressedImage(target_fps_hz=1, jpeg=bytes(5)), LOW),
            "at most 4 bytes",
            "5",
        ),
    ],
)
def test_what_does_not_fit_is_refused_in_words(make: Any, expected: str, came: str) -> None:
    with pytest.raises(wire.FieldError) as caught:
        make()
    assert caught.value.expected.startswith(expected)
    assert caught.value.came == came
    assert isinstance(caught.value, wire.WireError)


LOW = wire.Limits(max_jpeg_bytes=4, max_waypoints=2)


def test_limits_move_what_fits() -> None:
    assert LOW.max_jpeg_bytes == 4
    assert LOW.max_message_bytes == wire.Limits().max_message_bytes == 65536
    frame = wire.encode(mission(3))
    with pytest.raises(wire.SizeError, match="from 1 to 2"):
        wire.decode(frame, LOW)
    assert wire.decode(frame, wire.Limits(max_waypoints=3)) == mission(3)
    wide = wire.Limits(max_waypoints=500)
    assert wire.decode(wire.encode(mission(500), wide), wide) == mission(500)


def test_wrong_types_are_type_errors() -> None:
    for wrong in ("1", 1.5, None):
        with pytest.raises(TypeError):
            wire.EmergencyCommand(action=wrong)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"a packet of recon\.wire, came int"):
        wire.encode(1)  # type: ignore[arg-type]


@given(packets)
def test_a_core_float_is_the_float_that_travels(packet: wire.Packet) -> None:
    if isinstance(packet, wire.CoreTelemetry) and not math.isnan(packet.latitude_deg):
        assert wire.encode(packet)[8:16] == struct.pack(">d", packet.latitude_deg)
