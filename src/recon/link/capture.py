"""A bounded raw capture of every link's bytes with times: the way to debug a real phone.

One file a link: the line RECONCAP1, then records of time (u64, ns), direction (u8: 0 from the app,
1 to it), length (u32) and the bytes, big-endian. `recon inspect` reads it. Writing happens on a
thread of its own; what it cannot keep up with, or what passes the limit, is dropped and counted.
"""

import queue
import struct
import threading
from dataclasses import dataclass, field
from enum import IntEnum
from pathlib import Path
from typing import BinaryIO

MAGIC = b"RECONCAP1\n"
RECORD_HEADER = struct.Struct(">QBI")
WAITING_RECORDS = 4096


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
    _records: "queue.Queue[tuple[int, bytes] | None]" = field(
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
        if self._taken_bytes + len(data) > self.limit_bytes:
            self.dropped_bytes += len(data)
            return
        header = RECORD_HEADER.pack(at_ns, direction, len(data))
        try:
            self._records.put_nowait((link_id, header + data))
            self._taken_bytes += len(data)
        except queue.Full:
            self.dropped_bytes += len(data)

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
            try:
                if link_id not in files:
                    files[link_id] = self._path(link_id).open("wb")
                    files[link_id].write(MAGIC)
                files[link_id].write(record)
            except OSError:
                self.dropped_bytes += len(record)
        for file in files.values():
            file.close()
