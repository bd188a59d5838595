"""The air an aircraft flies in, and how it is pushed about by it.

The flight controller leans against the wind it knows, and learns of a change within seconds. What
it does not know yet pushes: the aircraft gives way and comes back. A steady wind therefore moves
nothing that is held; it costs airspeed, and so time and battery.
"""

from dataclasses import dataclass, field
from math import cos, hypot, pi, radians, sin

from recon.model.units import NS_PER_S
from recon.sim.flight.kinematics import DRAG_PER_S, AircraftMotion
from recon.sim.world.wind import Wind

Velocity = tuple[float, float, float]
"""North, east, up, where the air goes, in m/s."""
STILL: Velocity = (0.0, 0.0, 0.0)

LOOK_NS = 250_000_000
"""The wind is looked up so often: its smallest gusts last a second."""
LEARNS_WITHIN_S = 1.5
"""The flight controller's estimate of the wind follows it with this lag."""
COMES_BACK_WITHIN_S = 1.0
GROUND_EFFECT_M = 10.0
"""Towards the ground there is less and less room for gusts up or down."""
WARNS_OF_S = 10.0
"""The wind that is warned of is a mean of about so long."""
WARNING_MPS = (5.0, 8.0)
"""Above these the aircraft warns of wind, and of strong wind (half and most of what it can fly in):
low enough that the station's energy model is on the careful side."""


@dataclass(frozen=True, slots=True)
class Squall:
    """Gusts on top of the wind, one after the other, from one direction: the fault `gusts`."""

    heading_deg: float
    peak_mps: float = 9.0
    period_s: float = 8.0

    def at(self, elapsed_s: float) -> Velocity:
        """Return what it adds so long after its begin: nothing at first, the peak half-way."""
        speed_mps = self.peak_mps * sin(pi * elapsed_s / self.period_s) ** 2
        heading = radians(self.heading_deg)
        return speed_mps * cos(heading), speed_mps * sin(heading), 0.0


@dataclass(slots=True)
class Air:
    """The wind at one aircraft: `felt` now, and `push` by which it is off what it was asked for."""

    wind: Wind | None = None
    home_north_m: float = 0.0
    home_east_m: float = 0.0
    """Where the aircraft's own metres begin, in the frame of the wind."""
    start_ns: int = 0
    """When the wind's own time begins."""
    felt: Velocity = STILL
    push: Velocity = STILL
    _squall: tuple[int, Squall] | None = None
    _steady_mps: float = 0.0
    _known: Velocity = STILL
    _looked_ns: int | None = field(default=None)
    _mean: Velocity = STILL

    @property
    def horizontal(self) -> tuple[float, float]:
        """The felt wind north and east."""
        return self.felt[0], self.felt[1]

    @property
    def warning_level(self) -> int:
        """0 none, 1 wind, 2 strong wind: what telemetry tells."""
        return sum(self._steady_mps > limit for limit in WARNING_MPS)

    def begin_squall(self, squall: Squall, now_ns: int) -> None:
        """Add gusts from now on."""
        self._squall = (now_ns, squall)

    def end_squall(self) -> None:
        """Take the added gusts away."""
        self._squall = None

    def step(self, motion: AircraftMotion, now_ns: int, seconds: float) -> None:
        """Feel the wind where the aircraft is, and give way to what is new in it."""
        if self.wind is None and self._squall is None and self.push == self._known == STILL:
            self.felt = STILL
            return
        is_first = self._looked_ns is None
        self._look(motion, now_ns)
        if is_first:
            self._known, self._steady_mps = self.felt, hypot(*self.horizontal)
        low = min(1.0, max(0.0, motion.height_m) / GROUND_EFFECT_M)
        self.push = (
            self._pushed(0, seconds, 1.0),
            self._pushed(1, seconds, 1.0),
            self._pushed(2, seconds, low),
        )
        learnt = seconds / LEARNS_WITHIN_S
        known, felt = self._known, self.felt
        self._known = (
            known[0] + learnt * (felt[0] - known[0]),
            known[1] + learnt * (felt[1] - known[1]),
            known[2] + learnt * (felt[2] - known[2]),
        )
        self._steady_mps += seconds / WARNS_OF_S * (hypot(*self.horizontal) - self._steady_mps)

    def _pushed(self, axis: int, seconds: float, share: float) -> float:
        unknown_mps = share * (self.felt[axis] - self._known[axis])
        pushed_mps = self.push[axis]
        return pushed_mps + seconds * (DRAG_PER_S * unknown_mps - pushed_mps / COMES_BACK_WITHIN_S)

    def _look(self, motion: AircraftMotion, now_ns: int) -> None:
        if self._looked_ns is None or now_ns >= self._looked_ns + LOOK_NS:
            self._looked_ns = now_ns
            self._mean = self._world(motion, now_ns)
        if self._squall is None:
            self.felt = self._mean
            return
        since_ns, squall = self._squall
        north, east, up = squall.at((now_ns - since_ns) / NS_PER_S)
        self.felt = (self._mean[0] + north, self._mean[1] + east, self._mean[2] + up)

    def _world(self, motion: AircraftMotion, now_ns: int) -> Velocity:
        if self.wind is None:
            return STILL
        east, north, up = self.wind.at(
            self.home_east_m + motion.east_m,
            self.home_north_m + motion.north_m,
            motion.height_m,
            (now_ns - self.start_ns) / NS_PER_S,
        )
        return north, east, up
