"""One direction of a damaged link: bytes go in, and come out later, in order, and changed.

No socket and no clock: times are arguments that never fall. Memory is bounded by whoever reads
only while there is room.
"""

from collections import deque
from math import isfinite
from random import Random

from recon.model.units import NS_PER_S, seconds_to_ns
from recon.sim.proxy.damage import Damage, Flips, Stalls

MOST_HELD_BYTES = 4 * 1024 * 1024
"""Under way in one direction: two and a half raw frames. Beyond it reading waits, and so TCP makes
the sender wait. One read more may come on top."""
PIECE_BYTES = 1_400
"""A slow link passes segments of this size on, one after the other."""


class Channel:
    """What is under way in one direction of one connection."""

    def __init__(self, damage: Damage, seed: str, start_ns: int) -> None:
        self._damage = damage
        self._jitter = Random(f"{seed}/jitter")
        self._flips = Flips(damage, Random(f"{seed}/flips"))
        self._stalls = Stalls(damage, Random(f"{seed}/stalls"), start_ns)
        self._line_free_ns = start_ns
        self._last_due_ns = start_ns
        self._under_way: deque[tuple[int, bytes]] = deque()
        self._held_bytes = 0

    @property
    def has_room(self) -> bool:
        """Whether more may be read."""
        return self._held_bytes < MOST_HELD_BYTES

    @property
    def next_due_ns(self) -> int | None:
        """When the next bytes come out, None while none are under way."""
        return self._under_way[0][0] if self._under_way else None

    def push(self, data: bytes, now_ns: int) -> None:
        """Take what was read."""
        late_s = self._damage.delay_s + self._jitter.uniform(0.0, self._damage.jitter_s)
        for piece in self._pieces(self._flips.through(data)):
            sent_ns = self._sent_ns(len(piece), now_ns)
            due_ns = max(self._last_due_ns, sent_ns + seconds_to_ns(late_s))
            self._last_due_ns = int(self._stalls.passes_ns(due_ns))
            self._under_way.append((self._last_due_ns, piece))
            self._held_bytes += len(piece)

    def pop_due(self, now_ns: int) -> list[bytes]:
        """Return what has come through by now, each piece as it is to be written."""
        pieces = []
        while self._under_way and self._under_way[0][0] <= now_ns:
            pieces.append(self._under_way.popleft()[1])
            self._held_bytes -= len(pieces[-1])
        return pieces

    def _pieces(self, data: bytes) -> list[bytes]:
        # A fast link keeps reads whole: there are apps that take a read for a packet.
        if not isfinite(self._damage.rate_bytes_per_s):
            return [data]
        return [data[i : i + PIECE_BYTES] for i in range(0, len(data), PIECE_BYTES)]

    def _sent_ns(self, size: int, now_ns: int) -> int:
        """Return when the last of so many bytes has gone down the line, after those before."""
        if not isfinite(self._damage.rate_bytes_per_s):
            return now_ns
        on_line_ns = round(size / self._damage.rate_bytes_per_s * NS_PER_S)
        self._line_free_ns = max(self._line_free_ns, now_ns) + on_line_ns
        return self._line_free_ns
