"""The audit of a running station: the entries of every step, into the file, the log and memory."""

from collections.abc import Callable, Iterable

from recon.model.event import AuditFailed, Event, Tick
from recon.record.audit import AuditEntry
from recon.record.audit_log import AuditLog
from recon.station.audit.entries import Auditing, audit
from recon.station.audit.log import LogPrinter
from recon.station.state.station import Station


class Auditor:
    """Observes every step of a driver; never waits for a disk or a terminal."""

    def __init__(self, log: AuditLog, printer: LogPrinter, now_ns: Callable[[], int]) -> None:
        self.log = log
        self._printer = printer
        self._now_ns = now_ns
        self._memory = Auditing()
        self._reported_problem: str | None = None
        self.snapshot_problem: Callable[[], str | None] = lambda: None
        """Why the recovery snapshot cannot be written; None while it can."""
        self.handle: Callable[[Event], None] = lambda event: None
        """The driver's queue, for `AuditFailed`."""

    def observe(self, before: Station, after: Station, event: Event) -> None:
        """Write what a step changed; once a tick, report whether writing works."""
        now_ns = self._now_ns()
        self._memory, entries = audit(self._memory, before, event, after, now_ns)
        self.put(entries)
        if isinstance(event, Tick):
            problems = (self.log.problem, self.snapshot_problem())
            problem = "; ".join(each for each in problems if each is not None) or None
            if problem != self._reported_problem:
                self._reported_problem = problem
                self.handle(AuditFailed(problem))

    def put(self, entries: Iterable[AuditEntry]) -> None:
        """Write entries, also those of the station's start and end, which no step makes."""
        for entry in entries:
            self.log.put(entry, self._now_ns())
            self._printer.put(entry)
