"""`recon inspect`: the packets of a captured byte stream, one per line or as JSON lines."""

import json
import math
import os
import sys
from collections.abc import Iterator
from functools import cache
from inspect import signature
from pathlib import Path
from typing import Annotated, Any, BinaryIO, NamedTuple, TextIO

import typer

from recon import wire
from recon.link.capture import MAGIC, RECORD_HEADER, Direction

READ_BYTES = 64 * 1024
LATEST_NS = 2**63 - 1


class Read(NamedTuple):
    """Bytes of one read; direction and time only in a capture."""

    data: bytes
    direction: Direction | None = None
    time_ns: int | None = None


class DamagedCaptureError(Exception):
    """A capture file contains something that is not a record."""


def inspect_command(
    files: Annotated[
        list[str],
        typer.Argument(metavar="FILE...", help="Raw streams or capture files; - for stdin."),
    ],
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object per line.")] = False,
) -> None:
    """Print the packets of a captured stream.

    After them come the deframer's counters.
    """
    for file in files:
        if len(files) > 1 and not as_json:
            typer.echo(f"== {printable_bytes(file.encode(errors='replace'))}")
        _inspect_file(file, as_json)


def _inspect_file(file: str, as_json: bool) -> None:
    try:
        if file == "-":
            inspect(sys.stdin.buffer, as_json, sys.stdout)
        else:
            with Path(file).open("rb") as source:
                inspect(source, as_json, sys.stdout)
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader has ended (`| head`); nothing may be written any later, not even at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as problem:
        name = printable_bytes(file.encode(errors="replace"))
        typer.echo(f"recon inspect: cannot read {name}: {problem.strerror}", err=True)
        raise typer.Exit(2) from None


def inspect(source: BinaryIO, json_lines: bool, out: TextIO) -> None:
    """Write every packet of `source` to `out`, then the counters.

    A source that begins with the capture's magic line is read as a capture: two directions, each
    with its own deframer, and times. Anything else is one direction of a bare stream.
    """
    deframers: dict[Direction | None, wire.Deframer] = {}
    latest: dict[Direction | None, Read] = {}
    show = _show_json if json_lines else _show_line
    trouble = ""
    reads = _reads(source)
    try:
        for read in reads:
            deframer = deframers.setdefault(read.direction, wire.Deframer())
            latest[read.direction] = read
            for packet in deframer.feed(read.data, read.time_ns or 0):
                show(read, packet, out)
    except DamagedCaptureError as problem:
        trouble = str(problem)
    for direction, deframer in deframers.items():
        for packet in deframer.finish():
            show(latest[direction], packet, out)
    _show_summary(deframers, trouble, json_lines, out)


def printable_bytes(data: bytes) -> str:
    """Return received text safe for a terminal: bad UTF-8 replaced, control characters escaped."""
    text = data.decode("utf-8", "replace")
    return "".join(
        letter
        if letter.isprintable() and letter != "\\"
        else letter.encode("unicode_escape").decode()
        for letter in text
    )


def _reads(source: BinaryIO) -> Iterator[Read]:
    start = _exactly(source, len(MAGIC))
    if start == MAGIC:
        yield from _capture_reads(source)
        return
    yield Read(start)
    # read1 returns what a pipe has now instead of waiting for a full buffer.
    read = getattr(source, "read1", source.read)
    while data := read(READ_BYTES):
        yield Read(data)


def _capture_reads(source: BinaryIO) -> Iterator[Read]:
    position = len(MAGIC)
    while len(header := _exactly(source, RECORD_HEADER.size)) == RECORD_HEADER.size:
        time_ns, direction, length = RECORD_HEADER.unpack(header)
        if direction not in tuple(Direction):
            raise DamagedCaptureError(
                f"the capture is damaged at byte {position}: "
                f"expected direction 0 or 1, got {direction}; the rest is skipped"
            )
        position += RECORD_HEADER.size + length
        while length > 0 and (data := source.read(min(length, READ_BYTES))):
            length -= len(data)
            yield Read(data, Direction(direction), min(time_ns, LATEST_NS))


def _exactly(source: BinaryIO, count: int) -> bytes:
    """Return `count` bytes, or fewer at the end."""
    data = b""
    while len(data) < count and (more := source.read(count - len(data))):
        data += more
    return data


@cache
def _field_names(class_name: str) -> tuple[str, ...]:
    """Names of a packet's fields in wire order."""
    return tuple(signature(getattr(wire, class_name)).parameters)


def _fields(packet: Any) -> dict[str, Any]:
    """Return a packet's fields as JSON values: images by size, bytes as escaped text or hex."""
    fields: dict[str, Any] = {}
    for name in _field_names(type(packet).__name__):
        value = getattr(packet, name)
        if name == "pixels":
            fields["rows"], fields["cols"] = value.shape[:2]
        elif name == "jpeg":
            fields["jpeg_bytes"] = len(value)
        elif name == "payload":
            fields[name] = value.hex()
        elif isinstance(value, bytes):
            fields[name] = printable_bytes(value)
        elif isinstance(value, tuple):
            fields[name] = [_fields(part) for part in value]
        elif isinstance(value, float) and not math.isfinite(value):
            fields[name] = str(value)
        else:
            fields[name] = value
    return fields


def _show_line(read: Read, packet: wire.Packet, out: TextIO) -> None:
    where = ""
    if read.time_ns is not None and read.direction is not None:
        way = "from app" if read.direction is Direction.FROM_APP else "to app  "
        where = f"{read.time_ns / 1e9:.6f} s  {way}  "
    parts = [type(packet).__name__]
    for name, value in _fields(packet).items():
        quoted = isinstance(value, str) and name in ("serial", "text")
        parts.append(f'{name}="{value}"' if quoted else f"{name}={value}")
    print(where + " ".join(parts), file=out)


def _show_json(read: Read, packet: wire.Packet, out: TextIO) -> None:
    pid = packet.pid if isinstance(packet, wire.UnknownPacket) else packet.PID
    line: dict[str, Any] = {"packet": type(packet).__name__, "pid": pid}
    if read.direction is not None:
        line |= {"time_ns": read.time_ns, "direction": read.direction.name.lower()}
    print(json.dumps(line | {"fields": _fields(packet)}), file=out)


def _counters(deframer: wire.Deframer) -> dict[str, Any]:
    counters = deframer.counters
    return {
        "packets": sum(counters.packets.values()),
        "packets_by_pid": counters.packets,
        "bad_hash": counters.bad_hash,
        "bad_size": counters.bad_size,
        "bad_payload": counters.bad_payload,
        "unknown_pid": counters.unknown_pid,
        "abandoned": counters.abandoned,
        "bytes_skipped": counters.bytes_skipped,
    }


def _show_summary(
    deframers: dict[Direction | None, wire.Deframer], trouble: str, json_lines: bool, out: TextIO
) -> None:
    for direction, deframer in deframers.items():
        name = "stream" if direction is None else direction.name.lower()
        counters = _counters(deframer)
        if json_lines:
            print(json.dumps({"counters": counters, "direction": name}), file=out)
        else:
            line = ", ".join(f"{key} {value}" for key, value in counters.items())
            print(f"{name.replace('_', ' ')}: {line}", file=out)
    if trouble:
        print(json.dumps({"trouble": trouble}) if json_lines else trouble, file=out)
