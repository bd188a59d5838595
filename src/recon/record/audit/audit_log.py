"""Writing the audit: entries are queued at once and written by a thread.

Theory of operation. `put` only appends to a queue, so nothing on the event loop, an emergency order
least of all, ever waits for a disk. The thread writes each line as soon as it comes: then it
survives the end of the process. It syncs the file at least five times a second: then it survives a
power failure.

    open --disk full or gone--> failing --written again--> open
    open --file deleted by another program--> failing --new file--> open

While writing fails, `problem` has the reason, an alarm is active, entries wait in the queue and the
write is tried again every second. When the queue is full the oldest entries are lost, and a line in
their place states how many. A line written in part is completed, never started anew.
"""

import contextlib
import os
import queue
import threading
import time
from collections import deque
from collections.abc import Callable
from itertools import islice
from pathlib import Path
from typing import Any

from recon.model.errors import RecordError
from recon.record.audit.audit import (
    LOST_KIND,
    NO_LINE_BEFORE,
    OPENED_KIND,
    AuditEntry,
    NumberedEntry,
    encode_line,
    line_hash,
)
from recon.record.audit.audit_files import RunEnd, audit_files, next_file_name
from recon.record.files.file_lock import lock_file

WAITING_ENTRIES = 4096
"""A minute of the busiest traffic; some 4 MiB."""

KEPT_ENTRIES = 2000
"""The latest ones stay in memory for the API."""

KEPT_NOTABLE = 5000
"""Entries that are not quiet: positions of a large fleet would push them out within minutes."""

BATCH_ENTRIES = 256
"""Written at a time."""

SYNC_EVERY_S = 0.2
RETRY_AFTER_S = 1.0
CLOSE_WITHIN_S = 3.0
"""A disk that hangs must not keep a stopped station from ending."""


