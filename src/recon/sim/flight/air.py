"""The wind at one aircraft, and how it displaces the aircraft.

The flight controller compensates the wind it has estimated, and its estimate follows the true wind
within seconds. The rest is unknown to it and pushes the aircraft off its velocity, which it then
corrects. So a steady wind displaces nothing that holds position; it costs airspeed, and thereby
time and battery.
"""

from dataclasses import dataclass, field
from math import cos, hypot, pi, radians, sin

from recon.model.units import NS_PER_S
from recon.sim.flight.kinematics import DRAG_PER_S, AircraftMotion
from recon.sim.world.wind import Wind

Velocity = tuple[float, float, float]
"""North, east, up components of the air's motion, in m/s."""
STILL: Velocity = (0.0, 0.0, 0.0)

LOOK_NS = 250_000_000
"""Interval between evaluations of the wind: its shortest gusts last about a second."""
LEARNS_WITHIN_S = 1.5
"""Time constant of the flight controller's wind estimate."""
COMES_BACK_WITHIN_S = 1.0
"""Time constant with which the controller takes out a velocity error."""
GROUND_EFFECT_M = 10.0
"""Height below which vertical gusts fade linearly to zero at the ground."""
WARNS_OF_S = 10.0
"""Averaging time of the wind speed that warnings are based on."""
WARNING_MPS = (5.0, 8.0)
"""Speeds above which the aircraft reports wind and strong wind (half and most of its limit). Low
values, so that the station's energy model errs on the safe side."""


@dataclass(frozen=True, slots=True)
class Squall:
    """Periodic gusts on top of the wind, from one direction: the fault `gusts`."""

    heading_deg: float
    peak_mps: float = 9.0
    period_s: float = 8.0

    def at(self, elapsed_s: float) -> Velocity:
        """Return the velocity it adds: sine squared, from 0 to the peak and back each period."""
        speed_mps = self.peak_mps * sin(pi * elapsed_s / self.period_s) ** 2
        heading = radians(self.heading_deg)
        return speed_mps * cos(heading), speed_mps * sin(heading), 0.0


@dataclass(slots=True)
class Air:
    """The wind at one aircraft: `felt` is the wind now, `push` the velocity error it causes."""

    wind: Wind | None = None
    home_north_m: float = 0.0
    home_east_m: float = 0.0
    """The aircraft's home in the frame of the wind."""
    start_ns: int = 0
    """Time 0 of the wind."""
    felt: Velocity = STILL
    push: Velocity = STILL
    _squall: tuple[int, Squall] | None = None
    _steady_mps: float = 0.0
    _known: Velocity = STILL
    _looked_ns: int | None = field(default=None)
    _mean: Velocity = STILL

    @property
    def horizontal(self) -> tuple[float, float]:
        """North and east components of the wind now."""
        return self.felt[0], self.felt[1]

    @property
    def warning_level(self) -> int:
        """0 none, 1 wind, 2 strong wind, as in extended telemetry."""
        return sum(self._steady_mps > limit for limit in WARNING_MPS)

    def begin_squall(self, squall: Squall, now_ns: int) -> None:
        """Start gusts."""
        self._squall = (now_ns, squall)

    def end_squall(self) -> None:
        """End the gusts."""
        self._squall = None

    def step(self, motion: AircraftMotion, now_ns: int, seconds: float) -> None:
        """Advance by `seconds`: wind at the aircraft, estimate, and velocity error."""
        # Fast path for calm air: nearly all tests and many flights.
        if self.wind is None and self._squall is None and self.push == self._known == STILL:
            self.felt = STILL
            return
        # At the first step the estimate is already settled: the aircraft has been hovering here.
        is_first = self._looked_ns is None
        self._look(motion, now_ns)
        if is_first:
            self._known, self._steady_mps = self.felt, hypot(*self.horizontal)
        # Vertical gusts cannot pass through the ground.
        low = min(1.0, max(0.0, motion.height_m) / GROUND_EFFECT_M)
        self.push = (
            self._pushed(0, seconds, 1.0),
            self._pushed(1, seconds, 1.0),
            self._pushed(2, seconds, low),
        )
        learnt = seconds / LEARNS_WITHIN_S
        # Explicit Euler is stable here: the tick of 50 ms is far below both time constants.
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
