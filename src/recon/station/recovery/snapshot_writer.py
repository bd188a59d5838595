"""Writes the recovery snapshot outside the event loop, on a thread of its own.

The event loop only hands over the newest station, which is an immutable value. The thread writes it
every half second, and at once when an order begins or ends, an all stop is pressed or released,
authority changes, a temporary zone is drawn or ended, or a lost vehicle appears or is dismissed:
what a restart restores is at most one second old. Of states that arrive during a write only the
newest is written next. A disk that is full or gone is a `problem`, which the auditor turns into an
alarm, and the write is tried again.
"""

import threading
import time
from collections.abc import Callable
from pathlib import Path

from recon.model.errors import describe_fault
from recon.record.files.snapshot_file import read_snapshot, write_snapshot
from recon.station.recovery.restart import LastRun
from recon.station.recovery.snapshot import (
    decode_snapshot,
    encode_snapshot,
    open_orders,
    take_snapshot,
)
from recon.station.state.station import Station
from recon.station.state.steps import StepTaken

WRITE_EVERY_S = 0.5
CLOSE_WITHIN_S = 3.0
"""A disk that hangs must not keep a stopped station from ending."""


def load_last_run(folder: Path, runs_before: int) -> tuple[LastRun, bool]:
    """Return what the last run left in a folder, and whether its current snapshot file is good."""
    read = read_snapshot(folder, decode_snapshot)
    troubles = read.troubles
    if read.value is None and runs_before and not troubles:
        troubles = (f"no recovery snapshot in {folder}, although a station has run there",)
    return LastRun(read.value, troubles, runs_before), read.is_current_good


class SnapshotWriter:
    """Keeps the recovery snapshot of a running station up to date."""

    def __init__(
        self,
        folder: Path,
        now_ns: Callable[[], int],
        *,
        last_order_id: int = 0,
        keep_current: bool = False,
    ) -> None:
        """`last_order_id` is the highest order id of earlier runs; `keep_current`: the file in
        the folder is good, and stays as the previous one."""
        self.problem: str | None = None
        """Why the snapshot cannot be written, while that is so."""
        self._folder = folder
        self._now_ns = now_ns
        self._last_order_id = last_order_id
        self._keep_current = keep_current
        self._latest: tuple[Station, int] | None = None
        self._written: tuple[Station, int] | None = None
        self._wakes = threading.Event()
        self._is_ending = False
        self._thread = threading.Thread(target=self._run, name="snapshot", daemon=True)

    def start(self, station: Station) -> None:
        """Begin to write, with the restored station at once: another crash may follow soon."""
        self._latest = (station, self._now_ns())
        self._wakes.set()
        self._thread.start()

    def observe(self, step: StepTaken) -> None:
        """Take the newest station; never waits."""
        self._latest = (step.after, self._now_ns())
        if is_urgent(step.before, step.after):
            self._wakes.set()

    def close(self) -> None:
        """Write the last state, as far as the disk takes it in time, and end."""
        self._is_ending = True
        self._wakes.set()
        if self._thread.is_alive():
            self._thread.join(CLOSE_WITHIN_S)

    def _run(self) -> None:
        is_last = False
        while not is_last:
            self._wakes.wait(WRITE_EVERY_S)
            self._wakes.clear()
            is_last = self._is_ending
            if self._latest is not self._written and not self._try_to_write():
                # No busy loop on a full disk: orders keep setting the event.
                time.sleep(0.0 if is_last else WRITE_EVERY_S)

    def _try_to_write(self) -> bool:
        latest = self._latest
        assert latest is not None
        try:
            self._write(*latest)
        except OSError as problem:
            reason = problem.strerror or str(problem)
            self.problem = f"the recovery snapshot cannot be written to {self._folder}: {reason}"
            return False
        except Exception as fault:
            # This thread must survive whatever is in the station: the next state may do.
            self.problem = f"the recovery snapshot cannot be taken: {describe_fault(fault)}"
            return False
        self._written, self.problem = latest, None
        return True

    def _write(self, station: Station, now_ns: int) -> None:
        snapshot = take_snapshot(station, now_ns, self._last_order_id)
        self._last_order_id = snapshot.last_order_id
        write_snapshot(self._folder, encode_snapshot(snapshot), keep_current=self._keep_current)
        self._keep_current = True


def is_urgent(before: Station, after: Station) -> bool:
    """Return whether a step changed what a restart must not lose even for half a second."""
    for serial, control in after.controls_changed_since(before):
        if control.authority is not before.control(serial).authority:
            return True
    if after.stop_latch is not before.stop_latch:
        return True
    if after.temporary_zones is not before.temporary_zones:
        return True
    watchdogs, watchdogs_before = after.watchdog_state, before.watchdog_state
    if watchdogs.lost is not watchdogs_before.lost:
        return True
    if watchdogs.dismissed is not watchdogs_before.dismissed:
        return True
    if after.orders.tracked is before.orders.tracked:
        return False
    return _open_ids(after) != _open_ids(before)


def _open_ids(station: Station) -> list[int]:
    return [record.command.id for record in open_orders(station)]
