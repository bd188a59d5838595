"""`recon inspect`: the packets in a file, one per line or as JSON lines.

A flight record (MCAP) holds several streams, each with its own deframer; the log of the companion
app holds lines, and no packets; anything else is one stream of bare bytes.
"""

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
from recon.cli.app_log import is_app_log, show_app_log
from recon.model.errors import RecordError

READ_BYTES = 64 * 1024
LATEST_NS = 2**63 - 1
MCAP_START = b"\x89MCAP0\r\n"


class Read(NamedTuple):
    """Bytes of one read; stream and time only where the file holds several."""

    data: bytes
    stream: str | None = None
    time_ns: int | None = None


def inspect_command(
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE...", help="Flight records, bare streams or logs of the app; - for stdin."
        ),
    ],
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object per line.")] = False,
) -> None:
    """Print the packets of a flight record or of bare bytes, or the lines of the app's log.

    After them come the deframer's counters, or the log's summary. Exit code 1: a file holds none.
    """
    are_packets = True
    for file in files:
        name = printable_bytes(file.encode(errors="replace"))
        if len(files) > 1 and not as_json:
            typer.echo(f"== {name}")
        if not _inspect_file(file, as_json):
            are_packets = False
            typer.echo(f"recon inspect: {name} holds no packet of the protocol", err=True)
    if not are_packets:
        raise typer.Exit(1)


def _inspect_file(file: str, as_json: bool) -> bool:
    """Return whether there was a packet, or no reader to show it to."""
    try:
        if file == "-":
            found = inspect(sys.stdin.buffer, as_json, sys.stdout)
        else:
            with Path(file).open("rb") as source:
                found = inspect(source, as_json, sys.stdout)
        sys.stdout.flush()
        return found
    except BrokenPipeError:
        # The reader has ended (`| head`); nothing may be written any later, not even at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return True
    except OSError as problem:
        name = printable_bytes(file.encode(errors="replace"))
        raise RecordError(f"cannot read {name}: {problem.strerror}") from problem


def inspect(source: BinaryIO, json_lines: bool, out: TextIO) -> bool:
    """Write every packet of `source` to `out`, then the counters; return whether there was one.

    Of a log of the companion app its lines are written, and its summary.
    """
    start = _exactly(source, len(MCAP_START))
    if is_app_log(start):
        return show_app_log(start, source, json_lines, out)
    deframers: dict[str | None, wire.Deframer] = {}
    latest: dict[str | None, Read] = {}
    show = _show_json if json_lines else _show_line
    trouble = ""
    try:
        for read in _reads(start, source):
            deframer = deframers.setdefault(read.stream, wire.Deframer())
            latest[read.stream] = read
            for packet in deframer.feed(read.data, read.time_ns or 0):
                show(read, packet, out)
    except RecordError as problem:
        trouble = str(problem)
    for stream, deframer in deframers.items():
        for packet in deframer.finish():
            show(latest[stream], packet, out)
    _show_summary(deframers, trouble, json_lines, out)
    return any(deframer.counters.packets for deframer in deframers.values())


def printable_bytes(data: bytes) -> str:
    """Return received text safe for a terminal: bad UTF-8 replaced, control characters escaped."""
    text = data.decode("utf-8", "replace")
    return "".join(
        letter
        if letter.isprintable() and letter != "\\"
        else letter.encode("unicode_escape").decode()
        for letter in text
    )


def _reads(start: bytes, source: BinaryIO) -> Iterator[Read]:
    if start == MCAP_START:
        yield from _record_reads(source)
        return
    yield Read(start)
    # read1 returns what a pipe has now instead of waiting for a full buffer.
    read = getattr(source, "read1", source.read)
    while data := read(READ_BYTES):
        yield Read(data)


def _record_reads(source: BinaryIO) -> Iterator[Read]:
    from recon.record.mcap.link_bytes import link_bytes

    for each in link_bytes(source):
        direction = "from app" if each.is_from_app else "to app"
        yield Read(each.data, f"link {each.link_id} {direction}", min(each.at_ns, LATEST_NS))


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
    if read.time_ns is not None and read.stream is not None:
        where = f"{read.time_ns / 1e9:.6f} s  {read.stream}  "
    parts = [type(packet).__name__]
    for name, value in _fields(packet).items():
        quoted = isinstance(value, str) and name in ("serial", "text")
        parts.append(f'{name}="{value}"' if quoted else f"{name}={value}")
    print(where + " ".join(parts), file=out)


def _show_json(read: Read, packet: wire.Packet, out: TextIO) -> None:
    pid = packet.pid if isinstance(packet, wire.UnknownPacket) else packet.PID
    line: dict[str, Any] = {"packet": type(packet).__name__, "pid": pid}
    if read.stream is not None:
        line |= {"time_ns": read.time_ns, "stream": read.stream}
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
    deframers: dict[str | None, wire.Deframer], trouble: str, json_lines: bool, out: TextIO
) -> None:
    for stream, deframer in deframers.items():
        name = "stream" if stream is None else stream
        counters = _counters(deframer)
        if json_lines:
            print(json.dumps({"counters": counters, "stream": name}), file=out)
        else:
            line = ", ".join(f"{key} {value}" for key, value in counters.items())
            print(f"{name}: {line}", file=out)
    if trouble:
        print(json.dumps({"trouble": trouble}) if json_lines else trouble, file=out)
