"""A vehicle of known motion, steered over a path that delays: the truth against the steering.

The airframe is the simulator's: it follows a demanded velocity with 2.5 m/s2 and a demanded height
within its climb rates. Telemetry is taken at 10 Hz and comes late, in bursts; sticks take effect
late. Wind pushes the vehicle past its own velocity control. Time goes in steps of 10 ms.
"""

from collections import deque
from dataclasses import dataclass, field
from itertools import pairwise
from math import hypot
from random import Random

from recon.geo.distance import moved_m, offset_north_east_m
from recon.guidance.steering import (
    Goal,
    KinematicState,
    Steered,
    SteeringSettings,
    begin,
    halted,
    has_arrived,
    steer,
)
from recon.model.geo import LatLon
from recon.sim.flight.kinematics import (
    AircraftMotion,
    Limits,
    VelocityDemand,
    hold_height_mps,
    step,
)

START = LatLon(41.9, -93.6)
STEP_NS = 10_000_000
SETTINGS = SteeringSettings()


@dataclass(frozen=True)
class Way:
    """What lies between the vehicle and the steering."""

    telemetry_s: float = 0.2
    jitter_s: float = 0.0
    """Telemetry waits up to this long more, and then comes in a burst."""
    stick_s: float = 0.15
    wind_north_mps: float = 0.0
    wind_east_mps: float = 0.0
    gust_mps: float = 0.0
    noise_m: float = 0.0
    seed: int = 0


@dataclass
class Loop:
    """The closed loop; `trace` is the true motion every 0.1 s, `demands` what was asked for."""

    path: Way
    motion: AircraftMotion = field(default_factory=lambda: AircraftMotion(height_m=30.0))
    now_ns: int = 0
    trace: list[AircraftMotion] = field(default_factory=list)
    demands: list[Steered] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.rng = Random(self.path.seed)
        self.limits = Limits()
        self.reports: deque[tuple[int, AircraftMotion]] = deque()
        self.sticks: deque[tuple[int, Steered]] = deque()
        self.flown: Steered | None = None
        self.last: tuple[int, AircraftMotion] | None = None
        self.gust = [0.0, 0.0]
        self.steered: Steered | None = None

    @property
    def place(self) -> tuple[float, float]:
        """True north and east of the start, in metres."""
        return self.motion.north_m, self.motion.east_m

    def seen(self) -> KinematicState | None:
        if self.last is None:
            return None
        received_ns, motion = self.last
        sigma = self.path.noise_m
        return KinematicState(
            moved_m(
                START,
                motion.north_m + self.rng.gauss(0.0, sigma),
                motion.east_m + self.rng.gauss(0.0, sigma),
            ),
            motion.velocity_north_mps,
            motion.velocity_east_mps,
            motion.height_m + self.rng.gauss(0.0, sigma),
            motion.yaw_deg,
            (self.now_ns - received_ns) / 1e9,
        )

    def fly(self, goal: Goal, seconds: float, *, is_blind: bool = False) -> None:
        """Steer towards a goal for a time; blind, no telemetry comes and zero is sent."""
        for _ in range(round(seconds * 100)):
            self.now_ns += STEP_NS
            if self.now_ns % 100_000_000 == 0:
                self._report(is_blind)
                self._steer(goal, is_blind)
                self.trace.append(self.motion)
            self._arrive()
            self._move()

    def distance_m(self, goal: Goal) -> float:
        north_m, east_m = offset_north_east_m(START, goal.target)
        return hypot(north_m - self.motion.north_m, east_m - self.motion.east_m)

    def has_arrived(self, goal: Goal) -> bool:
        seen = self.seen()
        return seen is not None and has_arrived(goal, seen, SETTINGS)

    def overshoot_m(self, goal: Goal) -> float:
        """How far beyond the goal, along the line from the start, it ever was."""
        north_m, east_m = offset_north_east_m(START, goal.target)
        length_m = hypot(north_m, east_m)
        along = ((m.north_m * north_m + m.east_m * east_m) / length_m for m in self.trace)
        return max(along) - length_m

    def hardest_demand_mps2(self) -> float:
        """The largest change of the demanded velocity, zeros of a stop excluded."""
        return max(
            hypot(
                b.velocity_north_mps - a.velocity_north_mps,
                b.velocity_east_mps - a.velocity_east_mps,
            )
            / ((b.at_ns - a.at_ns) / 1e9)
            for a, b in pairwise(self.demands)
        )

    def _report(self, is_blind: bool) -> None:
        if not is_blind:
            late_s = self.path.telemetry_s + self.path.jitter_s * self.rng.random()
            due_ns = self.now_ns + round(late_s * 1e9)
            if self.reports:
                due_ns = max(due_ns, self.reports[-1][0])
            self.reports.append((due_ns, self.motion))

    def _steer(self, goal: Goal, is_blind: bool) -> None:
        seen = self.seen()
        if seen is None:
            return
        if self.steered is None:
            self.steered = begin(seen, self.now_ns)
        if is_blind:
            self.steered = halted(self.steered, None, self.now_ns)
        else:
            self.steered = steer(self.steered, goal, seen, self.now_ns, SETTINGS)
        self.demands.append(self.steered)
        self.sticks.append((self.now_ns + round(self.path.stick_s * 1e9), self.steered))

    def _arrive(self) -> None:
        while self.reports and self.reports[0][0] <= self.now_ns:
            self.last = self.reports.popleft()
        while self.sticks and self.sticks[0][0] <= self.now_ns:
            self.flown = self.sticks.popleft()[1]

    def _move(self) -> None:
        path, seconds = self.path, STEP_NS / 1e9
        # A gust comes and goes within seconds (first-order, 2 s).
        self.gust = [0.995 * gust + 0.1 * self.rng.gauss(0.0, path.gust_mps) for gust in self.gust]
        if self.flown is None:
            return
        demand = VelocityDemand(
            self.flown.velocity_north_mps + path.wind_north_mps + self.gust[0],
            self.flown.velocity_east_mps + path.wind_east_mps + self.gust[1],
            hold_height_mps(self.motion.height_m, self.flown.height_above_takeoff_m, self.limits),
            self.flown.yaw_deg,
        )
        self.motion = step(self.motion, demand, seconds, self.limits)
