"""What one link still has to send, each packet with the time it goes out."""

from dataclasses import dataclass, field
from heapq import heappop, heappush

MOST_PACKETS_WAITING = 256
"""Per link; then the one that is due first is dropped: nobody reads."""


@dataclass(slots=True)
class Outbox:
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
