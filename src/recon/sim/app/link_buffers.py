"""Buffers of one connection: bytes received and not yet read, packets waiting to be sent."""

from dataclasses import dataclass, field
from heapq import heappop, heappush

READ_EVERY_NS = 100_000_000
SLOW_BYTES = 32
"""Read per period by a slow reader: less than ten stick commands per second need."""
MOST_UNREAD_BYTES = 4_096
"""Limit of unread bytes: beyond it the socket is not read, so that TCP stops the station."""
MOST_KEPT_BYTES = 1_048_576
"""Limit without a socket, which has no flow control: bytes beyond this are lost."""


@dataclass(slots=True)
class AppInbox:
    """Received bytes of a link in order, read all at once or a few at a time."""

    _unread: bytearray = field(default_factory=bytearray)
    next_read_ns: int | None = None

    @property
    def has_room(self) -> bool:
        """Whether to read more from the socket."""
        return len(self._unread) < MOST_UNREAD_BYTES

    def keep(self, data: bytes, now_ns: int) -> None:
        """Add received bytes, to be read later."""
        self._unread += data[: MOST_KEPT_BYTES - len(self._unread)]
        if self.next_read_ns is None:
            self.next_read_ns = now_ns + READ_EVERY_NS

    def read(self, slowly: bool) -> bytes:
        """Return the bytes read now: all of them, or `SLOW_BYTES`."""
        size = SLOW_BYTES if slowly else len(self._unread)
        data = bytes(self._unread[:size])
        del self._unread[:size]
        at_ns = self.next_read_ns
        self.next_read_ns = at_ns + READ_EVERY_NS if self._unread and at_ns is not None else None
        return data


MOST_PACKETS_WAITING = 256
"""Limit per link: beyond it the packet due first is dropped, as the peer does not read."""


@dataclass(slots=True)
class AppOutbox:
    """Packets waiting to be sent, ordered by due time, then by the order they were added."""

    _waiting: list[tuple[int, int, bytes]] = field(default_factory=list)
    _count: int = 0

    def add(self, packet: bytes, due_ns: int) -> None:
        """Queue a packet for a time."""
        heappush(self._waiting, (due_ns, self._count, packet))
        self._count += 1
        if len(self._waiting) > MOST_PACKETS_WAITING:
            heappop(self._waiting)

    def pop_due(self, now_ns: int) -> list[bytes]:
        """Return the packets due by now."""
        packets = []
        while self._waiting and self._waiting[0][0] <= now_ns:
            packets.append(heappop(self._waiting)[2])
        return packets

    def next_after_ns(self, now_ns: int) -> int | None:
        """Return when the next packet after `now_ns` is due, None without one."""
        if not self._waiting or self._waiting[0][0] > now_ns:
            return self._waiting[0][0] if self._waiting else None
        return min((due_ns for due_ns, _, _ in self._waiting if due_ns > now_ns), default=None)
