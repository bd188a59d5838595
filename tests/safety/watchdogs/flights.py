"""Vehicles flown at 100 Hz under the watchdogs, and how they hold.

Nothing here is taken from the prediction: motion is integrated in small steps from accelerations.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from math import hypot
from random import Random

from tests.safety.traffic import AIR, S, aircraft, route

from recon.model.control import AuthorityHolder, Commanded, Intent
from recon.model.vehicle import FlightMode
from recon.safety import PreparedAirspace
from recon.safety.settings import SafetySettings
from recon.safety.watchdogs import (
    WATCHDOGS,
    CommandedHold,
    Finding,
    Watchdog,
    WatchedVehicle,
    build_traffic_picture,
)
from recon.safety.watchdogs.separation import separation

STEP_S = 0.01
BRAKING_MPS2 = 2.5
SETTINGS = SafetySettings()

Vector = tuple[float, float, float]


@dataclass(slots=True)
class Aircraft:
    """Flies straight until held; place and velocity are north, east, up."""

    serial: str
    place: Vector
    velocity: Vector
    intent: Intent = field(default_factory=Intent)
    mode: FlightMode = FlightMode.GPS_ATTI
    priority: int = 0
    holder: AuthorityHolder = AuthorityHolder.OPERATOR
    delay_s: float = 1.0
    """From the order to hold to the first deceleration."""
    noise_m: float = 0.0
    holds_at_s: float | None = None
    held_at_s: float | None = None

    def moves(self, now_s: float) -> None:
        if self.holds_at_s is not None and now_s >= self.holds_at_s:
            speed = hypot(*self.velocity)
            left = max(0.0, speed - BRAKING_MPS2 * STEP_S)
            share = 0.0 if speed == 0.0 else left / speed
            self.velocity = tuple(share * v for v in self.velocity)  # type: ignore[assignment]
        self.place = tuple(  # type: ignore[assignment]
            at + STEP_S * v for at, v in zip(self.place, self.velocity, strict=True)
        )

    def is_ordered_to_hold(self, now_s: float) -> None:
        self.held_at_s = now_s
        if self.holds_at_s is None:
            self.holds_at_s = now_s + self.delay_s

    def watched(self, now_s: float, rng: Random) -> WatchedVehicle:
        """What telemetry of the last tenth of a second tells."""
        north_m, east_m, up_m = self.place
        noisy = (north_m + rng.gauss(0.0, self.noise_m), east_m + rng.gauss(0.0, self.noise_m))
        now_ns = round(now_s * S)
        state = aircraft(
            self.serial,
            noisy,
            up_m,
            self.velocity,
            mode=self.mode,
            priority=self.priority,
            now_ns=now_ns,
        )
        intent, held = self.intent, None
        if self.held_at_s is not None:
            speed = hypot(*self.velocity[:2])
            held = CommandedHold(round(self.held_at_s * S), speed)
        return WatchedVehicle(state, intent, self.holder, held=held)


@dataclass(slots=True)
class Air:
    """Aircraft and the watchdogs over them, looked at ten times a second."""

    fleet: list[Aircraft]
    rng: Random
    watchdogs: tuple[Watchdog, ...] = (separation,)
    airspace: PreparedAirspace = AIR
    is_hold_on: bool = True
    acts: bool = True
    now_s: float = 100.0
    steps: int = 0
    since_ns: dict[str, int] = field(default_factory=dict)
    found: list[tuple[float, Finding]] = field(default_factory=list)
    holds: list[tuple[float, str]] = field(default_factory=list)

    def runs(self, seconds: float, each: Callable[[], None] = lambda: None) -> "Air":
        for _ in range(round(seconds / STEP_S)):
            if self.steps % 10 == 0:
                self.looks()
            for one in self.fleet:
                one.moves(self.now_s)
            self.steps += 1
            self.now_s = 100.0 + self.steps * STEP_S
            each()
        return self

    def looks(self) -> list[Finding]:
        now_ns = round(self.now_s * S)
        picture = build_traffic_picture(
            [one.watched(self.now_s, self.rng) for one in self.fleet],
            self.airspace,
            SETTINGS,
            now_ns,
            self.since_ns,
            is_hold_on=self.is_hold_on,
        )
        findings = [finding for watchdog in self.watchdogs for finding in watchdog(picture)]
        self.since_ns = {f.key: self.since_ns.get(f.key, now_ns) for f in findings}
        self.found += [(self.now_s, finding) for finding in findings]
        for finding in findings if self.acts else ():
            if finding.holds is not None:
                self.one(finding.holds).is_ordered_to_hold(self.now_s)
                self.holds.append((self.now_s, finding.holds))
        return findings

    def one(self, serial: str) -> Aircraft:
        return next(one for one in self.fleet if one.serial == serial)


def closeness(one: Aircraft, other: Aircraft) -> float:
    """How near two are, in shares of 15 m and 6 m: under 1 both are violated."""
    offset = [a - b for a, b in zip(one.place, other.place, strict=True)]
    return max(hypot(offset[0], offset[1]) / 15.0, abs(offset[2]) / 6.0)


def straight_mission(place: Vector, velocity: Vector, seconds: float = 200.0) -> Intent:
    """A mission of one leg along a velocity."""
    north, east, up = (at + seconds * v for at, v in zip(place, velocity, strict=True))
    mission = route(place, (north, east, up))
    speed = max(0.5, hypot(velocity[0], velocity[1]))
    first, last = (
        type(w)(w.latitude_deg, w.longitude_deg, w.height_above_takeoff_m, speed)
        for w in mission.waypoints
    )
    return Intent(Commanded.MISSION, mission=type(mission)((first, last)), passed=1)


def all_findings(fleet: Iterable[Aircraft], **changes: object) -> list[Finding]:
    """What all watchdogs say to one look at a fleet."""
    air = Air(list(fleet), Random(1), watchdogs=WATCHDOGS, **changes)  # type: ignore[arg-type]
    return air.looks()