class AuditLog:
    """Writes one run's audit into a folder. `put` and `after` belong to one thread."""

    def __init__(
        self,
        folder: Path,
        utc_ns: Callable[[], int] = time.time_ns,
        quiet_kinds: frozenset[str] = frozenset(),
    ) -> None:
        """Take the folder, and the kinds that the timeline excludes.

        Nothing is opened before `start`.
        """
        self.folder = folder
        self.path: Path | None = None
        """This run's file, once there is one."""
        self.problem: str | None = None
        """Why nothing can be written, while that is so."""
        self._utc_ns = utc_ns
        self._waiting: queue.SimpleQueue[NumberedEntry | None] = queue.SimpleQueue()
        self._kept: deque[NumberedEntry] = deque(maxlen=KEPT_ENTRIES)
        self._notable: deque[NumberedEntry] = deque(maxlen=KEPT_NOTABLE)
        self._quiet_kinds = quiet_kinds
        self._next_n = 1
        self._run_before: dict[str, Any] | None = None
        self._file: int | None = None
        self._hash = NO_LINE_BEFORE
        self.written_n = 0
        """The number of the latest entry in the file: it survives the end of the process."""
        self._encoded_n = 0
        self._unwritten = b""
        self._synced_at_s = 0.0
        self._is_synced = True
        self._thread = threading.Thread(target=self._write, name="audit", daemon=True)

    def follow(self, previous: RunEnd | None) -> None:
        """Take up the chain where the run before ended; before `start`."""
        if previous is None or previous.last is None or previous.last_hash is None:
            return
        self._hash = previous.last_hash
        self._run_before = {
            "file": previous.path.name,
            "n": previous.last.n,
            "hash": previous.last_hash,
            "torn_bytes": previous.torn_bytes,
        }

    def start(self) -> None:
        """Start the thread. A folder that cannot be written raises an alarm; flying continues."""
        self._thread.start()

    def put(self, entry: AuditEntry, t_ns: int) -> NumberedEntry:
        """Take an entry; never waits."""
        stamped = NumberedEntry(self._next_n, self._utc_ns(), t_ns, entry)
        self._next_n += 1
        self._kept.append(stamped)
        if entry.kind not in self._quiet_kinds:
            self._notable.append(stamped)
        if self._waiting.qsize() >= WAITING_ENTRIES:
            with contextlib.suppress(queue.Empty):
                self._waiting.get_nowait()
        self._waiting.put(stamped)
        return stamped

    def after(self, n: int, at_most: int) -> list[NumberedEntry]:
        """Return the entries after a number, the oldest first, as far as they are kept."""
        if not self._kept or n >= self._kept[-1].n:
            return []
        first = max(0, n + 1 - self._kept[0].n)
        return [self._kept[i] for i in range(first, min(first + at_most, len(self._kept)))]

    def timeline(
        self, serial: str | None, kinds: tuple[str, ...], before_n: int | None, at_most: int
    ) -> list[NumberedEntry]:
        """Return notable entries, the newest first: of one vehicle, and of kinds that begin so.

        None stands for all vehicles, and for the newest entry; no kinds for all.
        """
        found = (
            stamped
            for stamped in reversed(self._notable)
            if (before_n is None or stamped.n < before_n)
            and (serial is None or stamped.entry.serial == serial)
            and (not kinds or stamped.entry.kind.startswith(kinds))
        )
        return list(islice(found, at_most))

    @property
    def first_n(self) -> int:
        """The number of the oldest entry in memory; 0 before the first."""
        return self._kept[0].n if self._kept else 0

    @property
    def last_n(self) -> int:
        """The number of the latest entry; 0 before the first."""
        return self._next_n - 1

    @property
    def waiting(self) -> int:
        """How many entries are not in the file yet."""
        return self._waiting.qsize()

    def close(self) -> None:
        """Write what is queued, as far as the disk takes it in time, and end."""
        if self._thread.is_alive():
            self._waiting.put(None)
            self._thread.join(CLOSE_WITHIN_S)

    def _write(self) -> None:
        is_ending = False
        while not is_ending:
            batch, is_ending = self._next_batch()
            while not self._try_to_write(batch) and not is_ending:
                time.sleep(RETRY_AFTER_S)
        if self._file is not None:
            with contextlib.suppress(OSError):
                os.fsync(self._file)
                os.close(self._file)

    def _next_batch(self) -> tuple[list[NumberedEntry], bool]:
        """Wait for entries, no longer than until the disk is to be asked; return all there are."""
        wait_s = None if self._is_synced else max(0.0, self._sync_due_s() - time.monotonic())
        batch: list[NumberedEntry] = []
        try:
            item = self._waiting.get(timeout=wait_s)
            while item is not None:
                batch.append(item)
                if len(batch) == BATCH_ENTRIES:
                    return batch, False
                item = self._waiting.get_nowait()
        except queue.Empty:
            return batch, False
        return batch, True

    def _try_to_write(self, batch: list[NumberedEntry]) -> bool:
        """Write a batch's lines; on a second call with the same one, only what is still missing."""
        try:
            self._be_open()
            self._encode(batch)
            batch.clear()
            self._append()
            if not self._is_synced and time.monotonic() >= self._sync_due_s():
                self._sync()
        except (OSError, RecordError) as problem:
            reason = problem.strerror if isinstance(problem, OSError) else str(problem)
            self.problem = f"the audit cannot be written to {self.folder}: {reason}"
            return False
        self.problem = None
        return True

    def _encode(self, batch: list[NumberedEntry]) -> None:
        lines = [self._unwritten]
        for stamped in batch:
            missing = stamped.n - self._encoded_n - 1
            if missing > 0:
                lines.append(self._line(self._lost(stamped, missing)))
            lines.append(self._line(stamped))
        self._unwritten = b"".join(lines)

    def _lost(self, following: NumberedEntry, count: int) -> NumberedEntry:
        text = f"{count} entries before this one could not be written and are lost"
        entry = AuditEntry(LOST_KIND, text, details={"count": count})
        return NumberedEntry(following.n - 1, following.utc_ns, following.t_ns, entry)

    def _line(self, stamped: NumberedEntry) -> bytes:
        line = encode_line(stamped, self._hash)
        self._hash, self._encoded_n = line_hash(line), stamped.n
        return line + b"\n"

    def _append(self) -> None:
        assert self._file is not None
        while self._unwritten:
            written = os.write(self._file, self._unwritten)
            # A line that was written in part is completed by the next call, never begun anew.
            self._unwritten = self._unwritten[written:]
            self._is_synced = False
        self.written_n = self._encoded_n

    def _sync(self) -> None:
        assert self._file is not None
        os.fsync(self._file)
        self._is_synced, self._synced_at_s = True, time.monotonic()

    def _sync_due_s(self) -> float:
        return self._synced_at_s + SYNC_EVERY_S

    def _be_open(self) -> None:
        """Ensure an open file; a deleted one is reported, and a new one begun."""
        if self._file is not None and os.fstat(self._file).st_nlink == 0:
            os.close(self._file)
            self._file, self._unwritten = None, b""
            raise RecordError("its file was deleted; a new one is begun")
        if self._file is None:
            self._open()

    def _open(self) -> None:
        """Create a file, for its owner alone, locked for as long as the run lasts."""
        self.folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        files = audit_files(self.folder) + ([] if self.path is None else [self.path])
        path = self.folder / next_file_name(files, self._utc_ns())
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND, 0o600)
        lock_file(self._file)
        previous = self._run_before if self.path is None else self._file_before(self.path)
        self.path = path
        entry = AuditEntry(OPENED_KIND, "the audit begins", details={"previous": previous})
        now_ns = self._utc_ns()
        self._unwritten = self._line(NumberedEntry(self._encoded_n, now_ns, now_ns, entry))

    def _file_before(self, path: Path) -> dict[str, Any]:
        return {"file": path.name, "n": self._encoded_n, "hash": self._hash}


def refuse_other_writer(folder: Path) -> None:
    """Raise `RecordError` when a running station writes into the folder's last file."""
    for path in audit_files(folder)[-1:]:
        try:
            file = os.open(path, os.O_RDONLY)
        except OSError:
            continue
        try:
            lock_file(file)
        except OSError as problem:
            raise RecordError(
                f"another running station writes its audit to {folder}: give each station a "
                "folder of its own with --audit"
            ) from problem
        finally:
            os.close(file)
