"""The audit of a running station: every step's entries, into the file, the log and the memory."""

from collections.abc import Callable, Iterable

from recon.model.event import AuditTroubled, Event, Tick
from recon.record.audit import AuditEntry
from recon.record.audit_log import AuditLog
from recon.station.audit.entries import Auditing, audit
from recon.station.audit.log import LogPrinter
from recon.station.state.station import Station


class Auditor:
    """Sees every step of a driver. Nothing here waits: not for a disk, not for a terminal."""

    def __init__(self, log: AuditLog, printer: LogPrinter, now_ns: Callable[[], int]) -> None:
        self.log = log
        self._printer = printer
        self._now_ns = now_ns
        self._memory = Auditing()
        self._told_problem: str | None = None
        self.handle: Callable[[Event], None] = lambda event: None
        """Where to say that the audit cannot be written; the driver's queue."""

    def observe(self, before: Station, after: Station, event: Event) -> None:
        """Take what a step changed into the audit."""
        now_ns = self._now_ns()
        self._memory, entries = audit(self._memory, before, event, after, now_ns)
        self.put(entries)
        if isinstance(event, Tick) and self.log.problem != self._told_problem:
            self._told_problem = self.log.problem
            self.handle(AuditTroubled(self._told_problem))

    def put(self, entries: Iterable[AuditEntry]) -> None:
        """Take entries that no step made: the station's own start and end."""
        for entry in entries:
            self.log.put(entry, self._now_ns())
            self._printer.put(entry)
