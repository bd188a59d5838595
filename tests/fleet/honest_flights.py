"""Drawn flights over a slope, with the truth beside each packet: physics, noise, gaps, bursts."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from math import cos, exp, hypot, pi, sin, sqrt
from random import Random

from tests.fleet.reports import PLACE, extended

from recon.geo.distance import moved_m
from recon.model.report import CoreReport, ExtendedReport, Report
from recon.model.vehicle import Attitude, FlightMode, VelocityNed

STEP_S = 0.1
GPS, TAKEOFF = FlightMode.GPS_ATTI, FlightMode.AUTO_TAKEOFF
MISSION, LANDING = FlightMode.GPS_WAYPOINT, FlightMode.AUTO_LANDING


@dataclass(frozen=True, slots=True)
class Sample:
    """A packet as it arrives, and the truth when it was made."""

    at_s: float
    report: Report
    is_flying: bool
    above_ground_m: float


@dataclass
class Wander:
    """First-order Gauss-Markov noise."""

    random: Random
    sigma: float
    value: float = 0.0

    def step(self) -> float:
        keep = exp(-STEP_S / 30.0)
        self.value = keep * self.value + sqrt(1 - keep * keep) * self.random.gauss(0, self.sigma)
        return self.value


@dataclass
class DrawnFlight:
    """One aircraft over the slope `up = east_slope * east + north_slope * north`."""

    seed: int
    samples: list[Sample] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.random = Random(self.seed)
        self.slopes = self.random.uniform(-0.2, 0.2), self.random.uniform(-0.2, 0.2)
        self.noise = [Wander(self.random, sigma) for sigma in (0.7, 0.7, 0.5)]
        self.now_s = 0.0
        self.place = [0.0, 0.0, 0.0]
        self.velocity = [0.0, 0.0, 0.0]
        self.is_flying = False
        self.mode = GPS
        self.battery = 0.95
        self.extended_every = self.random.choice((5, 10))
        for _ in range(self.random.choice((1, 1, 2))):
            self.fly()
        self.rest(self.random.uniform(3.0, 6.0))

    def fly(self) -> None:
        random = self.random
        self.rest(random.uniform(3.0, 6.0))
        self.mode = TAKEOFF
        zero_m = self.place[2]
        while self.place[2] < zero_m + 1.2:
            self.step((0.0, 0.0, 1.2))
        self.mode = random.choice((MISSION, GPS, FlightMode.JOYSTICK))
        for _ in range(round(random.uniform(5.0, 20.0) / STEP_S)):
            self.step((0.0, 0.0, 4.0))
        for _ in range(random.randint(1, 5)):
            self.leg()
        self.mode = LANDING
        while self.above_ground_m > 0.0:
            is_still = hypot(*self.velocity[:2]) < 0.5
            sink = 3.0 if self.above_ground_m > 6.0 else 0.8
            self.step((0.0, 0.0, -sink if is_still else 0.0))
        self.velocity = [0.0, 0.0, 0.0]
        self.is_flying = False
        self.mode = random.choice((GPS, LANDING))
        self.rest(random.uniform(0.5, 1.0))
        self.mode = GPS

    def leg(self) -> None:
        speed, course = self.random.choice((0.0, 3.0, 8.0, 15.0)), self.random.uniform(0, 2 * pi)
        up = self.random.uniform(-3.0, 3.0)
        for _ in range(round(self.random.uniform(3.0, 15.0) / STEP_S)):
            climb = 4.0 if self.above_ground_m < 12.0 else up
            self.step((speed * cos(course), speed * sin(course), climb))

    def rest(self, seconds: float) -> None:
        for _ in range(round(seconds / STEP_S)):
            self.step((0.0, 0.0, 0.0))

    @property
    def above_ground_m(self) -> float:
        north_m, east_m, up_m = self.place
        return up_m - self.slopes[0] * north_m - self.slopes[1] * east_m

    def step(self, demand: tuple[float, float, float]) -> None:
        """A tenth of a second towards these velocities (north, east, up), at 3 m/s2."""
        self.now_s += STEP_S
        for axis, wanted in enumerate(demand):
            change = max(-0.3, min(0.3, wanted - self.velocity[axis]))
            self.velocity[axis] += change
            self.place[axis] += STEP_S * self.velocity[axis]
        if self.velocity[2] > 0.0:
            self.is_flying = True
        if self.is_flying:
            self.battery -= STEP_S / 1500.0
        self.put()

    def put(self) -> None:
        north_m, east_m, height_m = (
            value + noise.step() for value, noise in zip(self.place, self.noise, strict=True)
        )
        jitter = [round(v + self.random.gauss(0.0, 0.05), 1) for v in self.velocity]
        core = CoreReport(
            is_flying=self.is_flying,
            position=moved_m(PLACE, north_m, east_m),
            reported_altitude_m=260.0 + height_m,
            height_above_takeoff_m=height_m,
            velocity_ned=VelocityNed(jitter[0], jitter[1], -jitter[2]),
            attitude=Attitude(self.random.gauss(0.0, 0.1), 0.0, 0.0),
        )
        if round(self.now_s / STEP_S) % self.extended_every == 0:
            self.keep(extended(mode=self.mode, battery=round(self.battery, 2)))
        self.keep(core)

    def keep(self, report: Report) -> None:
        self.samples.append(Sample(self.now_s, report, self.is_flying, self.above_ground_m))

    def with_gaps(self) -> list[Sample]:
        """The packets that arrive: gaps in flight, and bursts of a second and a half."""
        random = Random(self.seed + 1)
        gaps = [
            (start, start + random.uniform(1.0, 8.0))
            for start in (random.uniform(0.0, self.now_s) for _ in range(random.randint(0, 3)))
        ]
        is_bursting = random.random() < 0.3
        kept: list[Sample] = []
        for one in self.samples:
            is_high = one.above_ground_m > 30.0
            if is_high and any(start <= one.at_s < end for start, end in gaps):
                continue
            late_s = 1.5 - one.at_s % 1.5 if is_bursting else 0.0
            kept.append(replace(one, at_s=one.at_s + late_s))
        return kept


def with_faults(samples: list[Sample], seed: int) -> Iterator[Sample]:
    """Yield the packets with drawn faults: false flags, jumps, frozen values, dropouts."""
    random = Random(seed)
    end_s = samples[-1].at_s
    windows = [
        (random.choice(FAULTS), start, start + random.choice((0.3, 3.0, 10.0, 60.0)))
        for start in (random.uniform(0.0, end_s) for _ in range(random.randint(1, 4)))
    ]
    jump = random.uniform(-2_000.0, 2_000.0), random.uniform(-40.0, 40.0)
    frozen: dict[type[Report], Report] = {}
    for one in samples:
        active = {kind for kind, start, end in windows if start <= one.at_s < end}
        if "dropout" in active:
            continue
        report = one.report
        if isinstance(report, CoreReport):
            if "ground" in active:
                report = replace(report, is_flying=False)
            if "unknown" in active:
                report = replace(report, is_flying=None)
            if "jump" in active and report.position and report.height_above_takeoff_m is not None:
                report = replace(
                    report,
                    position=moved_m(report.position, jump[0], 0.0),
                    height_above_takeoff_m=report.height_above_takeoff_m + jump[1],
                )
        elif isinstance(report, ExtendedReport) and "mode" in active:
            report = replace(report, flight_mode=None)
        if "frozen" in active:
            report = frozen.setdefault(type(report), report)
            if isinstance(report, CoreReport) and "ground" in active:
                report = replace(report, is_flying=False)
        else:
            frozen.clear()
        yield replace(one, report=report)


FAULTS = ("ground", "ground", "ground", "unknown", "jump", "frozen", "dropout", "mode")
