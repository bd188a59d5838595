"""A bounded raw capture of every link's bytes with times: the way to debug a real phone.

One file a link: the line RECONCAP1, then records of time (u64, ns), direction (u8: 0 from the app,
1 to it), length (u32) and the bytes, big-endian. `recon inspect` reads it. Writing happens on a
thread of its own; what it cannot keep up with, or what passes a limit, is dropped and counted.
"""

import contextlib
import queue
import struct
import threading
from dataclasses import dataclass, field
from enum import IntEnum
from pathlib import Path
from typing import BinaryIO

MAGIC = b"RECONCAP1\n"
RECORD_HEADER = struct.Struct(">QBI")

WAITING_RECORDS = 2048
"""Of at most one read each: 64 MiB that wait for the disk."""

MOST_FILES = 4096
"""An app that connects again and again must not fill a folder."""


class Direction(IntEnum):
    """Which way bytes went."""

    FROM_APP = 0
    TO_APP = 1


@dataclass(slots=True)
class Capture:
    """Writes capture files into one folder, named after the link and the start of the run."""

    folder: Path
    run_name: str
    limit_bytes: int
    dropped_bytes: int = 0
    _taken_bytes: int = 0
    _link_ids: set[int] = field(default_factory=set)
    _records: "queue.Queue[tuple[int, bytes | None] | None]" = field(
        default_factory=lambda: queue.Queue(WAITING_RECORDS)
    )
    _thread: threading.Thread | None = None

    def start(self) -> None:
        """Create the folder and begin; raises OSError when the folder cannot be written."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self._path(0).touch()
        self._path(0).unlink()
        self._thread = threading.Thread(target=self._write, name="capture", daemon=True)
        self._thread.start()

    def record(self, link_id: int, direction: Direction, data: bytes, at_ns: int) -> None:
        """Queue bytes for writing; never waits."""
        record = RECORD_HEADER.pack(at_ns, direction, len(data)) + data
        is_new = link_id not in self._link_ids
        size_bytes = len(record) + (len(MAGIC) if is_new else 0)
        is_over = self._taken_bytes + size_bytes > self.limit_bytes
        if is_over or (is_new and len(self._link_ids) >= MOST_FILES) or self._records.full():
            self.dropped_bytes += len(data)
            return
        self._link_ids.add(link_id)
        self._taken_bytes += size_bytes
        self._records.put_nowait((link_id, record))

    def end_link(self, link_id: int) -> None:
        """Close the file of a connection that is gone, once all before it is written."""
        # Beyond the queue's limit the file stays open until the end; nothing is lost by that.
        if link_id in self._link_ids:
            with contextlib.suppress(queue.Full):
                self._records.put_nowait((link_id, None))

    def close(self) -> None:
        """Write what is queued and close the files."""
        if self._thread is not None:
            self._records.put(None)
            self._thread.join()
            self._thread = None

    def _path(self, link_id: int) -> Path:
        return self.folder / f"{self.run_name}-link-{link_id:04d}.reconcap"

    def _write(self) -> None:
        files: dict[int, BinaryIO] = {}
        while (item := self._records.get()) is not None:
            link_id, record = item
            if record is None:
                _close(files.pop(link_id, None))
                continue
            try:
                if link_id not in files:
                    files[link_id] = self._open(link_id)
                files[link_id].write(record)
                if self._records.empty():
                    # So that the file can be read while the station runs.
                    files[link_id].flush()
            except OSError:
                self.dropped_bytes += len(record)
        for file in files.values():
            _close(file)

    def _open(self, link_id: int) -> BinaryIO:
        file = self._path(link_id).open("ab")
        if file.tell() == 0:
            file.write(MAGIC)
        return file


def _close(file: BinaryIO | None) -> None:
    """Close a file; a full disk shows here at the latest, and ends nothing but this file."""
    if file is not None:
        with contextlib.suppress(OSError):
            file.close()
