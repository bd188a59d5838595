"""Damage to one direction of a link: settings, stalls, changed bytes, and the channel.

Each effect has its own random generator, so that the length of a stall does not change which byte
is flipped next. Times are arguments that never decrease; memory is bounded if the caller reads
only while there is room.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from math import floor, inf, isfinite, log1p
from random import Random

from recon.model.units import NS_PER_S, seconds_to_ns
from recon.sim.errors import SimulationError

BYTES_PER_MB = 1_000_000
S_PER_MIN = 60.0
NEVER = 1e12
"""Bytes or seconds: more than any connection lasts. Stands for infinity in draws."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Damage:
    """How bad a link is; the defaults are a perfect one. Raises `SimulationError` out of range."""

    delay_s: float = 0.0
    jitter_s: float = 0.0
    """Extra delay of each read, uniform from 0 to this; order is kept, as TCP does."""
    rate_bytes_per_s: float = inf
    stalls_per_min: float = 0.0
    stall_s: float = 2.0
    """Duration of a stall; then everything held back passes at once."""
    resets_per_min: float = 0.0
    """A reset ends the connection on both sides with RST, not FIN."""
    corrupted_per_mb: float = 0.0
    """Bytes changed per million."""

    def __post_init__(self) -> None:
        _expect("delay", self.delay_s, 0.0, 60.0, "seconds")
        _expect("jitter", self.jitter_s, 0.0, 60.0, "seconds")
        _expect("rate", self.rate_bytes_per_s, 10.0, inf, "bytes per second")
        _expect("stalls", self.stalls_per_min, 0.0, 600.0, "per minute")
        _expect("stall", self.stall_s, 0.0, 600.0, "seconds")
        _expect("resets", self.resets_per_min, 0.0, 600.0, "per minute")
        _expect("corruption", self.corrupted_per_mb, 0.0, BYTES_PER_MB, "bytes per million")

    def reset_after_s(self, random: Random) -> float:
        """Draw the time until a connection is reset; infinity without resets."""
        return _drawn_s(self.resets_per_min, random)


class Stalls:
    """The intervals in which nothing passes; query in order of time."""

    def __init__(self, damage: Damage, random: Random, start_ns: int) -> None:
        self._intervals = _intervals(damage, random, start_ns)
        self._begin_ns, self._end_ns = next(self._intervals)

    def passes_ns(self, wanted_ns: float) -> float:
        """Return when bytes due at `wanted_ns` pass; times must not decrease."""
        while wanted_ns >= self._end_ns:
            self._begin_ns, self._end_ns = next(self._intervals)
        return self._end_ns if wanted_ns >= self._begin_ns else wanted_ns


class Flips:
    """Changes random bytes of a stream."""

    def __init__(self, damage: Damage, random: Random) -> None:
        self._share = damage.corrupted_per_mb / BYTES_PER_MB
        self._random = random
        self._untouched = self._gap()

    def through(self, data: bytes) -> bytes:
        """Return the next bytes of the stream, some changed; the length is kept."""
        if self._untouched >= len(data):
            self._untouched -= len(data)
            return data
        changed = bytearray(data)
        while self._untouched < len(data):
            at = int(self._untouched)
            # XOR with 1 to 255: the byte always changes.
            changed[at] ^= self._random.randint(1, 255)
            self._untouched = at + 1 + self._gap()
        self._untouched -= len(data)
        return bytes(changed)

    def _gap(self) -> float:
        """Draw how many bytes stay unchanged before the next change (geometric distribution)."""
        if self._share <= 0.0:
            return inf
        if self._share >= 1.0:
            return 0.0
        gap = log1p(-self._random.random()) / log1p(-self._share)
        return float(floor(gap)) if gap < NEVER else inf


def _intervals(damage: Damage, random: Random, start_ns: int) -> Iterator[tuple[float, float]]:
    """Yield start and end of each stall in order; at last one at infinity."""
    at_ns: float = start_ns
    while damage.stall_s > 0.0 and (sound_s := _drawn_s(damage.stalls_per_min, random)) < NEVER:
        at_ns += seconds_to_ns(sound_s)
        end_ns = at_ns + seconds_to_ns(damage.stall_s)
        yield at_ns, end_ns
        at_ns = end_ns
    yield inf, inf


def _drawn_s(per_min: float, random: Random) -> float:
    rate_hz = per_min / S_PER_MIN
    return random.expovariate(rate_hz) if rate_hz > 1.0 / NEVER else inf


def _expect(what: str, value: float, lowest: float, highest: float, unit: str) -> None:
    if not lowest <= value <= highest:
        raise SimulationError(f"{what}: expected {lowest:g} to {highest:g} {unit}, got {value:g}")


MOST_HELD_BYTES = 4 * 1024 * 1024
"""Most bytes in transit in one direction: two and a half raw frames. Beyond it the caller stops
reading, and TCP flow control stops the sender. One more read may come on top."""
PIECE_BYTES = 1_400
"""A rate-limited link passes segments of this size, about one Ethernet frame, one by one."""


class Channel:
    """One direction of a connection: bytes go in, and come out later, in order, and damaged."""

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
        """Return when the next piece comes out, None when empty."""
        return self._under_way[0][0] if self._under_way else None

    def push(self, data: bytes, now_ns: int) -> None:
        """Add bytes read."""
        late_s = self._damage.delay_s + self._jitter.uniform(0.0, self._damage.jitter_s)
        for piece in self._pieces(self._flips.through(data)):
            sent_ns = self._sent_ns(len(piece), now_ns)
            # Jitter must not reorder bytes: no piece is due before the one in front of it.
            due_ns = max(self._last_due_ns, sent_ns + seconds_to_ns(late_s))
            self._last_due_ns = int(self._stalls.passes_ns(due_ns))
            self._under_way.append((self._last_due_ns, piece))
            self._held_bytes += len(piece)

    def pop_due(self, now_ns: int) -> list[bytes]:
        """Return the pieces due by now, each to be written separately."""
        pieces = []
        while self._under_way and self._under_way[0][0] <= now_ns:
            pieces.append(self._under_way.popleft()[1])
            self._held_bytes -= len(pieces[-1])
        return pieces

    def _pieces(self, data: bytes) -> list[bytes]:
        # Without a rate limit reads stay whole: some apps take a read for a packet.
        if not isfinite(self._damage.rate_bytes_per_s):
            return [data]
        return [data[i : i + PIECE_BYTES] for i in range(0, len(data), PIECE_BYTES)]

    def _sent_ns(self, size: int, now_ns: int) -> int:
        """Return when the last of `size` bytes has left a rate-limited line, after those before."""
        if not isfinite(self._damage.rate_bytes_per_s):
            return now_ns
        on_line_ns = round(size / self._damage.rate_bytes_per_s * NS_PER_S)
        self._line_free_ns = max(self._line_free_ns, now_ns) + on_line_ns
        return self._line_free_ns
