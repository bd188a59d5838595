"""Writing the records of a run: items in, MCAP files out. Runs in a process of its own.

Theory of operation. A file begins with a `Begin` item and ends with the next one, or with the last
item. A chunk is written and synced three times a second: a process that is killed, or a power cut,
costs what came in the last third of a second and one write.

    open --folder or disk fails--> failing --written again--> open
    open --little space left--> without images --space again--> open

While writing fails it is tried again every second and nothing is taken: what waits, and what is
dropped, is the sender's affair (`record_process.py`). With less than `IMAGES_STOP_BYTES` left on
the disk, frames are excluded, and their bytes on the links; telemetry, orders and audit are written
to the last byte.

A file is called `ground-UTC.mcap` until a vehicle takes off, and `flight-UTC.mcap` from then on. Of
the former the newest `GROUND_FILES_KEPT` stay; a flight is never removed. A start finishes the
files of runs that were killed before it begins its own.
"""

import contextlib
import os
import queue
import shutil
import sys
import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Protocol

from recon.model.errors import RecordError, describe_fault
from recon.model.units import NS_PER_S
from recon.record.files.file_lock import lock_file
from recon.record.mcap.items import Status
from recon.record.mcap.mcap_file import McapFile
from recon.record.mcap.mcap_repair import repair
from recon.record.mcap.topics import Topics

FLUSH_EVERY_S = 0.33
"""A busy computer with five programs for each core adds half a second; a power cut may cost one."""
RETRY_AFTER_S = 1.0

IMAGES_STOP_BYTES = 2 * 1024**3
"""Telemetry, orders and audit of a day need a tenth of it; the computer needs some as well."""
IMAGES_AGAIN_BYTES = 3 * 1024**3

GROUND, FLIGHT = "ground", "flight"
GROUND_FILES_KEPT = 2
CAN_RENAME_OPEN_FILES = sys.platform != "win32"
"""Elsewhere each file is named as a flight from its beginning, and none is removed."""


class Inbox(Protocol):
    """Where items come from: a queue."""

    def get(self, *, timeout: float) -> Any:
        """Return the next item, None after the last; raises `queue.Empty` after the timeout."""


class Messages(Protocol):
    """Makes messages of items."""

    def begin(self, item: Any, topics: Topics) -> None:
        """Write the beginning of a file."""

    def write(self, item: Any, topics: Topics, *, with_images: bool) -> None:
        """Write one item."""

    def flush(self, topics: Topics, *, with_images: bool) -> None:
        """Write what must not wait any longer; a chunk is about to be written."""

    def finish(self, topics: Topics, *, with_images: bool) -> None:
        """Write what still waits; the file is about to end."""


