"""`recon audit show` and `recon audit verify`: what happened, and whether the file is whole."""

import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import msgspec
import typer

from recon.cli.at_station import NO_USE
from recon.cli.output import clean, say
from recon.record.audit import AuditLine, decode_line
from recon.record.audit_check import Verdict, check_audit
from recon.record.audit_files import audit_files, raw_lines
from recon.record.errors import RecordError

audit_app = typer.Typer(help="Read a station's audit, and check that it is whole.")

PathsArgument = Annotated[
    list[Path], typer.Argument(metavar="FILE|FOLDER...", help="Audit files, or their folder.")
]


@audit_app.command("show")
def show_command(
    paths: PathsArgument,
    vehicle: Annotated[
        str | None, typer.Option(help="Only what is about this serial or name.")
    ] = None,
    kind: Annotated[
        str | None, typer.Option(help="Only kinds that begin so, like `order` or `alarm.raised`.")
    ] = None,
    who: Annotated[str | None, typer.Option("--by", help="Only what this one asked.")] = None,
    positions: Annotated[
        bool, typer.Option("--positions", help="Include vehicle positions.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="The lines as they are.")] = False,
) -> None:
    """Show what happened, who asked and when, the oldest first."""
    with _files_that_can_be_read():
        for line in _lines(paths):
            is_chosen = (
                (positions or kind is not None or line.kind != "vehicle.position")
                and (kind is None or line.kind.startswith(kind))
                and (vehicle is None or vehicle in (line.serial, line.vehicle))
                and (who is None or line.by == who)
            )
            if is_chosen and as_json:
                print(json.dumps(msgspec.to_builtins(line)))
            elif is_chosen:
                say(f"{line.utc}  {line.n:>6}  {line.kind:<24}  {line.by:<16}  {line.text}")


@audit_app.command("verify")
def verify_command(
    paths: PathsArgument,
    as_json: Annotated[bool, typer.Option("--json", help="Tell it as JSON, for programs.")] = False,
) -> None:
    """Check that files are whole: exit code 0 when they are, 1 when not, 2 when unreadable."""
    with _files_that_can_be_read():
        verdicts = [check_audit(path) for path in _files(paths)]
    if as_json:
        print(json.dumps([_values(verdict) for verdict in verdicts]))
    else:
        for verdict in verdicts:
            for sentence in _sentences(verdict):
                say(sentence)
    raise typer.Exit(0 if all(verdict.is_whole for verdict in verdicts) else 1)


@contextmanager
def _files_that_can_be_read() -> Iterator[None]:
    """What cannot be read is a wrong use, apart from a file that is damaged."""
    try:
        yield
    except RecordError as problem:
        print(f"recon: {clean(str(problem))}", file=sys.stderr)
        raise typer.Exit(NO_USE) from None


def _files(paths: Sequence[Path]) -> list[Path]:
    found: list[Path] = []
    for path in paths:
        files = audit_files(path) if path.is_dir() else [path]
        if not files:
            raise RecordError(f"{path}: expected audit files in this folder, got none")
        found += files
    return found


def _lines(paths: Sequence[Path]) -> Iterator[AuditLine]:
    """Every line that can be read; what cannot is told by `verify`."""
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


def _values(verdict: Verdict) -> dict[str, object]:
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


def _sentences(verdict: Verdict) -> Iterator[str]:
    state = "whole" if verdict.is_whole else "DAMAGED"
    yield f"{verdict.path}: {state}, {verdict.lines} lines, last hash {verdict.last_hash}"
    for fault in verdict.faults:
        yield f"  {fault}"
    if verdict.torn_bytes:
        yield f"  the last {verdict.torn_bytes} bytes are a line cut short, as a crash leaves it"
    if verdict.lost:
        yield f"  {verdict.lost} entries could not be written then, as the file itself says"
    if verdict.missing_before is not None:
        yield f"  the file of the run before, {verdict.missing_before}, is not in the folder"
    if not verdict.is_closed and verdict.is_end_known:
        yield "  the run did not end in order (killed?); the next one notes how far this file went"
    elif not verdict.is_closed:
        yield "  the run has not ended in order: it still runs, or was killed, or the end is cut"
