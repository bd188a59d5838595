"""The golden packets: written anew they are the same, decoded they give their fields."""

import hashlib
import math
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from tests.wire.cases import BAD, GOLDEN, VECTORS, Vector

from recon import wire

ERRORS = {
    "short": wire.ShortError,
    "sync": wire.SyncError,
    "size": wire.SizeError,
    "hash": wire.HashError,
}


def name(vector: Vector) -> str:
    return vector.name


def test_the_script_writes_the_vectors_that_are_committed(tmp_path: Path) -> None:
    script = VECTORS / "make_vectors.py"
    subprocess.run([sys.executable, "-B", str(script), str(tmp_path)], check=True)
    written = {p.relative_to(tmp_path): p.read_bytes() for p in tmp_path.glob("*/*")}
    committed = {p.relative_to(VECTORS): p.read_bytes() for p in VECTORS.glob("*/*")}
    own = {p: d for p, d in committed.items() if p.suffix in (".bin", ".json")}
    # Mission files have a script of their own; texts of apps are written by hand.
    others = ("wpml", "app_texts")
    assert {p: d for p, d in own.items() if p.parent.name not in others} == written


@pytest.mark.parametrize("vector", GOLDEN, ids=name)
def test_a_golden_packet_encodes_to_its_bytes_again(vector: Vector) -> None:
    assert wire.encode(wire.decode(vector.data)) == vector.data


def same(value: Any, expected: int | str) -> bool:
    """Whether a field is what its vector states; NaN payloads are checked by the bytes instead."""
    if isinstance(value, bytes):
        return value.hex() == expected
    if isinstance(value, int) or isinstance(expected, int):
        return bool(value == expected)
    wide = len(expected) == 16
    came = struct.unpack(">d" if wide else ">f", bytes.fromhex(expected))[0]
    if math.isnan(came):
        return math.isnan(value)
    return struct.pack(">d", value) == struct.pack(">d", came)


def check_fields(packet: Any, fields: dict[str, Any]) -> None:
    for field, expected in fields.items():
        if field == "waypoints":
            assert len(packet.waypoints) == len(expected)
            for waypoint, its_fields in zip(packet.waypoints, expected, strict=True):
                check_fields(waypoint, its_fields)
        elif field == "pixels_sha256":
            assert packet.pixels.shape == (fields["rows"], fields["cols"], 3)
            assert hashlib.sha256(packet.pixels.tobytes()).hexdigest() == expected
        elif field == "jpeg_sha256":
            assert hashlib.sha256(packet.jpeg).hexdigest() == expected
        elif field not in ("rows", "cols"):
            assert same(getattr(packet, field), expected), field


@pytest.mark.parametrize("vector", GOLDEN, ids=name)
def test_a_golden_packet_decodes_to_its_fields(vector: Vector) -> None:
    packet = wire.decode(vector.data)
    pid = packet.pid if isinstance(packet, wire.UnknownPacket) else packet.PID
    assert pid == vector.description["pid"]
    check_fields(packet, vector.description["fields"])


@pytest.mark.parametrize("vector", [v for v in BAD if v.description["decode"]], ids=name)
def test_a_bad_frame_raises_the_error_it_names(vector: Vector) -> None:
    with pytest.raises(ERRORS[vector.description["decode"]]) as caught:
        wire.decode(vector.data)
    assert caught.value.expected in str(caught.value)
    assert caught.value.came in str(caught.value)


@pytest.mark.parametrize("read_bytes", [1, 5, 1 << 20])
@pytest.mark.parametrize("vector", BAD, ids=name)
def test_a_bad_stream_gives_every_intact_packet(vector: Vector, read_bytes: int) -> None:
    deframer = wire.Deframer()
    packets = []
    for start in range(0, len(vector.data), read_bytes):
        packets += deframer.feed(vector.data[start : start + read_bytes], 0)
    packets += deframer.finish()
    assert [wire.encode(packet).hex() for packet in packets] == vector.description["frames"]
    for counter, expected in vector.description["counters"].items():
        assert getattr(deframer.counters, counter) == expected, counter
    assert deframer.pending_bytes == 0
