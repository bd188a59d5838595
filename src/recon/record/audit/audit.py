"""The audit's lines: what happened, who asked, about which vehicle: JSON, one line each, ASCII.

    {"n": 17, "utc": "2025-06-01T09:30:00.123456Z", "t_ns": 1748770200123456000,
     "kind": "order.sent", "by": "anna (192.168.1.7)", "serial": "1ZN", "vehicle": "Anna",
     "text": "Anna: hover: sent", "details": {...}, "before": "<SHA-256 of the line before>"}

`n` grows by one from line to line. `before` chains them: it is the hash of the bytes of the line
before without its line break, and continues from the last line of a run into the file of the next,
so that a changed, removed or inserted line is found. The chain is no signature: a rewrite of
everything after a change is found only by a hash noted elsewhere.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from hashlib import sha256
from math import isfinite
from typing import Any

import msgspec

from recon.model.units import NS_PER_S

NO_LINE_BEFORE = "0" * 64
"""What the first line of the first run carries."""

LONGEST_LINE_BYTES = 64 * 1024
"""The longest mission takes 20 KiB."""

LOST_KIND = "audit.lost"
"""Stands in for lines that could not be written; its number is that of the last one lost."""

OPENED_KIND = "audit.opened"
"""The first line of every file; it names the file and the line that came before. Its number is that
of the last entry before it, 0 in the first file of a run."""

STARTED_KIND = "station.started"
STOPPED_KIND = "station.stopped"
FAILED_KIND = "station.failed"

_LONGEST_TEXT = 2_000
_MOST_ITEMS = 512
_DEEPEST = 8


@dataclass(frozen=True, slots=True)
class AuditEntry:
    """An event. `by` is its person with the address, or `station`; `details` are JSON values, units
    in names."""

    kind: str
    text: str
    by: str = "station"
    serial: str | None = None
    vehicle: str = ""
    details: Mapping[str, Any] = field(default_factory=dict)


class AuditLine(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One line of an audit file, as read. Its text is safe for terminals, its values are not
    checked further."""

    n: int
    utc: str
    t_ns: int
    kind: str
    by: str
    serial: str | None
    vehicle: str
    text: str
    details: dict[str, Any]
    before: str


@dataclass(frozen=True, slots=True)
class NumberedEntry:
    """An entry with its number, UTC and station time."""

    n: int
    utc_ns: int
    t_ns: int
    entry: AuditEntry

    @property
    def utc(self) -> str:
        """UTC as ISO 8601 with microseconds."""
        return utc_text(self.utc_ns)


def encode_line(stamped: NumberedEntry, before: str) -> bytes:
    """Return the bytes of a line, without its line break."""
    entry = stamped.entry
    head = {
        "n": stamped.n,
        "utc": stamped.utc,
        "t_ns": stamped.t_ns,
        "kind": entry.kind,
        "by": harmless(entry.by),
        "serial": harmless(entry.serial),
        "vehicle": harmless(entry.vehicle),
        "text": harmless(entry.text),
    }
    line = _json({**head, "details": harmless(dict(entry.details)), "before": before})
    if len(line) <= LONGEST_LINE_BYTES:
        return line
    return _json({**head, "details": {"excluded_bytes": len(line)}, "before": before})


def decode_line(line: bytes) -> AuditLine:
    """Return a line's values; raises ValueError for anything that is not an audit line."""
    if len(line) > LONGEST_LINE_BYTES:
        raise ValueError(f"expected a line of up to {LONGEST_LINE_BYTES} bytes, got {len(line)}")
    try:
        return msgspec.json.decode(line, type=AuditLine)
    except (msgspec.DecodeError, UnicodeError, RecursionError, OverflowError) as problem:
        raise ValueError(f"expected an audit line, got: {problem}") from problem


def line_hash(line: bytes) -> str:
    """Return what the next line carries as `before`."""
    return sha256(line).hexdigest()


def utc_text(utc_ns: int) -> str:
    """Return a moment as ISO 8601 in UTC with microseconds."""
    seconds, rest_ns = divmod(utc_ns, NS_PER_S)
    moment = datetime.fromtimestamp(seconds, UTC)
    return f"{moment:%Y-%m-%dT%H:%M:%S}.{rest_ns // 1000:06d}Z"


def harmless(value: Any, depth: int = 0) -> Any:
    """Return a JSON value of bounded size; values without a JSON form become text."""
    if isinstance(value, str):
        return value if len(value) <= _LONGEST_TEXT else value[:_LONGEST_TEXT] + "..."
    if value is None or isinstance(value, bool | int):
        return value
    if isinstance(value, float):
        return value if isfinite(value) else str(value)
    if depth >= _DEEPEST:
        return "..."
    if isinstance(value, Mapping):
        pairs = list(value.items())[:_MOST_ITEMS]
        return {harmless(str(key)): harmless(item, depth + 1) for key, item in pairs}
    if isinstance(value, list | tuple):
        return [harmless(item, depth + 1) for item in value[:_MOST_ITEMS]]
    return harmless(str(value))


def shown(text: str) -> str:
    """Return text with what is not printable as escapes: for terminals and logs."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def _json(values: dict[str, Any]) -> bytes:
    # ASCII only: text from the wire or a client cannot control a terminal that shows the file.
    # DEL is ASCII and the one control character that JSON does not escape.
    text = json.dumps(values, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return text.replace("\x7f", "\\u007f").encode("ascii")
