"""Writing the record of a run: items are queued at once, and encoded and written by a thread.

Theory of operation. `put` only appends to a queue, so nothing on the event loop, an order least of
all, waits for a disk. The thread encodes each item and writes a chunk twice a second: a process
that is killed, or a power cut, costs what came in the last half second and one write.

    open --folder or disk fails--> failing --written again--> open
    open --little space left--> without images --space again--> open

While writing fails, items wait and the write is tried again every second. Memory is bounded by two
limits. Beyond half of `WAITING_BYTES` jobs are recorded without the digest of their input, beyond
all of it the bytes of links and the pixels of frames are dropped as they come, and beyond
`WAITING_ITEMS` whole steps: their numbers are missing in the file, and a replay ends there. With
less than `IMAGES_STOP_BYTES` left on the disk, frames and the bytes of the links that bring them
are left out; telemetry, orders and audit are written to the last byte. What is dropped, and what
cannot be written, is a `problem`, which becomes an alarm.

A start finishes the files of runs that were killed, on the same thread, before it begins its own.
"""

import contextlib
import os
import queue
import shutil
import threading
import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Protocol

from recon.model.errors import RecordError, describe_fault
from recon.model.units import NS_PER_S
from recon.record.file_lock import lock_file
from recon.record.mcap_file import McapFile
from recon.record.mcap_repair import repair

FLUSH_EVERY_S = 0.5
RETRY_AFTER_S = 1.0
CLOSE_WITHIN_S = 5.0
"""A disk that hangs must not keep a stopped station from ending."""

WAITING_BYTES = 256 * 1024 * 1024
"""Ten seconds of two raw frames a second, with their links' bytes and the inputs of their jobs."""
WAITING_ITEMS = 20_000
"""A minute or two of the busiest traffic."""

IMAGES_STOP_BYTES = 2 * 1024**3
"""Telemetry, orders and audit of a day need a tenth of it; the computer needs some as well."""
IMAGES_AGAIN_BYTES = 3 * 1024**3

MOST_TOPICS = 4096
"""An app that reports a new serial again and again must not fill memory with channels."""
OTHER_TOPIC = "/other"


class Topics:
    """Messages by topic into one file; a topic's channel is made with its first message."""

    def __init__(self, file: McapFile) -> None:
        """Take a file just created."""
        self.file = file
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._counts: dict[int, int] = {}

    def add(
        self,
        topic: str,
        encoding: str,
        data: bytes,
        at_ns: int,
        *,
        number: int | None = None,
        schema: Callable[[], tuple[str, bytes]] | None = None,
    ) -> None:
        """Add a message; without a `number` of its own it gets the next one of its topic."""
        channel = self._channels.get(topic)
        if channel is None:
            if len(self._channels) >= MOST_TOPICS:
                topic = f"{OTHER_TOPIC}/{encoding}"
            channel = self._channels[topic] = self._channel(topic, encoding, schema)
        if number is None:
            number = self._counts[channel] = self._counts.get(channel, 0) + 1
        self.file.add_message(channel, number, at_ns, data)

    def _channel(
        self, topic: str, encoding: str, schema: Callable[[], tuple[str, bytes]] | None
    ) -> int:
        if schema is None:
            return self.file.add_channel(topic, encoding)
        name, data = schema()
        if name not in self._schemas:
            self._schemas[name] = self.file.add_schema(name, encoding, data)
        return self.file.add_channel(topic, encoding, self._schemas[name])


class Translator(Protocol):
    """Makes messages of items; called by the writer's thread alone."""

    def begin(self, topics: Topics) -> None:
        """Write what stands at the beginning of a file."""

    def write(self, item: Any, topics: Topics, *, with_images: bool) -> None:
        """Write one item."""


