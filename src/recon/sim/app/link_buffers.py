"""Buffers of one connection: bytes received and not yet read, packets waiting to be sent."""

from dataclasses import dataclass, field
from heapq import heappop, heappush

READ_EVERY_NS = 100_000_000
SLOW_BYTES = 32
"""A slow reader reads so much each time: ten sticks a second are more than it keeps up with."""
MOST_UNREAD_BYTES = 4_096
"""Beyond, the socket is not read any more, and TCP makes the station wait."""
MOST_KEPT_BYTES = 1_048_576
"""Where nobody can make the station wait (no socket), what is beyond this is lost."""


@dataclass(slots=True)
class AppInbox:
    """Bytes of a link in their order, read at once or a few at a time."""

    _unread: bytearray = field(default_factory=bytearray)
    next_read_ns: int | None = None

    @property
    def has_room(self) -> bool:
        """Whether more should be read from the socket."""
        return len(self._unread) < MOST_UNREAD_BYTES

    def keep(self, data: bytes, now_ns: int) -> None:
        """Take what came, to be read later."""
        self._unread += data[: MOST_KEPT_BYTES - len(self._unread)]
        if self.next_read_ns is None:
            self.next_read_ns = now_ns + READ_EVERY_NS

    def read(self, slowly: bool) -> bytes:
        """Return what is read now, all of it or a little."""
        size = SLOW_BYTES if slowly else len(self._unread)
        data = bytes(self._unread[:size])
        del self._unread[:size]
        at_ns = self.next_read_ns
        self.next_read_ns = at_ns + READ_EVERY_NS if self._unread and at_ns is not None else None
        return data


MOST_PACKETS_WAITING = 256
"""Per link; then the one that is due first is dropped: nobody reads."""


@dataclass(slots=True)
class AppOutbox:
    """Packets in the order of their times, and of their writing where times are equal."""

    _waiting: list[tuple[int, int, bytes]] = field(default_factory=list)
    _count: int = 0

    def add(self, packet: bytes, due_ns: int) -> None:
        """Send a packet at a time."""
        heappush(self._waiting, (due_ns, self._count, packet))
        self._count += 1
        if len(self._waiting) > MOST_PACKETS_WAITING:
            heappop(self._waiting)

    def pop_due(self, now_ns: int) -> list[bytes]:
        """Return the packets whose time has come."""
        packets = []
        while self._waiting and self._waiting[0][0] <= now_ns:
            packets.append(heappop(self._waiting)[2])
        return packets

    def next_after_ns(self, now_ns: int) -> int | None:
        """Return when the next packet is due that is held back, None without one."""
        if not self._waiting or self._waiting[0][0] > now_ns:
            return self._waiting[0][0] if self._waiting else None
        return min((due_ns for due_ns, _, _ in self._waiting if due_ns > now_ns), default=None)
