"""Wireshark shows the golden packets with their fields, and finds the next one behind damage."""

import hashlib
import math
import struct
import tomllib
from collections.abc import Mapping, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest
from tests.protocol.captures import (
    DISSECTOR,
    Connection,
    Shown,
    segments,
    shown_packets,
    write_capture,
)
from tests.wire.cases import BAD, GOLDEN, Vector

from recon import wire

PORT = 3001
BY_APPS = [vector for vector in GOLDEN if vector.description["pid"] < 252]
BY_STATION = [vector for vector in GOLDEN if vector.description["pid"] >= 252]
HEADER_BYTES = 7
WRONG_HASH = "wrong hash: the packet is damaged"
OF_EACH = {
    *("recon.sync", "recon.size", "recon.pid", "recon.payload", "recon.hash"),
    *("recon.hash.wrong", "recon.pid.unknown", "_ws.expert.severity", "_ws.expert.group"),
}
TABLE = tomllib.loads((DISSECTOR.parent / "recon-drone.toml").read_text("utf-8"))
FLOATS = {
    field["name"]
    for owner in (*TABLE["packets"], TABLE["waypoint"])
    for field in owner["fields"]
    if field["type"] in ("f32", "f64")
}


def stream(vectors: Sequence[Vector]) -> bytes:
    return b"".join(vector.data for vector in vectors)


def is_float_of(shown: str, bits: str) -> bool:
    """Whether a text is the float of these bits, to the digits that are shown."""
    value = struct.unpack(">f" if len(bits) == 8 else ">d", bytes.fromhex(bits))[0]
    if math.isnan(value):
        return math.isnan(float(shown))
    if math.isinf(value):
        return float(shown) == value
    # The largest float, rounded up, is no float any more.
    difference = abs(Decimal(shown) - Decimal(value))
    return difference <= Decimal("1e-5") * abs(Decimal(value))


def check(name: str, found: Sequence[tuple[str, bytes]], expected: Sequence[Any]) -> None:
    """Compare what is shown of a field with what vectors state: integers, bits, or text as hex."""
    expected = [each for each in expected if each != ""]
    assert len(found) == len(expected), name
    for (shown, data), value in zip(found, expected, strict=True):
        if isinstance(value, int):
            assert int(shown) == value, name
        else:
            assert data.hex() == value, name
            assert name not in FLOATS or is_float_of(shown, value), name


def check_fields(shown: Shown, owner: str, fields: Mapping[str, Any]) -> None:
    for name, value in fields.items():
        if name == "waypoints":
            for inner in value[0]:
                found = shown.fields[f"recon.waypoint.{inner}"]
                check(inner, found, [point[inner] for point in value])
        elif name.endswith("_sha256"):
            found = shown.fields.get(f"{owner}.{name.removesuffix('_sha256')}", [("", b"")])
            ((_, data),) = found
            assert hashlib.sha256(data).hexdigest() == value
        else:
            check(name, shown.fields.get(f"{owner}.{name}", []), [value])


def check_packet(shown: Shown, vector: Vector) -> None:
    owner, unknown = f"recon.{vector.name.split('/')[0]}", "recon.unknown_packet"
    size, pid = len(vector.data), vector.description["pid"]
    check_fields(shown, "recon", {"sync": "daa7", "size": size, "pid": pid})
    check_fields(shown, "recon" if owner == unknown else owner, vector.description["fields"])
    check("hash", shown.fields["recon.hash"], [vector.data[-2:].hex()])
    assert shown.data == vector.data
    assert ("a PID that the document does not have" in shown.notes) == (owner == unknown)
    assert "recon.skipped" not in shown.fields


@pytest.mark.parametrize(("port", "first"), [(PORT, 1), (4444, HEADER_BYTES)])
def test_every_field_of_every_golden_packet_is_shown(port: int, first: int, tmp_path: Path) -> None:
    """On the port at any beginning; on others where a segment begins with a header."""
    parts = (segments(stream(some), 7, first) for some in (BY_APPS, BY_STATION))
    write_capture(tmp_path / "golden.pcap", [Connection(port, *parts)])
    shown = shown_packets(tmp_path / "golden.pcap")
    assert len(shown) == len(GOLDEN)
    for each, vector in zip(shown, [*BY_APPS, *BY_STATION], strict=True):
        check_packet(each, vector)


def test_behind_damage_the_next_packet_is_found(tmp_path: Path) -> None:
    """A header that claims more than follows hides it: no time passes in a capture."""
    streams = [vector for vector in BAD if vector.data and is_found_at_once(vector)]
    assert len(streams) >= 30
    connections = [Connection(PORT, segments(vector.data, 5)) for vector in streams]
    write_capture(tmp_path / "bad.pcap", connections)
    shown = shown_packets(tmp_path / "bad.pcap")
    for number, vector in enumerate(streams):
        mine = [each for each in shown if each.connection == number]
        packets = [each for each in mine if "recon.sync" in each.fields]
        damaged = [each for each in packets if WRONG_HASH in each.notes]
        whole = [each for each in packets if WRONG_HASH not in each.notes]
        assert [each.data.hex() for each in whole] == vector.description["frames"], vector.name
        counted = vector.description["counters"].get("bad_hash", len(damaged))
        assert len(damaged) == counted, vector.name
        # Their values are not shown as if they were true.
        assert all(set(each.fields) <= OF_EACH for each in damaged), vector.name


def test_false_headers_do_not_hide_what_comes_later(tmp_path: Path) -> None:
    """Headers in headers, as many as there is room for: each would be a packet of 20 kB."""
    ack = next(vector.data for vector in GOLDEN if vector.name == "acknowledgment/mission_accepted")
    unknown_pid = 7
    false = struct.pack(">HIB", 55975, 20_000, unknown_pid) * 5_000 + bytes(20_000)
    streams = [b"\xda\xa7" * 20_000 + ack, false + ack]
    parts = [[each[at : at + 9_000] for at in range(0, len(each), 9_000)] for each in streams]
    write_capture(tmp_path / "false.pcap", [Connection(PORT, each) for each in parts])
    shown = shown_packets(tmp_path / "false.pcap")
    for number in range(len(streams)):
        assert [each for each in shown if each.connection == number][-1].data == ack


def is_found_at_once(vector: Vector) -> bool:
    """Whether every packet is found before the stream ends."""
    found = wire.Deframer().feed(vector.data, 0)
    return [wire.encode(each).hex() for each in found] == vector.description["frames"]
