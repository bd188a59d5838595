"""The audit as the API's messages: its entries after a number, and the timeline's lines."""

from pathlib import Path
from typing import Protocol, get_args

from recon.api import schema
from recon.api.schema.orders import TimelineSubject
from recon.record.audit.audit import NumberedEntry, harmless
from recon.station.state.imager_motion import AnyMotion

KINDS_OF: dict[TimelineSubject, tuple[str, ...]] = {
    "orders": ("order.", "all_stop.", "authority.", "lease.", "sticks."),
    "alarms": ("alarm.", "separation_hold.", "hazard."),
    "flights": ("vehicle.", "link.", "app."),
    "operations": (
        "survey.",
        "fleet_return.",
        *(f"{kind.rule}." for kind in get_args(AnyMotion)),
        "temporary_zone.",
        "site.",
    ),
    "station": ("station.", "record.", "audit.", "login.", "users.", "preflight."),
}
"""How the kinds of a subject's entries begin."""


class KeptEntries(Protocol):
    """The entries of an audit, as far as they are at hand."""

    @property
    def path(self) -> Path | None:
        """Return its file, if there is one."""

    @property
    def problem(self) -> str | None:
        """Why it cannot be written, while that is so."""

    @property
    def first_n(self) -> int:
        """The number of the oldest entry; 0 before the first."""

    @property
    def last_n(self) -> int:
        """The number of the latest entry; 0 before the first."""

    def after(self, n: int, at_most: int) -> list[NumberedEntry]:
        """Return the entries after a number, the oldest first."""

    def timeline(
        self, serial: str | None, kinds: tuple[str, ...], before_n: int | None, at_most: int
    ) -> list[NumberedEntry]:
        """Return notable entries, the newest first: of one vehicle, and of kinds that begin so."""


def timeline(
    log: KeptEntries | None,
    serial: str | None,
    about: TimelineSubject | None,
    before_n: int | None,
    at_most: int,
) -> schema.TimelineView:
    """Return what happened, the newest first; nothing without an audit."""
    if log is None:
        return schema.TimelineView(entries=[], has_more=False)
    kinds = () if about is None else KINDS_OF[about]
    found = log.timeline(serial, kinds, before_n, at_most + 1)
    entries = [_timeline_entry(stamped) for stamped in found[:at_most]]
    return schema.TimelineView(entries=entries, has_more=len(found) > at_most)


def audit_page(log: KeptEntries | None, after: int, at_most: int) -> schema.AuditPage:
    """Return entries after a number; an empty page without an audit."""
    if log is None:
        return schema.AuditPage(entries=[], first_n=0, last_n=0, file=None, problem=None)
    return schema.AuditPage(
        entries=[_audit_entry(stamped) for stamped in log.after(after, at_most)],
        first_n=log.first_n,
        last_n=log.last_n,
        file=None if log.path is None else log.path.name,
        problem=log.problem,
    )


def _timeline_entry(stamped: NumberedEntry) -> schema.TimelineEntryView:
    entry = stamped.entry
    return schema.TimelineEntryView(
        n=stamped.n,
        utc=stamped.utc,
        kind=entry.kind,
        by=entry.by,
        serial=entry.serial,
        vehicle=entry.vehicle,
        text=harmless(entry.text),
    )


def _audit_entry(stamped: NumberedEntry) -> schema.AuditEntryView:
    line = _timeline_entry(stamped)
    return schema.AuditEntryView(**dict(line), details=harmless(dict(stamped.entry.details)))
