"""The audit as the API's messages: its entries after a number, and the timeline's lines."""

from recon.api import schema
from recon.api.port import TimelineSubject
from recon.record.audit import NumberedEntry, harmless
from recon.record.audit_log import AuditLog

KINDS_OF: dict[TimelineSubject, tuple[str, ...]] = {
    "orders": ("order.", "all_stop.", "authority.", "lease.", "sticks."),
    "alarms": ("alarm.", "separation_hold.", "hazard."),
    "flights": ("vehicle.", "link.", "app."),
    "operations": (
        "survey.",
        "fleet_return.",
        "look_aside.",
        "move_upwind.",
        "temporary_zone.",
        "site.",
    ),
    "station": ("station.", "record.", "audit.", "login.", "users.", "preflight."),
}
"""How the kinds of a subject's entries begin."""


def timeline(
    log: AuditLog | None,
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


def audit_page(log: AuditLog | None, after: int, at_most: int) -> schema.AuditPage:
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
