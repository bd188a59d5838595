"""The process that writes the record, and the station's end of it.

    python -m recon.record.mcap.record_process FOLDER LIBRARY DESCRIPTOR RING_BYTES

Theory of operation. `RecordProcess.put` copies into memory that both processes share, so nothing on
the event loop, an order least of all, waits for a disk or gives the interpreter away. Compression
and the disk are all in the process, which runs at a lower priority than the station.

    running --its standard output ends--> dead: what is put is dropped

Memory is bounded by the ring: beyond `BULK_SHARE` of it, bulk (the bytes of images) has no room,
and what does not fit is dropped. What is dropped is counted, and is a `problem`, which becomes an
alarm.

When the station ends, however it ends, the process's standard input does: it writes what is in the
ring and finishes the file. It is in a session of its own, so that Ctrl+C does not reach it.
"""

import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import msgspec

from recon.model.errors import RecordError
from recon.record.mcap.items import HEAD, Item, ItemKind, Status
from recon.record.mcap.shared_ring import SharedRing, shared_file

if TYPE_CHECKING:
    from recon.record.mcap.record_writer import RecordWriter

RING_BYTES = 96 * 1024 * 1024
"""Two seconds of the bench's twenty raw frames a second; a minute of the demonstration's."""
BULK_SHARE = 0.6
CLOSE_WITHIN_S = 5.0
"""A disk that hangs must not keep a stopped station from ending."""
NICENESS = 10
POLL_S = 0.02
IS_SUPPORTED = sys.platform != "win32"
"""Windows hands no open file to another process in this way."""


class RecordProcess:
    """A process that writes the record; it belongs to one thread."""

    def __init__(self, folder: Path, library: str) -> None:
        """Take the folder; nothing happens before `start`."""
        self.folder = folder
        self.status = Status()
        self.dropped_bytes = self.dropped_steps = 0
        self.is_dead = False
        self._library = library
        self._ring: SharedRing | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._reader: threading.Thread | None = None
        self._is_closing = False

    @property
    def path(self) -> Path | None:
        """The file that is being written."""
        return None if self.status.path is None else Path(self.status.path)

    @property
    def pid(self) -> int | None:
        """Return the process's id."""
        return None if self._process is None else self._process.pid

    @property
    def problem(self) -> str | None:
        """What is not recorded, and why; None while everything is."""
        if self.is_dead:
            return f"the process that writes the record to {self.folder} has ended"
        if self.status.problem is not None:
            return self.status.problem
        if self.dropped_steps or self.dropped_bytes:
            what = "steps" if self.dropped_steps else "images"
            return f"the disk of {self.folder} was too slow: the record lacks {what}"
        return None

    @property
    def room_bytes(self) -> int:
        """What is taken now."""
        if self.is_dead or self._ring is None:
            return 0
        return self._ring.size_bytes - self._ring.waiting_bytes

    @property
    def bulk_room_bytes(self) -> int:
        """What is taken of the bytes of images now."""
        return self.room_bytes - int((1.0 - BULK_SHARE) * RING_BYTES)

    def start(self) -> None:
        """Start the process; raises OSError."""
        descriptor = shared_file(RING_BYTES)
        self._ring = SharedRing(descriptor, RING_BYTES)
        command = [sys.executable, "-m", "recon.record.mcap.record_process"]
        arguments = [str(self.folder), self._library, str(descriptor), str(RING_BYTES)]
        self._process = subprocess.Popen(
            [*command, *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            pass_fds=[descriptor],
            start_new_session=True,
        )
        os.close(descriptor)
        self._reader = threading.Thread(target=self._read, name="record-status", daemon=True)
        self._reader.start()

    def put(self, parts: Iterable[bytes]) -> None:
        """Hand items over; never waits. The caller knows that there is room."""
        if self._ring is not None:
            self._ring.put(parts)

    def close(self, within_s: float = CLOSE_WITHIN_S) -> None:
        """Have what was put written and the file finished, as far as the disk takes it in time."""
        process, reader = self._process, self._reader
        if process is None or reader is None or self._is_closing:
            return
        self._is_closing = True
        assert process.stdin is not None
        process.stdin.close()
        with suppress(subprocess.TimeoutExpired):
            process.wait(within_s)
            reader.join(within_s)
        if self._ring is not None:
            self._ring.close()
            self._ring = None

    def _read(self) -> None:
        assert self._process is not None
        assert self._process.stdout is not None
        with self._process.stdout as lines:
            for line in lines:
                with suppress(msgspec.MsgspecError):
                    self.status = msgspec.json.decode(line, type=Status)
        if not self._is_closing:
            self.is_dead = True
        # One that was killed needs the processor to end, which may take a while on a busy computer.
        self._process.wait()


class RingInbox:
    """The items in a ring, for the writer."""

    def __init__(self, ring: SharedRing) -> None:
        self.is_over = False
        """Set when nothing more is put into the ring."""
        self._ring = ring

    def get(self, timeout: float) -> Item | None:
        """Return the next item, None after the last.

        Raises `queue.Empty` after the timeout, `RecordError` for an item that is not whole.
        """
        end_s = time.monotonic() + timeout
        while True:
            is_over = self.is_over  # read before the ring: what is put before the end is read
            waiting_bytes = self._ring.waiting_bytes
            if waiting_bytes:
                break
            if is_over:
                return None
            if time.monotonic() >= end_s:
                raise queue.Empty
            time.sleep(POLL_S)
        kind, size = HEAD.unpack(self._ring.peek(HEAD.size))
        if HEAD.size + size > waiting_bytes:
            raise RecordError(f"expected an item of {HEAD.size + size} bytes, got {waiting_bytes}")
        self._ring.take(HEAD.size)
        content = self._ring.peek(size)
        self._ring.take(size)
        return Item(ItemKind(kind), content)


def _await_end(station: BinaryIO, inbox: RingInbox, writer: "RecordWriter") -> None:
    station.read()
    inbox.is_over = writer.is_ending = True


def main(folder: str, library: str, descriptor: str, ring_bytes: str) -> None:
    """Write what comes until standard input ends; report on standard output."""
    # The station has this module too, and starts without what only this process needs.
    from recon.record.mcap.flight_messages import FlightMessages
    from recon.record.mcap.record_writer import RecordWriter

    _be_nice()
    for ignored in (signal.SIGINT, signal.SIGTERM):
        # It ends after the station, which may still send items.
        signal.signal(ignored, signal.SIG_IGN)
    inbox = RingInbox(SharedRing(int(descriptor), int(ring_bytes), allocates=True))
    writer = RecordWriter(
        Path(folder),
        FlightMessages(),
        inbox,
        library,
        begins=lambda item: item.kind is ItemKind.BEGIN,
        has_flown=lambda item: item.kind is ItemKind.FLOWN,
        report=_print_status,
    )
    ending = threading.Thread(target=_await_end, args=(sys.stdin.buffer, inbox, writer))
    ending.daemon = True
    ending.start()
    writer.run()


def _be_nice() -> None:
    """Leave the processor to the station.

    Linux may share it among sessions first, and this process has a session of its own.
    """
    os.nice(NICENESS)
    with suppress(OSError):
        Path("/proc/self/autogroup").write_text(f"{NICENESS}")


def _print_status(status: Status) -> None:
    with suppress(OSError):
        sys.stdout.buffer.write(msgspec.json.encode(status) + b"\n")
        sys.stdout.buffer.flush()


if __name__ == "__main__":
    main(*sys.argv[1:])
