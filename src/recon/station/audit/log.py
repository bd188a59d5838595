"""What the station did, one line an event, for the person at the terminal and the log file.

The lines are the audit's, in words. A terminal can stand still (Ctrl+S, a pipe that nobody reads):
they are printed on a thread of their own, which may wait while the station flies on.
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
    """Prints entries in their order; what a terminal that stands still cannot take is counted."""

    def __init__(self) -> None:
        self.left_out = 0
        self._waiting: queue.SimpleQueue[AuditEntry | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._print, name="log", daemon=True)

    def start(self) -> None:
        """Begin to print."""
        self._thread.start()

    def put(self, entry: AuditEntry) -> None:
        """Take an entry; never waits."""
        if entry.kind in _QUIET_KINDS:
            return
        if self._waiting.qsize() >= WAITING_LINES:
            self.left_out += 1
            return
        self._waiting.put(entry)

    def close(self) -> None:
        """Print what waits, as far as the terminal takes it in time."""
        if self._thread.is_alive():
            self._waiting.put(None)
            self._thread.join(CLOSE_WITHIN_S)

    def _print(self) -> None:
        while (entry := self._waiting.get()) is not None:
            if self.left_out:
                _log.warning(f"{self.left_out} lines were left out: nothing took them")
                self.left_out = 0
            say = _log.warning if entry.kind.startswith(_LOUD_KINDS) else _log.info
            say(shown(entry.text), by=shown(entry.by))
