"""An audit's folder: one numbered file for each run, read in bounded pieces."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import BinaryIO

from recon.model.errors import RecordError
from recon.model.units import NS_PER_S
from recon.record.audit.audit import LONGEST_LINE_BYTES, AuditLine, decode_line, line_hash

_NAME = re.compile(r"recon-audit-(\d{6})-\d{8}T\d{6}Z\.jsonl")
MOST_RUNS = 999_999
READ_TAIL_BYTES = 1024 * 1024
"""What a start reads of the last run, to find its last whole line."""


@dataclass(frozen=True, slots=True)
class RawLine:
    """A line's bytes without its break. A last one without a break is `is_torn`; of one that is
    longer than any line of an audit, `data` is the beginning."""

    data: bytes
    is_torn: bool = False


@dataclass(frozen=True, slots=True)
class RunEnd:
    """How a run's file ends: its last good line and the hash that the next run's file continues;
    and how much before it could not be read."""

    path: Path
    last: AuditLine | None
    last_hash: str | None
    bad_lines: int
    torn_bytes: int


def audit_files(folder: Path) -> list[Path]:
    """Return the folder's audit files, the oldest run first; none when there is no folder."""
    try:
        names = [path.name for path in folder.iterdir() if _NAME.fullmatch(path.name)]
    except FileNotFoundError:
        return []
    except OSError as problem:
        raise RecordError(f"cannot read the audit's folder {folder}: {problem}") from problem
    return [folder / name for name in sorted(names)]


def run_number(path: Path) -> int:
    """Return the number of the run in a file's name; 0 for another name."""
    match = _NAME.fullmatch(path.name)
    return 0 if match is None else int(match.group(1))


def next_file_name(files: list[Path], utc_ns: int) -> str:
    """Return the name of the next run's file. Raises `RecordError` when all numbers are used."""
    number = max((run_number(path) for path in files), default=0) + 1
    if number > MOST_RUNS:
        raise RecordError(f"the audit's folder holds {MOST_RUNS} runs: move them elsewhere")
    moment = datetime.fromtimestamp(utc_ns // NS_PER_S, UTC)
    return f"recon-audit-{number:06d}-{moment:%Y%m%dT%H%M%SZ}.jsonl"


def raw_lines(file: BinaryIO) -> Iterator[RawLine]:
    """Yield the lines from the file's position on; holds one line at most."""
    while data := file.readline(LONGEST_LINE_BYTES + 1):
        if data.endswith(b"\n"):
            yield RawLine(data[:-1])
        elif len(data) <= LONGEST_LINE_BYTES:
            yield RawLine(data, is_torn=True)
        else:
            yield RawLine(data)
            _skip_line(file)


def read_run_end(path: Path, at_most_bytes: int = READ_TAIL_BYTES) -> RunEnd:
    """Return how a file ends; raises `RecordError` when it cannot be read."""
    last, last_hash, bad_lines, torn_bytes = None, None, 0, 0
    try:
        with path.open("rb") as file:
            _go_to_tail(file, at_most_bytes)
            for raw in raw_lines(file):
                if raw.is_torn:
                    torn_bytes = len(raw.data)
                    continue
                try:
                    last = decode_line(raw.data)
                except ValueError:
                    bad_lines += 1
                    continue
                last_hash = line_hash(raw.data)
    except OSError as problem:
        raise RecordError(f"cannot read the audit {path}: {problem}") from problem
    return RunEnd(path, last, last_hash, bad_lines, torn_bytes)


def _go_to_tail(file: BinaryIO, at_most_bytes: int) -> None:
    """Go to the first whole line of the last bytes."""
    size = file.seek(0, 2)
    file.seek(max(0, size - at_most_bytes))
    if size > at_most_bytes:
        _skip_line(file)


def _skip_line(file: BinaryIO) -> None:
    while (data := file.readline(LONGEST_LINE_BYTES)) and not data.endswith(b"\n"):
        pass
