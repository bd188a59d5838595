"""The audit of a running station: the entries of every step, into the file and on the terminal.

A terminal can block (Ctrl+S, a pipe without a reader), so a thread of its own prints the lines and
only that thread waits.
"""

import queue
import threading
from collections.abc import Callable, Iterable

from recon.model.event import AuditFailed, Event, Tick
from recon.record.audit.audit import AuditEntry, shown
from recon.record.audit.audit_log import AuditLog
from recon.station.audit.entries import Auditing, audit
from recon.station.audit.flight_entries import POSITION_KIND
from recon.station.audit.log_line import print_info, print_warning
from recon.station.state.steps import StepTaken

WAITING_LINES = 1000
CLOSE_WITHIN_S = 1.0

_QUIET_KINDS = frozenset({POSITION_KIND})
_LOUD_KINDS = ("alarm.raised", "alarm.worse", "order.refused", "order.failed", "audit.trouble")


class LogPrinter:
    """Prints entries in order; counts those dropped while the terminal blocks."""

    def __init__(self) -> None:
        self.dropped = 0
        self._waiting: queue.SimpleQueue[AuditEntry | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._print, name="log", daemon=True)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def put(self, entry: AuditEntry) -> None:
        """Take an entry; never waits."""
        if entry.kind in _QUIET_KINDS:
            return
        if self._waiting.qsize() >= WAITING_LINES:
            self.dropped += 1
            return
        self._waiting.put(entry)

    def close(self) -> None:
        """Print the waiting lines, as far as the terminal accepts them in time."""
        if self._thread.is_alive():
            self._waiting.put(None)
            self._thread.join(CLOSE_WITHIN_S)

    def _print(self) -> None:
        while (entry := self._waiting.get()) is not None:
            if self.dropped:
                print_warning(f"{self.dropped} lines dropped: the terminal was blocked")
                self.dropped = 0
            print_line = print_warning if entry.kind.startswith(_LOUD_KINDS) else print_info
            print_line(shown(entry.text), shown(entry.by))


class Auditor:
    """Observes every step of a driver; never waits for a disk or a terminal."""

    def __init__(self, log: AuditLog, printer: LogPrinter, now_ns: Callable[[], int]) -> None:
        self.log = log
        self.printer = printer
        """Started by whoever runs the station, once nothing can refuse its start any more: entries
        wait until then."""
        self._now_ns = now_ns
        self.memory = Auditing()
        self.entries: tuple[AuditEntry, ...] = ()
        """The newest step's entries."""
        self._reported_problem: str | None = None
        self.snapshot_problem: Callable[[], str | None] = lambda: None
        """Why the recovery snapshot cannot be written; None while it can."""
        self.handle: Callable[[Event], None] = lambda event: None
        """The driver's queue, for `AuditFailed`."""

    def observe(self, step: StepTaken) -> None:
        """Write what a step changed; once a tick, report whether writing works."""
        self.entries = ()
        self.memory, self.entries = audit(
            self.memory, step.before, step.event, step.after, step.now_ns
        )
        self.put(self.entries)
        if isinstance(step.event, Tick):
            problems = (self.log.problem, self.snapshot_problem())
            problem = "; ".join(each for each in problems if each is not None) or None
            if problem != self._reported_problem:
                self._reported_problem = problem
                self.handle(AuditFailed(problem))

    def put(self, entries: Iterable[AuditEntry]) -> None:
        """Write entries, also those of the station's start and end, which no step makes."""
        for entry in entries:
            self.log.put(entry, self._now_ns())
            self.printer.put(entry)
