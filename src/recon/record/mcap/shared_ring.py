"""A ring of bytes in memory that two processes share: one writes, the other reads.

Writing is a copy: no system call, no lock that the reader could hold, and the interpreter is not
given away, so the writer continues at once. Counter `HEAD` has the bytes that were written so far,
`TAIL` those that were read; each is set by one side only, after its copy, and by one store:
`struct.pack_into` would set it to 0 first, and the other process would read that.
"""

import mmap
import os
import tempfile
import threading
from collections.abc import Iterable

COUNTERS_BYTES = 64
HEAD, TAIL = 0, 1


class SharedRing:
    """One side of a ring; what is put into it comes out as the same stream of bytes."""

    def __init__(self, descriptor: int, size_bytes: int, *, allocates: bool = False) -> None:
        """Map an open file of `COUNTERS_BYTES` and the ring's own size.

        `allocates` has Linux find all its memory now, not at the first copy into each page: a
        tick's 5 MB then take 3 ms instead of 17 ms.
        """
        self.size_bytes = size_bytes
        flags = mmap.MAP_SHARED | (getattr(mmap, "MAP_POPULATE", 0) if allocates else 0)
        self._map = mmap.mmap(descriptor, COUNTERS_BYTES + size_bytes, flags=flags)
        self._counters = memoryview(self._map)[:COUNTERS_BYTES].cast("Q")
        self._data = memoryview(self._map)[COUNTERS_BYTES:]
        self._fence = threading.Lock()

    @property
    def waiting_bytes(self) -> int:
        """What was written and not read."""
        return self._counters[HEAD] - self._counters[TAIL]

    def put(self, parts: Iterable[bytes]) -> None:
        """Write parts behind each other, at once for the reader; the caller knows their room."""
        head = self._counters[HEAD]
        for part in parts:
            at = head % self.size_bytes
            first = min(len(part), self.size_bytes - at)
            self._data[at : at + first] = part[:first] if first < len(part) else part
            if first < len(part):
                self._data[: len(part) - first] = part[first:]
            head += len(part)
        self._set_count(HEAD, head)

    def peek(self, size_bytes: int) -> bytes:
        """Return the next bytes without taking them."""
        at = self._counters[TAIL] % self.size_bytes
        first = min(size_bytes, self.size_bytes - at)
        found = bytes(self._data[at : at + first])
        return found + bytes(self._data[: size_bytes - first]) if first < size_bytes else found

    def take(self, size_bytes: int) -> None:
        """Free the next bytes for the writer."""
        self._set_count(TAIL, self._counters[TAIL] + size_bytes)

    def close(self) -> None:
        """Unmap it."""
        self._counters.release()
        self._data.release()
        self._map.close()

    def _set_count(self, counter: int, count: int) -> None:
        # A lock taken twice orders the copy before the counter on processors that reorder stores.
        for _ in range(2):
            with self._fence:
                pass
        self._counters[counter] = count


def shared_file(size_bytes: int) -> int:
    """Return the descriptor of a file in memory for a ring of this size; it has no name."""
    if hasattr(os, "memfd_create"):
        descriptor = os.memfd_create("recon-record")
    else:
        with tempfile.TemporaryFile() as file:
            descriptor = os.dup(file.fileno())
    os.ftruncate(descriptor, COUNTERS_BYTES + size_bytes)
    return descriptor
