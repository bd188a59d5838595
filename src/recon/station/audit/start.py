"""How a station's audit begins: the folder, what the last run left there, and the first lines."""

import os
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from recon import __version__
from recon.record.audit import FAILED_KIND, STARTED_KIND, STOPPED_KIND, AuditEntry
from recon.record.audit_files import RunEnd, audit_files, read_run_end
from recon.record.audit_log import AuditLog, refuse_other_writer
from recon.record.errors import RecordError
from recon.station.recovery.last_run import LastRun
from recon.station.recovery.restart import first_ids
from recon.station.state.settings import StationSettings

MOST_FILES_LOOKED_AT = 5
"""A start that was killed at once left a file that tells nothing; more than a few of them in a row
are no accident of a restart."""


@dataclass(frozen=True, slots=True)
class AuditPlace:
    """Where the audit goes. A folder that is `shared` by stations is written to, never read: what
    another station saw is not what this one knew."""

    folder: Path
    is_shared: bool = False


@dataclass(frozen=True, slots=True)
class Begun:
    """An audit ready to be written, and what the last run tells. `troubles` are sentences."""

    log: AuditLog
    last: LastRun
    troubles: tuple[str, ...]


def default_place(link_port: int, environment: Mapping[str, str] = os.environ) -> AuditPlace:
    """Return the place in the user's state folder: one folder a port, so that a station that is
    started again finds its own; without a fixed port, a folder that is only written to."""
    if sys.platform == "win32":
        base = Path(environment.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    else:
        base = Path(environment.get("XDG_STATE_HOME") or Path.home() / ".local" / "state")
    folder = base / "recon" / "audit"
    return (
        AuditPlace(folder / "any-port", True)
        if link_port == 0
        else AuditPlace(folder / f"port-{link_port}")
    )


def begin_audit(place: AuditPlace) -> Begun:
    """Read what the last run left and take up its chain.

    Raises `RecordError` only when another running station writes there: whatever else is wrong
    with the folder is no reason not to fly.
    """
    log, last = AuditLog(place.folder), LastRun()
    if place.is_shared:
        return Begun(log, last, ())
    refuse_other_writer(place.folder)
    try:
        files = audit_files(place.folder)
    except RecordError as problem:
        return Begun(log, last, (str(problem),))
    troubles: list[str] = []
    newest: RunEnd | None = None
    for path in reversed(files[-MOST_FILES_LOOKED_AT:]):
        run, end = _read(path, troubles)
        newest = end if newest is None or newest.last is None else newest
        if run.lines > 1:
            last = run
            break
    log.follow(newest)
    return Begun(log, last, tuple(troubles))


def started_entry(
    settings: StationSettings, site: Mapping[str, Any], last: LastRun, troubles: tuple[str, ...]
) -> AuditEntry:
    """Return the entry of a station's start: version, settings, site, and where it takes up."""
    details = {
        "version": __version__,
        "python": sys.version.split()[0],
        "site": dict(site),
        "first_id": first_ids(last)[0],
        "next_own_id": first_ids(last)[1],
        "last_run_ended_in_order": last.was_stopped,
        "last_run_lines": last.lines,
        "troubles": list(troubles),
        "settings": asdict(settings),
    }
    return AuditEntry(STARTED_KIND, f"the station starts, version {__version__}", details=details)


def ended_entry(problem: BaseException | None) -> AuditEntry:
    """Return the entry of a station's end, in order or by a fault of its own."""
    words = "what flies, flies on by its last order"
    if problem is None:
        return AuditEntry(STOPPED_KIND, f"the station stops; {words}")
    fault = f"{type(problem).__name__}: {problem}"
    return AuditEntry(FAILED_KIND, f"the station ends by a fault ({fault}); {words}")


def _read(path: Path, troubles: list[str]) -> tuple[LastRun, RunEnd | None]:
    run = LastRun()
    try:
        end = read_run_end(path, run.take)
    except RecordError as problem:
        troubles.append(str(problem))
        return run, None
    if end.bad_lines:
        troubles.append(f"{path}: {end.bad_lines} lines of the last run's audit are damaged")
    if end.torn_bytes:
        troubles.append(f"{path}: the last run's audit ends in a line cut short")
    return run, end
