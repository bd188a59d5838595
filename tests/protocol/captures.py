"""Captures of TCP connections that tests make themselves, and what tshark shows of them."""

import json
import os
import shutil
import struct
import subprocess
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

import pytest

DISSECTOR = Path(__file__).parents[2] / "protocol" / "recon.lua"
APP, STATION = bytes((10, 0, 0, 2)), bytes((10, 0, 0, 1))
FIRST_APP_PORT = 40_000
PUSHED = 0x18
"""Flags of a segment with data: ACK and PSH."""
Pairs = list[tuple[str, Any]]


class Connection(NamedTuple):
    """Segments from an app to the station's port, and then those back."""

    station_port: int
    up: Iterable[bytes]
    down: Iterable[bytes] = ()


class Shown(NamedTuple):
    """One packet as tshark shows it."""

    connection: int
    data: bytes
    """All bytes of the packet."""
    fields: dict[str, list[tuple[str, bytes]]]
    """Values and bytes by the name of the field."""
    notes: tuple[str, ...]
    """Remarks of the dissector about it."""


def segments(stream: bytes, seed: int, first: int = 1) -> Iterator[bytes]:
    """Yield a stream in segments of odd sizes, of which the first has at least `first` bytes."""
    random, at = Random(seed), 0
    while at < len(stream):
        size = random.choice((1, 2, 5, 7, 11, 100, *[1460] * 20, *[9000] * 20))
        size = max(size, first) if at == 0 else size
        yield stream[at : at + size]
        at += size


def write_capture(path: Path, connections: Sequence[Connection]) -> None:
    """Write the connections, one after the other, as a pcap of Ethernet frames."""
    with path.open("wb") as file:
        file.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 1))
        for number, packet in enumerate(_packets(connections)):
            times = number // 1000, number % 1000 * 1000
            file.write(struct.pack("<IIII", *times, len(packet), len(packet)) + packet)


def _packets(connections: Sequence[Connection]) -> Iterator[bytes]:
    for number, connection in enumerate(connections):
        ends = (APP, FIRST_APP_PORT + number), (STATION, connection.station_port)
        sent = [1, 1]
        for side, parts in enumerate((connection.up, connection.down)):
            for part in parts:
                source, target = ends[side], ends[1 - side]
                yield _ethernet(source, target, (sent[side], sent[1 - side]), part)
                sent[side] += len(part)


def _ethernet(
    source: tuple[bytes, int], target: tuple[bytes, int], numbers: tuple[int, int], data: bytes
) -> bytes:
    ports = source[1], target[1]
    tcp = struct.pack(">HHIIBBHHH", *ports, *numbers, 5 << 4, PUSHED, 65535, 0, 0)
    length = 20 + len(tcp) + len(data)
    ip = struct.pack(">BBHHHBBH4s4s", 0x45, 0, length, 0, 0, 64, 6, 0, source[0], target[0])
    return bytes(12) + b"\x08\x00" + ip + tcp + data


def tshark() -> str:
    """Return tshark's path; skips the test without it."""
    found = shutil.which("tshark")
    if found is None:
        pytest.skip("tshark is not here: `make test-dissector` installs it")
    return found


def shown_packets(capture: Path) -> list[Shown]:
    """Return what the dissector shows of a capture, in its order."""
    done = subprocess.run(
        (
            *(tshark(), "-X", f"lua_script:{DISSECTOR}", "-r", str(capture)),
            *("-Y", "recon", "-T", "json", "-x"),
        ),
        # Settings of a person stay out of it.
        env={"PATH": os.environ["PATH"], "HOME": str(capture.parent)},
        capture_output=True,
        check=True,
    )
    assert not any(word in done.stderr for word in (b"Lua", b"bug")), done.stderr.decode()
    return [
        each
        for frame in json.loads(done.stdout, object_pairs_hook=list)
        for each in _of_frame(dict(dict(frame)["_source"])["layers"])
    ]


def _of_frame(layers: Pairs) -> Iterator[Shown]:
    connection = next(int(dict(body)["tcp.stream"]) for name, body in layers if name == "tcp")
    data = b""
    for name, body in layers:
        if name == "recon_raw":
            # Bytes come right before what they are the bytes of.
            data = bytes.fromhex(body[0])
        elif name == "recon":
            yield _shown(connection, data, body)


def _shown(connection: int, whole: bytes, body: Pairs) -> Shown:
    fields: dict[str, list[tuple[str, bytes]]] = {}
    notes: list[str] = []
    data = b""
    for name, value in _flat(body):
        if name.endswith("_raw"):
            data = bytes.fromhex(value[0])
        elif name == "_ws.expert.message":
            notes.append(value)
        else:
            fields.setdefault(name, []).append((value, data))
    return Shown(connection, whole, fields, tuple(notes))


def _flat(pairs: Pairs) -> Iterator[tuple[str, Any]]:
    """Yield texts and bytes of all depths, in their order."""
    for name, value in pairs:
        if isinstance(value, str) or name.endswith("_raw"):
            yield name, value
        elif isinstance(value, list):
            yield from _flat(value)
