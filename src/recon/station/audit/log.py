"""The audit's sentences on the terminal, one line each.

A terminal can block (Ctrl+S, a pipe without a reader), so a thread of its own prints them and
only that thread waits.
"""

import queue
import threading

import structlog

from recon.record.audit import AuditEntry, shown
from recon.station.audit.flight_entries import POSITION_KIND

_log = structlog.get_logger("recon")

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
                _log.warning(f"{self.dropped} lines dropped: the terminal was blocked")
                self.dropped = 0
            print_line = _log.warning if entry.kind.startswith(_LOUD_KINDS) else _log.info
            print_line(shown(entry.text), by=shown(entry.by))
