"""A survey drone that flies by events: missions, the way home, fresh batteries, what goes wrong."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property
from math import hypot, inf
from operator import attrgetter

import numpy as np

from recon.guidance.survey import PositionSample, Surveyor
from recon.model.units import seconds_to_ns
from recon.score.autopilot import Autopilot, Point
from recon.score.flight import Hop, Spot
from recon.score.scenario import Fleet, Place
from recon.score.settings import FlightSettings
from recon.sim.flight.battery import flying_load
from recon.sim.flight.kinematics import AircraftMotion
from recon.sim.world import Wind

_START_S = attrgetter("start_s")


class Doing(Enum):
    """What a drone does."""

    STANDING = "standing"
    MISSION = "mission"
    HOVERING = "hovering"
    RETURNING = "returning"
    HELD = "held"
    """By its pilot, or by a fault."""
    LOST = "lost"
    """It has fallen, and says nothing any more."""


@dataclass
class Drone:
    """One drone; all times are seconds since the run's start."""

    serial: str
    pad_m: Place
    fleet: Fleet
    speed_mps: float
    go_home_height_m: float
    wind: Wind
    settings: FlightSettings
    spot_m: Spot = (0.0, 0.0, 0.0)
    """Where it is when it flies nothing."""
    doing: Doing = Doing.STANDING
    free_at_s: float = 0.0
    """When what it does ends; infinite for hovering."""
    number: int | None = None
    ended_mission: int = 0
    charge: float = 1.0
    """Of the battery, at `charged_at_s`, when the hops before were used up."""
    charged_at_s: float = 0.0
    hops: list[Hop] = field(default_factory=list)
    """All that was flown and is to be flown, in order."""
    told: int = 0
    """Of the hops, all of whose positions were told."""
    told_s: float = -inf
    """When the newest position was that was told."""
    flown_s: float = 0.0
    low_landings: int = 0
    unheard_s: list[tuple[float, float]] = field(default_factory=list)
    """From when to when nobody hears it."""
    held_until_s: float = 0.0
    ignores_until_s: float = 0.0
    gusty_s: tuple[tuple[float, float], ...] = ()
    """From when to when there are squalls."""
    _given: int = 0
    """The newest mission that it was given."""
    _told_ended: int = 0
    """The newest mission of which it is known that it has ended."""
    _reach_m: float = 0.0
    """No place of all its flights is farther from its pad, or higher."""
    _ceiling_m: float = 0.0

    def __post_init__(self) -> None:
        self.spot_m = (*self.pad_m, 0.0)

    @property
    def is_airborne(self) -> bool:
        """Whether it is off the ground; standing still counts as on it."""
        return self.doing not in (Doing.STANDING, Doing.LOST)

    @cached_property
    def level_load(self) -> float:
        """What level flight takes of the battery, in hovering, wind from the side counted."""
        air_mps = hypot(*self.wind.mean_mps(self.go_home_height_m))
        moving = AircraftMotion(velocity_north_mps=hypot(self.speed_mps, air_mps))
        return flying_load(moving, (0.0, 0.0))

    def take(self, number: int, points: Sequence[Point], rows_from: int, now_s: float) -> None:
        """Begin a mission, from the ground or from where it is in the air; its rows begin at the
        `rows_from`th of its points."""
        self._given = number
        if now_s < self.ignores_until_s:
            self.ended_mission = number
            self.hold(now_s, now_s + self.settings.unheeded_s + self.settings.looked_s)
            return
        autopilot = self._ordered(now_s)
        if not self.is_airborne:
            autopilot.take_off()
        autopilot.fly(points, rows_from)
        self._begin(Doing.MISSION, autopilot.hops, autopilot.now_s)
        self.number = number

    def come_home(self, points: Sequence[Point], now_s: float) -> None:
        """Fly a mission that ends over the pad, land, and stand until the battery is changed."""
        autopilot = self._ordered(now_s)
        autopilot.fly(points)
        autopilot.land()
        self._begin(Doing.RETURNING, autopilot.hops, autopilot.now_s)

    def go_home(self, now_s: float) -> None:
        """As `come_home`, the aircraft's own way: at its go-home height."""
        autopilot = self._ordered(now_s)
        autopilot.go_home(self.pad_m, self.go_home_height_m)
        self._begin(Doing.RETURNING, autopilot.hops, autopilot.now_s)

    def hold(self, now_s: float, until_s: float) -> None:
        """Stop what it does and hover, not to be had until then; on the ground it stands.

        Whoever was stopped is looked at before it is sent on.
        """
        self._hold(now_s, until_s, 0.0)

    def drift(self, now_s: float, until_s: float) -> None:
        """As `hold`, but the wind carries it along."""
        self._hold(now_s, until_s, min(until_s - now_s, self.settings.drifts_s))

    def _hold(self, now_s: float, until_s: float, drifts_s: float) -> None:
        until_s = max(until_s, now_s + self.settings.looked_s)
        self.held_until_s = max(self.held_until_s, until_s)
        if self.doing is Doing.LOST:
            return
        if not self.is_airborne:
            self.free_at_s = max(self.free_at_s, until_s)
            return
        autopilot = Autopilot(now_s, self.stop(now_s), self.wind)
        autopilot.drift(drifts_s)
        self._begin(Doing.HELD, autopilot.hops, until_s)

    def fall(self, now_s: float) -> None:
        """Fall from the sky, or die where it stands; nobody hears of it again."""
        east_m, north_m, _up_m = self.stop(now_s)
        lies_m = (east_m, north_m, 0.0)
        self._begin(Doing.LOST, [Hop(now_s, now_s, lies_m, lies_m, None, 0.0, lands=True)], inf)
        self.spot_m = lies_m

    def ignore_missions(self, until_s: float) -> None:
        """Fly no mission that is given until then; what is flown is flown on."""
        self.ignores_until_s = max(self.ignores_until_s, until_s)

    def lose_word(self, now_s: float, until_s: float) -> None:
        """Fly on, heard by nobody until then."""
        self.unheard_s.append((now_s, until_s))

    def fail_cell(self, now_s: float, left: float) -> None:
        """Lose a cell: so much of the charge is left at most."""
        self._settle(now_s)
        self.charge = min(self.charge, left)

    def advance(self, now_s: float) -> None:
        """Let what has ended by now end."""
        if self.free_at_s > now_s:
            self._settle(now_s)
            return
        ended_s = self.free_at_s
        if self.doing is Doing.MISSION:
            self._end_mission()
            self.spot_m = self.hops[-1].end_m
            self._begin(Doing.HOVERING, [], inf)
        elif self.doing is Doing.HELD:
            self._begin(Doing.HOVERING, [], inf)
        elif self.doing is Doing.RETURNING:
            self._settle(ended_s)
            self.low_landings += self.charge < self.fleet.reserve_share
            self.charge, self.charged_at_s = 1.0, ended_s + self.fleet.swap_s
            self.spot_m, self.doing = (*self.pad_m, 0.0), Doing.STANDING
            self.free_at_s = max(ended_s + self.fleet.swap_s, self.held_until_s)

    def stop(self, now_s: float) -> Spot:
        """Cut short what it flies, and return where it is; a mission under way has ended."""
        self._settle(now_s)
        self.spot_m = self.spot_at(now_s)
        if self.doing is Doing.MISSION:
            self._end_mission()
        self.hops = [_cut(hop, now_s) for hop in self.hops if hop.start_s < now_s]
        self.told = min(self.told, len(self.hops))
        return self.spot_m

    def spot_at(self, now_s: float) -> Spot:
        """Return where it is now."""
        index = bisect_right(self.hops, now_s, key=_START_S)
        if index == 0:
            return self.spot_m
        east_m, north_m, up_m = self.hops[index - 1].places_m(np.array([now_s]))[0].tolist()
        return east_m, north_m, up_m

    def place_at(self, now_s: float) -> Place:
        """Return over which place it is now."""
        return self.spot_at(now_s)[:2]

    def time_left_s(self, now_s: float) -> float:
        """Return how long it can fly level, the reserve taken off."""
        left = self._charge_at(now_s) - self.fleet.reserve_share
        return left * self.fleet.endurance_s / self.level_load

    def must_go_home(self, now_s: float) -> bool:
        """Whether it is in the air and the battery lasts for little more than the way home.

        One that is held is then flown home by its pilot.
        """
        if self.doing not in (Doing.MISSION, Doing.HOVERING, Doing.HELD):
            return False
        left_s = self.time_left_s(now_s)
        if left_s >= self._needed_s((self._reach_m, 0.0, self._ceiling_m)):
            return False
        east_m, north_m, up_m = self.spot_at(now_s)
        return left_s < self._needed_s((east_m - self.pad_m[0], north_m - self.pad_m[1], up_m))

    def _needed_s(self, off_m: Spot) -> float:
        """How long the battery must last for the way home from so far east, north, up of it."""
        settings, height_m = self.settings, max(off_m[2], self.go_home_height_m)
        way_s = hypot(off_m[0], off_m[1]) / settings.home_mps + height_m / settings.descent_mps
        return settings.home_slack * (way_s + settings.landing_s)

    def surveyor(self, now_s: float) -> Surveyor:
        """Return what the planner is told of it; unheard, its mission counts as flown on."""
        is_stale = self._is_unheard(now_s)
        if not is_stale:
            self._told_ended = self.ended_mission
        able = self.doing in (Doing.MISSION, Doing.HOVERING)
        able |= self.doing is Doing.STANDING and self.free_at_s <= now_s
        if is_stale:
            able = self._told_ended < self._given and self.doing is not Doing.LOST
        return Surveyor(
            self.serial,
            self.place_at(now_s),
            able,
            self._told_ended,
            max(self.time_left_s(now_s), 0.0),
            self.pad_m,
        )

    def seen(self, now_s: float) -> list[PositionSample]:
        """Return the positions since the last time, oldest first; on rows alone."""
        found: list[PositionSample] = []
        for hop in self.hops[self.told :]:
            if hop.start_s > now_s:
                break
            if hop.is_row:
                found += self._on(hop, now_s)
            self.told += hop.end_s <= now_s
        return found

    def _on(self, hop: Hop, now_s: float) -> list[PositionSample]:
        """The positions on a hop that were not told yet."""
        times_s = hop.samples_s(self.settings.sample_s)
        times_s = times_s[(times_s > self.told_s) & (times_s <= now_s)]
        if times_s.size == 0:
            return []
        self.told_s = float(times_s[-1])
        places = hop.places_m(times_s).tolist()
        return [
            PositionSample(seconds_to_ns(at_s), east_m, north_m, up_m)
            for at_s, (east_m, north_m, up_m) in zip(times_s.tolist(), places, strict=True)
            if not self._is_unheard(at_s)
        ]

    def _is_unheard(self, at_s: float) -> bool:
        return any(from_s <= at_s < until_s for from_s, until_s in self.unheard_s)

    def _ordered(self, now_s: float) -> Autopilot:
        """What flies on from here, from when the order is there."""
        start_s = now_s + self.settings.acts_after_s
        return Autopilot(start_s, self.stop(now_s), self.wind, self.gusty_s)

    def _begin(self, doing: Doing, hops: list[Hop], until_s: float) -> None:
        self.doing, self.free_at_s = doing, until_s
        self.hops += hops
        for hop in hops:
            east_m, north_m, up_m = hop.end_m
            far_m = hypot(east_m - self.pad_m[0], north_m - self.pad_m[1])
            self._reach_m = max(self._reach_m, far_m)
            self._ceiling_m = max(self._ceiling_m, up_m)

    def _end_mission(self) -> None:
        if self.number is not None:
            self.ended_mission, self.number = self.number, None

    def _settle(self, now_s: float) -> None:
        """Take from the battery what was flown until now, and count the time in the air."""
        self.charge = self._charge_at(now_s)
        if self.is_airborne:
            self.flown_s += max(now_s - self.charged_at_s, 0.0)
        self.charged_at_s = max(self.charged_at_s, now_s)

    def _charge_at(self, now_s: float) -> float:
        if not self.is_airborne or now_s <= self.charged_at_s:
            return self.charge
        since_s, used_s = self.charged_at_s, now_s - self.charged_at_s
        begun = bisect_right(self.hops, now_s, key=_START_S)
        for hop in reversed(self.hops[:begun]):
            if hop.end_s <= since_s:
                break
            lasted_s = min(hop.end_s, now_s) - max(hop.start_s, since_s)
            used_s += max(lasted_s, 0.0) * (hop.load - 1.0)
        return self.charge - used_s / self.fleet.endurance_s


def _cut(hop: Hop, now_s: float) -> Hop:
    """A hop as far as it was flown by now."""
    return hop if hop.end_s <= now_s else replace(hop, end_s=now_s)
