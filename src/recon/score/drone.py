"""A survey drone that flies by events: missions, the way home, fresh batteries, what goes wrong."""

from dataclasses import dataclass, field, replace
from enum import Enum
from math import hypot, inf

import numpy as np

from recon.guidance.survey import Seen, Surveyor
from recon.model.units import seconds_to_ns
from recon.score.flight import Hop, climb, fly, land
from recon.score.scenario import Fleet, Place
from recon.score.settings import FlightSettings


class Doing(Enum):
    """What a drone does."""

    STANDING = "standing"
    MISSION = "mission"
    HOVERING = "hovering"
    RETURNING = "returning"
    HELD = "held"
    """By its pilot, or by a fault."""


@dataclass(slots=True)
class Drone:
    """One drone; all times are seconds since the run's start."""

    serial: str
    pad_m: Place
    fleet: Fleet
    height_m: float
    speed_mps: float
    wind_mps: float
    settings: FlightSettings
    place_m: Place = (0.0, 0.0)
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

    def __post_init__(self) -> None:
        self.place_m = self.pad_m

    @property
    def is_airborne(self) -> bool:
        """Whether it is off the ground; standing still counts as on it."""
        return self.doing is not Doing.STANDING

    @property
    def level_load(self) -> float:
        """What level flight takes of the battery, in hovering, wind from the side counted."""
        air_mps = hypot(self.speed_mps, self.wind_mps)
        return 1.0 + self.settings.fast_load * min(1.0, air_mps / 15.0)

    def take(self, number: int, corners_m: tuple[Place, ...], now_s: float) -> None:
        """Begin a mission, from the ground or from where it is in the air."""
        place_m = self.stop(now_s)
        hops: list[Hop] = []
        if not self.is_airborne:
            climb_s = self.height_m / self.settings.climb_mps + self.settings.vertical_s
            hops.append(climb(now_s, climb_s, place_m, self.settings.climb_load))
        start_s = hops[-1].end_s if hops else now_s
        way = [place_m, *corners_m]
        hops += fly(start_s, way, self.speed_mps, self.level_load, self.settings, rows_from=1)
        self._begin(Doing.MISSION, hops, hops[-1].end_s)
        self.number = number

    def go_home(self, now_s: float) -> None:
        """Fly home, land, and stand until the battery is changed."""
        place_m = self.stop(now_s)
        settings = self.settings
        hops = fly(now_s, [place_m, self.pad_m], settings.home_mps, self.level_load, settings)
        down_s = self.height_m / settings.descent_mps + settings.landing_s
        hops.append(land(hops[-1].end_s, down_s, self.pad_m))
        self._begin(Doing.RETURNING, hops, hops[-1].end_s)

    def hold(self, now_s: float, until_s: float) -> None:
        """Stop what it does and hover, not to be had until then; on the ground it stands."""
        self.held_until_s = max(self.held_until_s, until_s)
        if not self.is_airborne:
            self.free_at_s = max(self.free_at_s, until_s)
            return
        self.stop(now_s)
        self._begin(Doing.HELD, [], until_s)

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
            return
        ended_s = self.free_at_s
        if self.doing is Doing.MISSION:
            self._end_mission()
            self.place_m = self.hops[-1].end_m
            self._begin(Doing.HOVERING, [], inf)
        elif self.doing is Doing.HELD:
            self._begin(Doing.HOVERING, [], inf)
        elif self.doing is Doing.RETURNING:
            self._settle(ended_s)
            self.low_landings += self.charge < self.fleet.reserve_share
            self.charge, self.charged_at_s = 1.0, ended_s + self.fleet.swap_s
            self.place_m, self.doing = self.pad_m, Doing.STANDING
            self.free_at_s = max(ended_s + self.fleet.swap_s, self.held_until_s)

    def stop(self, now_s: float) -> Place:
        """Cut short what it flies, and return where it is; a mission under way has ended."""
        self._settle(now_s)
        self.place_m = self.place_at(now_s)
        if self.doing is Doing.MISSION:
            self._end_mission()
        self.hops = [_cut(hop, now_s) for hop in self.hops if hop.start_s < now_s]
        self.told = min(self.told, len(self.hops))
        return self.place_m

    def place_at(self, now_s: float) -> Place:
        """Return where it is now."""
        for hop in reversed(self.hops):
            if hop.start_s <= now_s:
                east_m, north_m = hop.places_m(np.array([now_s]))[0].tolist()
                return east_m, north_m
        return self.place_m

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
        place_m = self.place_at(now_s)
        way_m = hypot(place_m[0] - self.pad_m[0], place_m[1] - self.pad_m[1])
        needed_s = way_m / self.settings.home_mps + self.height_m / self.settings.descent_mps
        needed_s += self.settings.landing_s
        return self.time_left_s(now_s) < self.settings.home_slack * needed_s

    def surveyor(self, now_s: float) -> Surveyor:
        """Return what the planner is told of it."""
        able = self.doing in (Doing.MISSION, Doing.HOVERING)
        able |= self.doing is Doing.STANDING and self.free_at_s <= now_s
        return Surveyor(
            self.serial,
            self.place_at(now_s),
            able and not self._is_unheard(now_s),
            self.ended_mission,
            max(self.time_left_s(now_s), 0.0),
            self.pad_m,
        )

    def seen(self, now_s: float) -> list[Seen]:
        """Return the positions since the last time, oldest first; on rows alone."""
        found: list[Seen] = []
        for hop in self.hops[self.told :]:
            if hop.start_s > now_s:
                break
            if hop.is_row:
                found += self._on(hop, now_s)
            self.told += hop.end_s <= now_s
        return found

    def _on(self, hop: Hop, now_s: float) -> list[Seen]:
        """The positions on a hop that were not told yet."""
        times_s = hop.samples_s(self.settings.sample_s)
        times_s = times_s[(times_s > self.told_s) & (times_s <= now_s)]
        if times_s.size == 0:
            return []
        self.told_s = float(times_s[-1])
        places = hop.places_m(times_s).tolist()
        return [
            Seen(seconds_to_ns(at_s), east_m, north_m, self.height_m)
            for at_s, (east_m, north_m) in zip(times_s.tolist(), places, strict=True)
            if not self._is_unheard(at_s)
        ]

    def _is_unheard(self, at_s: float) -> bool:
        return any(from_s <= at_s < until_s for from_s, until_s in self.unheard_s)

    def _begin(self, doing: Doing, hops: list[Hop], until_s: float) -> None:
        self.doing, self.free_at_s = doing, until_s
        self.hops += hops

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
        for hop in reversed(self.hops):
            if hop.end_s <= since_s:
                break
            lasted_s = min(hop.end_s, now_s) - max(hop.start_s, since_s)
            used_s += max(lasted_s, 0.0) * (hop.load - 1.0)
        return self.charge - used_s / self.fleet.endurance_s


def _cut(hop: Hop, now_s: float) -> Hop:
    """A hop as far as it was flown by now."""
    return hop if hop.end_s <= now_s else replace(hop, end_s=now_s)
