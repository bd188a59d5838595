"""The audit as the API says it."""

from recon.api import schema
from recon.record.audit import Stamped, harmless
from recon.record.audit_log import AuditLog


def audit_page(log: AuditLog | None, after: int, at_most: int) -> schema.AuditPage:
    """Return entries after a number; an empty page where no audit is kept."""
    if log is None:
        return schema.AuditPage(entries=[], first_n=0, last_n=0, file=None, problem=None)
    return schema.AuditPage(
        entries=[_entry(stamped) for stamped in log.after(after, at_most)],
        first_n=log.first_n,
        last_n=log.last_n,
        file=None if log.path is None else log.path.name,
        problem=log.problem,
    )


def _entry(stamped: Stamped) -> schema.AuditEntryView:
    entry = stamped.entry
    return schema.AuditEntryView(
        n=stamped.n,
        utc=stamped.utc,
        kind=entry.kind,
        by=entry.by,
        serial=entry.serial,
        vehicle=entry.vehicle,
        text=harmless(entry.text),
        details=harmless(dict(entry.details)),
    )
