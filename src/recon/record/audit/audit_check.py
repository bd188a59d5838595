"""Check that an audit file is complete: every line present, in order, unchanged."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from recon.model.errors import RecordError
from recon.record.audit.audit import (
    LOST_KIND,
    NO_LINE_BEFORE,
    OPENED_KIND,
    STOPPED_KIND,
    AuditLine,
    decode_line,
    line_hash,
)
from recon.record.audit.audit_files import RawLine, audit_files, raw_lines

MAX_FAULTS = 20


@dataclass(frozen=True, slots=True)
class AuditCheck:
    """The result of checking one file. `faults` are sentences; without any the file is whole."""

    path: Path
    lines: int
    lost: int
    """Entries that the station reported as not written."""
    torn_bytes: int
    """Bytes of a last line cut short, as by a power failure."""
    is_closed: bool
    """Whether the run ended in order: without, the station runs, was killed, or the end is cut."""
    is_end_known: bool
    """Whether a later run in the folder has noted how far this file went."""
    missing_before: str | None
    """The file of the run before, when it is no longer in the folder."""
    last_hash: str | None
    faults: tuple[str, ...]

    @property
    def is_whole(self) -> bool:
        """Whether the file has no fault."""
        return not self.faults


@dataclass(frozen=True, slots=True)
class _Noted:
    """A line of this file as noted by the next run: its number and hash."""

    by: str
    n: int
    hash: str


@dataclass(slots=True)
class _Check:
    """The state of a pass over one file."""

    noted: _Noted | None
    first_hash_wanted: str | None
    lines: int = 0
    lost: int = 0
    torn_bytes: int = 0
    before_hash: str | None = None
    before: AuditLine | None = None
    is_noted_found: bool = False
    faults: list[str] = field(default_factory=list)

    def take(self, number: int, raw: RawLine) -> None:
        """Check one line; `number` counts the file's lines from 1."""
        self.lines = number
        if raw.is_torn:
            self.torn_bytes = len(raw.data)
            self.lines -= 1
            return
        own_hash = line_hash(raw.data)
        try:
            line = decode_line(raw.data)
        except ValueError as problem:
            self.fault(f"line {number}: {problem}")
            self.before_hash, self.before = own_hash, None
            return
        self._check_chain(number, line)
        self._check_number(number, line)
        if self.noted is not None and (line.n, own_hash) == (self.noted.n, self.noted.hash):
            self.is_noted_found = True
        self.before_hash, self.before = own_hash, line

    def _check_chain(self, number: int, line: AuditLine) -> None:
        wanted = self.before_hash if number > 1 else self.first_hash_wanted
        if wanted is not None and line.before != wanted:
            at = "the line before" if number > 1 else "the run before"
            self.fault(
                f"line {number}: expected it to carry the hash of {at}, got another: a line was "
                "changed, removed or inserted here"
            )
        if number == 1 and line.kind != OPENED_KIND:
            self.fault(f"line 1: expected {OPENED_KIND}, got {line.kind}: the beginning is cut")

    def _check_number(self, number: int, line: AuditLine) -> None:
        if self.before is None:
            return
        step = line.n - self.before.n
        if line.kind == LOST_KIND:
            self.lost += max(0, step)
        elif step != 1:
            self.fault(f"line {number}: expected number {self.before.n + 1}, got {line.n}")

    def fault(self, sentence: str) -> None:
        """Add a fault, up to a limit."""
        if len(self.faults) < MAX_FAULTS:
            self.faults.append(sentence)


def check_audit(path: Path) -> AuditCheck:
    """Check one file, and that it fits the runs before and after it in its folder.

    Raises `RecordError` when it cannot be read.
    """
    siblings = audit_files(path.parent)
    check = _Check(_noted_of(path, siblings), _hash_wanted(path, siblings))
    try:
        with path.open("rb") as file:
            for number, raw in enumerate(raw_lines(file), start=1):
                check.take(number, raw)
    except OSError as problem:
        raise RecordError(f"cannot read the audit {path}: {problem}") from problem
    if check.lines == 0:
        check.fault("expected lines of an audit, got none")
    if check.noted is not None and not check.is_noted_found:
        check.fault(
            f"{check.noted.by} notes line {check.noted.n} of this file, which is not here as it "
            "was then: the end is cut, or a line was changed"
        )
    return AuditCheck(
        path=path,
        lines=check.lines,
        lost=check.lost,
        torn_bytes=check.torn_bytes,
        is_closed=check.before is not None and check.before.kind == STOPPED_KIND,
        is_end_known=check.noted is not None,
        missing_before=_missing_before(path, siblings),
        last_hash=check.before_hash,
        faults=tuple(check.faults),
    )


def _noted_of(path: Path, siblings: list[Path]) -> _Noted | None:
    """Return what a later run noted about this file; the first that names it counts."""
    later = [sibling for sibling in siblings if sibling.name > path.name]
    for sibling in later:
        first = _first_line(sibling)
        previous = {} if first is None else _previous(first)
        if previous.get("file") == path.name:
            n, noted_hash = previous.get("n"), previous.get("hash")
            if isinstance(n, int) and isinstance(noted_hash, str):
                return _Noted(sibling.name, n, noted_hash)
    return None


def _hash_wanted(path: Path, siblings: list[Path]) -> str | None:
    """Return the hash that the first line must carry: the one it notes of the run before."""
    first = _first_line(path)
    if first is None:
        return None
    noted = _previous(first).get("hash")
    return noted if isinstance(noted, str) else NO_LINE_BEFORE


def _missing_before(path: Path, siblings: list[Path]) -> str | None:
    first = _first_line(path)
    name = None if first is None else _previous(first).get("file")
    is_here = any(sibling.name == name for sibling in siblings)
    return name if isinstance(name, str) and not is_here else None


def _previous(first: AuditLine) -> dict[str, Any]:
    """Return what the first line of a run notes about the run before."""
    previous = first.details.get("previous")
    return previous if isinstance(previous, dict) else {}


def _first_line(path: Path) -> AuditLine | None:
    try:
        with path.open("rb") as file:
            raw = next(raw_lines(file), None)
        return None if raw is None or raw.is_torn else decode_line(raw.data)
    except (OSError, ValueError):
        return None