class RecordWriter:
    """Writes records into a folder."""

    def __init__(
        self,
        folder: Path,
        messages: Messages,
        inbox: Inbox,
        library: str,
        begins: Callable[[Any], bool],
        has_flown: Callable[[Any], bool] = lambda item: False,
        report: Callable[[Status], None] = lambda status: None,
        free_bytes: Callable[[Path], int] = lambda folder: shutil.disk_usage(folder).free,
    ) -> None:
        """`begins` and `has_flown` recognise the items that begin a file and make it a flight's."""
        self.folder = folder
        self.path: Path | None = None
        self.repaired: tuple[Path, ...] | None = None
        self.is_ending = False
        """Set when no item follows: a disk that fails is then not waited for."""
        self._messages, self._inbox, self._library = messages, inbox, library
        self._begins, self._has_flown, self._report = begins, has_flown, report
        self._free_bytes = free_bytes
        self._topics: Topics | None = None
        self._failure: str | None = None
        self._faults: str | None = None
        self._has_images = True
        self._unnamed_flights: set[Path] = set()

    @property
    def problem(self) -> str | None:
        """What the file that is written lacks, and why; None while everything is recorded."""
        if self._failure is not None:
            return self._failure
        if not self._has_images:
            return (
                f"less than {IMAGES_STOP_BYTES // 1024**3} GiB are free in {self.folder}: "
                "recording continues without images"
            )
        return self._faults

    def run(self) -> None:
        """Write until the last item is written."""
        is_over = False
        while not is_over:
            is_over = self._take_until(time.monotonic() + FLUSH_EVERY_S)
            self._look_at_disk()
            if self._topics is not None:
                self._retry(self._flush)
            self._report_status()
        self._end_file()
        self._report_status()

    def _take_until(self, at_s: float) -> bool:
        """Take items until a time, or until the chunk is full; return whether that was all."""
        while self._topics is None or not self._topics.file.is_chunk_full:
            try:
                item = self._inbox.get(timeout=max(0.0, at_s - time.monotonic()))
            except queue.Empty:
                return False
            if item is None:
                return True
            self._take(item)
        return False

    def _take(self, item: Any) -> None:
        if self._begins(item):
            self._end_file()
            self._faults = None
            self._retry(self._open)
            # A list of the folder states which file grows.
            self._report_status()
            self._guarded(lambda topics: self._messages.begin(item, topics))
        elif self._has_flown(item):
            self._name_flight()
        else:
            self._guarded(
                lambda topics: self._messages.write(item, topics, with_images=self._has_images)
            )

    def _guarded(self, write: Callable[[Topics], None]) -> None:
        """One item that cannot be encoded must not end the record of all others."""
        if self._topics is None:
            return
        try:
            write(self._topics)
        except Exception as fault:
            self._faults = f"a part of the record is missing: {describe_fault(fault)}"

    def _look_at_disk(self) -> None:
        try:
            free_bytes = self._free_bytes(self.folder)
        except OSError:
            return
        least_bytes = IMAGES_STOP_BYTES if self._has_images else IMAGES_AGAIN_BYTES
        self._has_images = free_bytes >= least_bytes

    def _retry(self, act: Callable[[], None]) -> None:
        while not self._try(act):
            self._report_status()
            if self.is_ending:
                return
            time.sleep(RETRY_AFTER_S)

    def _try(self, act: Callable[[], None]) -> bool:
        try:
            act()
        except (OSError, RecordError) as problem:
            reason = problem.strerror if isinstance(problem, OSError) else str(problem)
            self._failure = f"the record cannot be written to {self.folder}: {reason}"
            return False
        self._failure = None
        return True

    def _flush(self) -> None:
        assert self._topics is not None
        self._guarded(lambda t: self._messages.flush(t, with_images=self._has_images))
        self._topics.file.flush()

    def _open(self) -> None:
        self.folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        if self.repaired is None:
            self.repaired = tuple(repair_all(self.folder))
        kind = GROUND if CAN_RENAME_OPEN_FILES else FLIGHT
        file = McapFile(_free_name(self.folder, kind), self._library)
        lock_file(file.descriptor)
        self.path, self._topics = file.path, Topics(file)
        _remove_old_ground_files(self.folder, {self.path, *self._unnamed_flights})

    def _end_file(self) -> None:
        if self._topics is not None:
            self._guarded(lambda t: self._messages.finish(t, with_images=self._has_images))
            self._retry(self._topics.file.finish)
            self._topics = None

    def _name_flight(self) -> None:
        path = self.path
        if path is None or not path.name.startswith(GROUND) or self._topics is None:
            return
        flight = path.with_name(path.name.replace(GROUND, FLIGHT, 1))
        try:
            path.rename(flight)
        except OSError as problem:
            self._unnamed_flights.add(path)
            self._faults = (
                f"the flight's record {path} cannot be renamed to {flight.name}; copy it before "
                f"the next start, which may remove it: {problem.strerror}"
            )
            return
        self.path = self._topics.file.path = flight
        self._report_status()

    def _report_status(self) -> None:
        path = None if self.path is None else str(self.path)
        repaired = tuple(map(str, self.repaired or ()))
        self._report(Status(path, self.problem, time.process_time(), repaired))


def repair_all(folder: Path) -> list[Path]:
    """Finish the files that killed runs have left in a folder; one being written is locked."""
    repaired: list[Path] = []

    def finish(path: Path) -> None:
        if repair(path) is not None:
            repaired.append(path)

    for path in sorted(folder.glob("*.mcap")):
        if_unlocked(path, finish)
    return repaired


def _remove_old_ground_files(folder: Path, kept: set[Path]) -> None:
    others = sorted(path for path in folder.glob(f"{GROUND}-*.mcap") if path not in kept)
    for path in others[: max(0, len(others) - GROUND_FILES_KEPT)]:
        if_unlocked(path, Path.unlink)


def if_unlocked(path: Path, act: Callable[[Path], None]) -> None:
    """Do something to a file that no other process uses; what fails leaves it as it is."""
    with contextlib.suppress(OSError, RecordError):
        descriptor = os.open(path, os.O_RDWR)
        try:
            lock_file(descriptor)
            act(path)
        finally:
            os.close(descriptor)


def _free_name(folder: Path, kind: str) -> Path:
    stamp = datetime.fromtimestamp(time.time_ns() // NS_PER_S, UTC).strftime("%Y%m%dT%H%M%SZ")
    tails = ("", *(f"-{n}" for n in range(2, 1000)))
    return next(
        folder / f"{kind}-{stamp}{tail}.mcap"
        for tail in tails
        if not any((folder / f"{any_}-{stamp}{tail}.mcap").exists() for any_ in (GROUND, FLIGHT))
    )
