"""The start of an audit: its folder, the chain of the last run, and the first and last entries."""

import os
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from recon import version
from recon.model.errors import ReconError, RecordError
from recon.record.audit.audit import FAILED_KIND, STARTED_KIND, STOPPED_KIND, AuditEntry
from recon.record.audit.audit_files import RunEnd, audit_files, read_run_end, run_number
from recon.record.audit.audit_log import AuditLog, refuse_other_writer
from recon.record.files.users_file import state_folder
from recon.station.audit.flight_entries import POSITION_KIND
from recon.station.state.settings import StationSettings

MAX_FILES_READ = 5
"""A station killed during its start leaves an empty file; more than a few of them in a row have
another cause."""


@dataclass(frozen=True, slots=True)
class AuditPlace:
    """The folder of the audit. One `is_shared` by stations is written only: neither the audit chain
    nor the recovery snapshot of another station belongs to this one."""

    folder: Path
    is_shared: bool = False


@dataclass(frozen=True, slots=True)
class Begun:
    """An audit ready for writing. `troubles` are sentences about files of earlier runs."""

    log: AuditLog
    runs_before: int = 0
    """The number of the last run in the folder."""
    ended_in_order: bool = False
    """Whether the last run was stopped; False when it was killed, or there was none."""
    troubles: tuple[str, ...] = ()


def default_place(link_port: int, environment: Mapping[str, str] = os.environ) -> AuditPlace:
    """Return the folder in the user's state folder: one for each port, so that a restarted station
    finds its own; without a fixed port, a shared one."""
    folder = state_folder(environment) / "audit"
    return (
        AuditPlace(folder / "any-port", True)
        if link_port == 0
        else AuditPlace(folder / f"port-{link_port}")
    )


def begin_audit(place: AuditPlace) -> Begun:
    """Return the audit that continues the chain of the last run.

    Raises `RecordError` only when another running station writes there: anything else that is wrong
    with the folder must not keep the station from starting.
    """
    log = AuditLog(place.folder, quiet_kinds=frozenset({POSITION_KIND}))
    if place.is_shared:
        return Begun(log)
    refuse_other_writer(place.folder)
    try:
        files = audit_files(place.folder)
    except RecordError as problem:
        return Begun(log, troubles=(str(problem),))
    troubles: list[str] = []
    runs_before = run_number(files[-1]) if files else 0
    for path in reversed(files[-MAX_FILES_READ:]):
        end = _read_end(path, troubles)
        if end is not None and end.last is not None:
            log.follow(end)
            return Begun(log, runs_before, end.last.kind == STOPPED_KIND, tuple(troubles))
    return Begun(log, runs_before, troubles=tuple(troubles))


def started_entry(
    settings: StationSettings,
    site: Mapping[str, Any],
    ended_in_order: bool,
    first_ids: tuple[int, int],
    troubles: tuple[str, ...],
) -> AuditEntry:
    """Return the entry of a start: version, settings, site and the first ids of orders."""
    details = {
        "version": version(),
        "python": sys.version.split()[0],
        "site": dict(site),
        "first_id": first_ids[0],
        "next_own_id": first_ids[1],
        "last_run_ended_in_order": ended_in_order,
        "troubles": list(troubles),
        "settings": asdict(settings),
    }
    return AuditEntry(STARTED_KIND, f"station started, version {version()}", details=details)


def ended_entry(problem: BaseException | None) -> AuditEntry:
    """Return the entry of a stop, of a refused start, or of an end by a fault in the station's own
    code."""
    text = "vehicles in flight continue their last order"
    if problem is None:
        return AuditEntry(STOPPED_KIND, f"station stopped; {text}")
    if isinstance(problem, ReconError):
        return AuditEntry(STOPPED_KIND, f"station not started: {problem}")
    fault = f"{type(problem).__name__}: {problem}"
    return AuditEntry(FAILED_KIND, f"station ended by a fault ({fault}); {text}")


def _read_end(path: Path, troubles: list[str]) -> RunEnd | None:
    try:
        end = read_run_end(path)
    except RecordError as problem:
        troubles.append(str(problem))
        return None
    if end.bad_lines:
        troubles.append(f"{path}: {end.bad_lines} lines of the last run's audit are damaged")
    if end.torn_bytes:
        troubles.append(f"{path}: the last line of the last run's audit is incomplete")
    return end