class RecordWriter:
    """Writes one run's record into a folder. `put` belongs to one thread and never waits."""

    def __init__(
        self,
        folder: Path,
        translator: Translator,
        library: str,
        free_bytes: Callable[[Path], int] = lambda folder: shutil.disk_usage(folder).free,
    ) -> None:
        """Take the folder; nothing is opened before `start`."""
        self.folder = folder
        self.path: Path | None = None
        """This run's file, once there is one."""
        self.dropped_bytes = self.dropped_steps = 0
        self.cpu_s = 0.0
        """Processor time of the thread, as of its last chunk."""
        self.repaired: list[Path] = []
        """Files of earlier runs that were finished at the start."""
        self._library = library
        self._translator = translator
        self._free_bytes = free_bytes
        self._waiting: queue.SimpleQueue[tuple[Any, int] | None] = queue.SimpleQueue()
        self._put_bytes = self._taken_bytes = 0
        self._topics: Topics | None = None
        self._failure: str | None = None
        self._faults: str | None = None
        self._has_images = True
        self._is_ending = False
        self._thread = threading.Thread(target=self._run, name="record", daemon=True)

    @property
    def problem(self) -> str | None:
        """What is not recorded, and why; None while everything is."""
        if self._failure is not None:
            return self._failure
        if not self._has_images:
            return (
                f"less than {IMAGES_STOP_BYTES // 1024**3} GiB are free in {self.folder}: "
                "the record goes on without images"
            )
        if self.dropped_steps or self.dropped_bytes:
            what = "steps" if self.dropped_steps else "bytes of links and images"
            return f"the disk of {self.folder} was too slow: the record lacks {what}"
        return self._faults

    @property
    def has_room(self) -> bool:
        """Whether bytes of links and pixels are taken now."""
        return self._waiting_bytes < WAITING_BYTES

    @property
    def has_time(self) -> bool:
        """Whether what costs the thread time is taken now."""
        return self._waiting_bytes < WAITING_BYTES // 2

    @property
    def _waiting_bytes(self) -> int:
        return self._put_bytes - self._taken_bytes

    def start(self) -> None:
        """Start the thread; a folder that cannot be written is a `problem`."""
        self._thread.start()

    def put(self, item: Any, size_bytes: int) -> bool:
        """Queue an item of about this size; return whether there was room for it."""
        if self._waiting.qsize() >= WAITING_ITEMS:
            return False
        self._put_bytes += size_bytes
        self._waiting.put((item, size_bytes))
        return True

    def close(self, within_s: float = CLOSE_WITHIN_S) -> None:
        """Write what is queued and finish the file, as far as the disk takes it in time."""
        if self._thread.is_alive():
            self._is_ending = True
            self._waiting.put(None)
            self._thread.join(within_s)

    def _run(self) -> None:
        while not self._try(self._open):
            # Items wait in the queue, which is bounded, until there is a file.
            if self._is_ending:
                return
            time.sleep(RETRY_AFTER_S)
        assert self._topics is not None
        file, is_over = self._topics.file, False
        self._guarded(lambda topics: self._translator.begin(topics))
        while not is_over:
            is_over = self._take_until(time.monotonic() + FLUSH_EVERY_S)
            self._look_at_disk()
            self.cpu_s = time.thread_time()
            while not self._try(file.flush) and not self._is_ending:
                time.sleep(RETRY_AFTER_S)
        self._try(file.finish)

    def _take_until(self, at_s: float) -> bool:
        """Take items until a time, or until the chunk is full; return whether that was all."""
        assert self._topics is not None
        while not self._topics.file.is_chunk_full:
            try:
                waiting = self._waiting.get(timeout=max(0.0, at_s - time.monotonic()))
            except queue.Empty:
                return False
            if waiting is None:
                return True
            self._take(*waiting)
        return False

    def _take(self, item: Any, size_bytes: int) -> None:
        self._taken_bytes += size_bytes
        self._guarded(
            lambda topics: self._translator.write(item, topics, with_images=self._has_images)
        )

    def _guarded(self, write: Callable[[Topics], None]) -> None:
        """One item that cannot be encoded must not end the record of all others."""
        assert self._topics is not None
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

    def _try(self, act: Callable[[], None]) -> bool:
        try:
            act()
        except (OSError, RecordError) as problem:
            reason = problem.strerror if isinstance(problem, OSError) else str(problem)
            self._failure = f"the record cannot be written to {self.folder}: {reason}"
            return False
        self._failure = None
        return True

    def _open(self) -> None:
        self.folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        self.repaired += repair_all(self.folder)
        file = McapFile(_free_name(self.folder), self._library)
        lock_file(file.descriptor)
        self.path, self._topics = file.path, Topics(file)


def repair_all(folder: Path) -> list[Path]:
    """Finish the files that killed runs have left in a folder; one being written is locked."""
    repaired = []
    for path in sorted(folder.glob("*.mcap")):
        with contextlib.suppress(OSError, RecordError):
            descriptor = os.open(path, os.O_RDWR)
            try:
                lock_file(descriptor)
                if repair(path) is not None:
                    repaired.append(path)
            finally:
                os.close(descriptor)
    return repaired


def _free_name(folder: Path) -> Path:
    stamp = datetime.fromtimestamp(time.time_ns() // NS_PER_S, UTC).strftime("%Y%m%dT%H%M%SZ")
    names = (f"recon-{stamp}{tail}.mcap" for tail in ("", *(f"-{n}" for n in range(2, 1000))))
    return next(folder / name for name in names if not (folder / name).exists())
