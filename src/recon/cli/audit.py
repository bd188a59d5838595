"""`recon audit show` and `recon audit verify`: the entries of an audit, and its integrity."""

import re
from collections import deque
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime, time, timedelta
from pathlib import Path
from typing import Annotated

import msgspec
import typer

from recon.cli.commands import App
from recon.cli.output import print_json, print_line
from recon.model.errors import RecordError
from recon.record.audit.audit import AuditLine, decode_line
from recon.record.audit.audit_check import AuditCheck, check_audit
from recon.record.audit.audit_files import audit_files, raw_lines

audit_app = App(help="Read a station's audit and verify its integrity.", no_args_is_help=True)

_UNITS_S = {"s": 1, "min": 60, "m": 60, "h": 3_600, "d": 86_400}
_AGO = re.compile(r"(?P<count>\d{1,9}(?:\.\d+)?) ?(?P<unit>s|min|m|h|d)")
_CLOCK = re.compile(r"\d\d:\d\d(?::\d\d)?")

PathsArgument = Annotated[
    list[Path], typer.Argument(metavar="FILE|FOLDER...", help="Audit files, or their folder.")
]


@audit_app.command("show")
def show_command(
    paths: PathsArgument,
    vehicle: Annotated[
        str | None, typer.Option(help="Only entries about this serial or name.")
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option(help="Only kinds that start with this, like `order` or `alarm.raised`."),
    ] = None,
    person: Annotated[
        str | None, typer.Option("--by", help="Only entries of this person, or with address.")
    ] = None,
    positions: Annotated[
        bool, typer.Option("--positions", help="Include vehicle positions.")
    ] = False,
    since: Annotated[
        str | None,
        typer.Option(help="Only the last `90min`, `2h` or `1d`, or from a UTC time like `09:30`."),
    ] = None,
    tail: Annotated[
        int | None, typer.Option(min=1, help="Only the last so many of the chosen entries.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print entries as JSON lines.")] = False,
) -> None:
    """Show audit entries, the oldest first."""
    first_utc = "" if since is None else _start_of(since, datetime.now(UTC))

    def is_chosen(line: AuditLine) -> bool:
        return (
            (positions or kind is not None or line.kind != "vehicle.position")
            and (kind is None or line.kind.startswith(kind))
            and (vehicle is None or vehicle in (line.serial, line.vehicle))
            and (person is None or is_by(line.by, person))
            and line.utc >= first_utc
        )

    chosen = filter(is_chosen, _lines(paths))
    for line in chosen if tail is None else deque(chosen, tail):
        if as_json:
            print_json(msgspec.to_builtins(line))
        else:
            print_line(f"{line.utc}  {line.n:>6}  {line.kind:<24}  {line.by:<24}  {line.text}")


@audit_app.command("verify")
def verify_command(
    paths: PathsArgument,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Verify the integrity of audit files.

    Exit code 0 when all are intact, 1 when one is damaged, 2 when one cannot be read.
    """
    verdicts = [check_audit(path) for path in _files(paths)]
    if as_json:
        print_json([_values(verdict) for verdict in verdicts])
    else:
        for verdict in verdicts:
            for sentence in _sentences(verdict):
                print_line(sentence)
    raise typer.Exit(0 if all(verdict.is_whole for verdict in verdicts) else 1)


def _start_of(since: str, now: datetime) -> str:
    """Return the UTC time, as the audit writes it, from which on entries are wanted."""
    found = _AGO.fullmatch(since.strip())
    if found is not None:
        try:
            start = now - timedelta(seconds=float(found["count"]) * _UNITS_S[found["unit"]])
        except OverflowError:
            start = datetime.min.replace(tzinfo=UTC)
        return start.isoformat()
    try:
        if _CLOCK.fullmatch(since):
            return datetime.combine(now.date(), time.fromisoformat(since), UTC).isoformat()
        given = datetime.fromisoformat(since)
    except ValueError:
        raise typer.BadParameter(
            f"expected 90min, 2h, 1d, 09:30 or 2026-05-01T09:30, got {since!a}",
            param_hint="--since",
        ) from None
    return (given if given.tzinfo else given.replace(tzinfo=UTC)).astimezone(UTC).isoformat()


def is_by(by: str, person: str) -> bool:
    """Return whether an entry is of a person, named with or without an address."""
    return by == person or by.startswith((f"{person} (", f"{person}:"))


def _files(paths: Sequence[Path]) -> list[Path]:
    found: list[Path] = []
    for path in paths:
        files = audit_files(path) if path.is_dir() else [path]
        if not files:
            raise RecordError(f"{path}: expected audit files in this folder, got none")
        found += files
    return found


def _lines(paths: Sequence[Path]) -> Iterator[AuditLine]:
    """Yield every readable line; `verify` reports the others."""
    for path in _files(paths):
        try:
            with path.open("rb") as file:
                for raw in raw_lines(file):
                    if not raw.is_torn:
                        yield from _decoded(raw.data)
        except OSError as problem:
            raise RecordError(f"cannot read the audit {path}: {problem}") from problem


def _decoded(data: bytes) -> Iterator[AuditLine]:
    try:
        yield decode_line(data)
    except ValueError:
        return


def _values(verdict: AuditCheck) -> dict[str, object]:
    return {
        "file": str(verdict.path),
        "is_whole": verdict.is_whole,
        "lines": verdict.lines,
        "lost": verdict.lost,
        "torn_bytes": verdict.torn_bytes,
        "is_closed": verdict.is_closed,
        "is_end_known": verdict.is_end_known,
        "missing_before": verdict.missing_before,
        "last_hash": verdict.last_hash,
        "faults": list(verdict.faults),
    }


def _sentences(verdict: AuditCheck) -> Iterator[str]:
    state = "intact" if verdict.is_whole else "DAMAGED"
    yield f"{verdict.path}: {state}, {verdict.lines} lines, last hash {verdict.last_hash}"
    for fault in verdict.faults:
        yield f"  {fault}"
    if verdict.torn_bytes:
        yield f"  the last {verdict.torn_bytes} bytes are an incomplete line, as after a crash"
    if verdict.lost:
        yield f"  {verdict.lost} entries could not be written, as the file itself records"
    if verdict.missing_before is not None:
        yield f"  the previous run's file, {verdict.missing_before}, is not in the folder"
    if not verdict.is_closed and verdict.is_end_known:
        yield "  the run did not shut down normally; the next run recorded this file's end"
    elif not verdict.is_closed:
        yield "  no shutdown recorded: the run is still active, was killed, or the end is missing"
