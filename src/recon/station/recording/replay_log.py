"""The audit of a recorded flight, for a replay's timeline and for the marks of its slider.

A thread reads it through the whole record during the replay; what was read so far is shown.
Of a moment it has the entries up to then.
"""

import threading
import time
from bisect import bisect_right
from collections.abc import Callable
from itertools import islice
from pathlib import Path
from typing import Any, Literal

import msgspec

from recon.api import schema
from recon.model.errors import RecordError
from recon.model.units import ns_to_seconds
from recon.record.audit.audit import AuditEntry, NumberedEntry
from recon.record.mcap.mcap_file import STEPS_TOPIC
from recon.record.mcap.record_file import RecordFile
from recon.station.audit.flight_entries import FLYING_KIND, POSITION_KIND, TOOK_OFF_KIND

MOST_ENTRIES = 500_000
MOST_MARKS = 2_000
"""Most marks: more than a slider has pixels."""
MARKED_KINDS: dict[str, Literal["alarm", "order"]] = {
    "alarm.raised": "alarm",
    "alarm.worse": "alarm",
    "all_stop.latched": "order",
    "order.queued": "order",
    "order.refused": "order",
    "order.failed": "order",
}
BREATH_S = 0.002
"""Pause after each chunk: the replay itself has priority."""


class _RecordedEntry(msgspec.Struct, frozen=True):
    kind: str
    text: str
    by: str
    serial: str | None
    vehicle: str
    details: dict[str, Any]


class _Audited(msgspec.Struct, frozen=True):
    """The audit of a recorded step; the rest of it is passed over."""

    audit: list[_RecordedEntry]


class RecordedLog:
    """The entries of a record, as far as they were read and up to the replay's moment."""

    path: Path | None = None
    problem: str | None = None
    first_flight_ns: int | None = None
    """When the first vehicle took off or connected in flight; None while none was read."""

    def __init__(self, path: Path, now_ns: Callable[[], int], ends_ns: int) -> None:
        """Take the record and its end; nothing is read before `start`.

        `now_ns` is the replay's clock.
        """
        self._record = path
        self._now_ns, self._ends_ns = now_ns, ends_ns
        self._entries: list[NumberedEntry] = []
        self._times_ns: list[int] = []
        self._share = 0.0
        self._is_closing = False
        self._thread = threading.Thread(target=self._run, name="replay-log", daemon=True)

    def start(self) -> None:
        """Start to read."""
        self._thread.start()

    def close(self) -> None:
        """End the thread."""
        self._is_closing = True
        if self._thread.is_alive():
            self._thread.join()

    def read(self) -> None:
        """Read the record to its end, or to where it is damaged; raises OSError."""
        file = RecordFile(self._record)
        try:
            for number in range(file.chunk_count):
                if self._is_closing:
                    return
                for item in file.messages(number, number + 1, {STEPS_TOPIC}):
                    self._take(item.data, item.log_ns)
                self._share = (number + 1) / file.chunk_count
                time.sleep(BREATH_S)
        finally:
            file.close()

    def marks(self, begins_ns: int) -> schema.ReplayMarksView:
        """Return alarms and orders of the whole record, as far as it was read."""
        found = [
            schema.ReplayMark(
                at_s=max(0.0, ns_to_seconds(each.t_ns - begins_ns)),
                kind=MARKED_KINDS[each.entry.kind],
                text=each.entry.text[:200],
            )
            for each in self._entries
            if each.entry.kind in MARKED_KINDS
        ]
        return schema.ReplayMarksView(marks=found[:MOST_MARKS], read_share=self._share)

    @property
    def first_n(self) -> int:
        """The number of the first entry; 0 before it."""
        return 1 if self.last_n else 0

    @property
    def last_n(self) -> int:
        """The number of the latest entry up to the replay's moment; 0 before the first."""
        return bisect_right(self._times_ns, self._now_ns())

    def after(self, n: int, at_most: int) -> list[NumberedEntry]:
        """Return the entries after a number, the oldest first."""
        return self._entries[n : min(self.last_n, n + at_most)]

    def timeline(
        self, serial: str | None, kinds: tuple[str, ...], before_n: int | None, at_most: int
    ) -> list[NumberedEntry]:
        """Return notable entries, the newest first: of one vehicle, and of kinds that begin so."""
        last = self.last_n if before_n is None else min(self.last_n, before_n - 1)
        newest_first = (self._entries[n] for n in range(last - 1, -1, -1))
        found = (
            each
            for each in newest_first
            if each.entry.kind != POSITION_KIND
            and (serial is None or each.entry.serial == serial)
            and (not kinds or each.entry.kind.startswith(kinds))
        )
        return list(islice(found, at_most))

    def _run(self) -> None:
        try:
            self.read()
        except (OSError, RecordError) as problem:
            self.problem = f"the record cannot be read to its end: {problem}"
        self._share = 1.0

    def _take(self, data: bytes, at_ns: int) -> None:
        try:
            entries = msgspec.msgpack.decode(data, type=_Audited).audit
        except (msgspec.MsgspecError, ValueError, RecursionError) as problem:
            raise RecordError(f"a step is damaged: {problem}") from problem
        for each in entries:
            if len(self._entries) >= MOST_ENTRIES:
                return
            entry = AuditEntry(
                each.kind, each.text, each.by, each.serial, each.vehicle, each.details
            )
            before_ns = self._times_ns[-1] if self._times_ns else at_ns
            at_ns = min(max(at_ns, before_ns), self._ends_ns)
            self._entries.append(NumberedEntry(len(self._entries) + 1, at_ns, at_ns, entry))
            self._times_ns.append(at_ns)
            if self.first_flight_ns is None and each.kind in (TOOK_OFF_KIND, FLYING_KIND):
                self.first_flight_ns = at_ns
