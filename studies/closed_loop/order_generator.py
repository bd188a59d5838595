"""People and programs that give orders at random: sensible, hasty, and nonsensical ones."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import cos, inf, nan, radians, sin
from random import Random

import numpy as np

from recon.model.airspace import Region
from recon.model.command import (
    Body,
    FlyMission,
    GoTo,
    HoldPosition,
    Hover,
    LandNow,
    Nudge,
    ReturnHome,
    StartCamera,
    StickFrame,
    StopCamera,
    VirtualStick,
)
from recon.model.control import AuthorityHolder
from recon.model.event import (
    AlarmAcknowledged,
    AuthorityTaken,
    Event,
    FleetReturnOrdered,
    OperatorOrder,
    OwnerConnected,
    OwnerDisconnected,
    PreflightOverridden,
    SeparationHoldSwitched,
    SurveyRequested,
    SurveyStarted,
    SurveyStopped,
)
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.survey import Survey
from recon.station.state.station import Station
from studies.closed_loop.scene import Scene, degrees, somewhere

BATTERY_RULES = ("battery", "battery_home")
REACTS_AFTER_S = 6.0
RECKLESS_SHARE = 0.25
"""Of targets and of heights: no person means them, and all of them must be refused."""


@dataclass(slots=True)
class OrderGenerator:
    """Everyone who gives orders in one run; `handle` gives an event to the station."""

    scene: Scene
    rng: Random
    handle: Callable[[Event], None]
    place: Callable[[str], tuple[float, float, float]]
    """A vehicle's place, east, north and up: people see it."""
    is_flying: Callable[[str], bool]
    _next_id: int = 0
    _next_s: float = 6.0
    _overrides: bool = True
    """Checklists are overridden once, at the start: what is drawn seldom passes them."""
    _next_survey: int = 500
    _surveys: list[int] = field(default_factory=list)
    _streams: list[tuple[float, str]] = field(default_factory=list)
    _battery_since_s: dict[str, float] = field(default_factory=dict)

    @property
    def serials(self) -> list[str]:
        """All vehicles."""
        return list(self.scene.homes_m)

    def act(self, station: Station, now_s: float) -> None:
        """Give the orders that are due."""
        self._end_streams(now_s)
        if self._overrides and now_s > 4.0:
            self._overrides = False
            for serial in self.serials:
                self.handle(PreflightOverridden(serial, "operator", "study"))
        if self.scene.settings.reacts_to_battery:
            self._react(station, now_s)
        if now_s < self._next_s:
            return
        self._next_s = now_s + self.rng.expovariate(1.0 / self.scene.settings.operator_pace_s)
        self._one_action(station, now_s)

    def order(self, serial: str | None, body: Body, **more: object) -> None:
        """Give one order."""
        self._next_id += 1
        self.handle(OperatorOrder(self._next_id, body, "operator", serial, **more))  # type: ignore[arg-type]

    def all_stop(self, station: Station) -> None:
        """Hold every vehicle, and every link in flight without a serial."""
        for serial in station.fleet.vehicles:
            self.order(serial, Hover())
        for link in station.fleet.unbound_links():
            if link.claimed_serial is None and link.own_state.is_flying.value is True:
                self.order(None, Hover(), link_id=link.id)

    def _one_action(self, station: Station, now_s: float) -> None:
        rng, serial = self.rng, self.rng.choice(self.serials)
        up = [each for each in self.serials if self.is_flying(each)]
        flying = rng.choice(up) if up and rng.random() < 0.85 else serial
        settings = self.scene.settings
        actions: list[tuple[float, Callable[[], None]]] = [
            (34.0, lambda: self._mission(serial)),
            (14.0, lambda: self._goto(flying, now_s)),
            (5.0, lambda: self._nudge(flying, now_s)),
            (3.0, lambda: self._steer(flying, HoldPosition(), now_s)),
            (7.0, lambda: self.order(flying, self._stick(flying))),
            (9.0, lambda: self.order(flying, Hover())),
            (2.0, lambda: self.order(serial, Hover(), takeoff=True)),
            (3.0, lambda: self.order(flying, LandNow())),
            (3.0, lambda: self.order(flying, ReturnHome())),
            (1.5, lambda: self.all_stop(station)),
            (2.0, lambda: self._call_fleet()),
            (4.0, lambda: self._take(serial, AuthorityHolder.OPERATOR)),
            (1.0, lambda: self._take(serial, AuthorityHolder.GUIDANCE)),
            (1.0, lambda: self._take(serial, AuthorityHolder.PILOT)),
            (3.0, lambda: self.handle(PreflightOverridden(serial, "operator", "study"))),
            (2.0, lambda: self.order(serial, rng.choice((StartCamera(1.0), StopCamera())))),
            (3.0, lambda: self._acknowledge(station)),
        ]
        if settings.sends_invalid_orders:
            actions.append((20.0, lambda: self._invalid_order(serial, now_s)))
        if settings.has_survey:
            actions.append((10.0, lambda: self._survey(station)))
        if settings.switches_holds:
            is_on = rng.random() < 0.5
            actions.append((1.0, lambda: self.handle(SeparationHoldSwitched(is_on, "operator"))))
        weights = [weight for weight, _ in actions]
        rng.choices(actions, weights)[0][1]()

    def _mission(self, serial: str) -> None:
        chance = 0.2 if self.is_flying(serial) else 0.92
        self.order(serial, self.drawn_mission(serial), takeoff=self.rng.random() < chance)

    def drawn_mission(self, serial: str) -> FlyMission:
        """Return a mission from above the vehicle to some places; now and then a reckless one."""
        rng, truth, home = self.rng, self.scene.truth, self.scene.homes_m[serial]
        here = self.place(serial)
        over_m = rng.uniform(truth.least_height_m + 6.0, max(30.0, truth.most_height_m - 12.0))
        if rng.random() < RECKLESS_SHARE:
            over_m = self._reckless_height_m(serial)
        speed_mps = rng.uniform(2.0, 14.0)
        points = [here[:2], *(self._target(serial) for _ in range(rng.randint(1, 5)))]
        if rng.random() < 0.3:
            points.append(home[:2])
        is_curved = rng.random() < 0.2
        loiters_s = (None,) if is_curved else (None, None, 2.0)
        waypoints = []
        for number, point in enumerate(points):
            # On a slope each waypoint lies over its own ground.
            ground_m = truth.ground.height_m(*point)
            up_m = ground_m + over_m - home[2] + (0.0 if number else rng.uniform(0.0, 2.0))
            spot = degrees(*point)
            waypoints.append(
                Waypoint(
                    spot.latitude_deg,
                    spot.longitude_deg,
                    up_m,
                    speed_mps,
                    loiter_s=rng.choice(loiters_s),
                )
            )
        return FlyMission(Mission(tuple(waypoints), rng.random() < 0.15, curved=is_curved))

    def _target(self, serial: str) -> tuple[float, float]:
        """Somewhere inside; mostly near the vehicle, so that ways are often allowed."""
        here, truth = self.place(serial), self.scene.truth
        if self.rng.random() < RECKLESS_SHARE:
            return self._reckless_target(serial)
        for _ in range(8):
            target = somewhere(self.rng, truth, 12.0)
            away_m = abs(target[0] - here[0]) + abs(target[1] - here[1])
            if away_m < self.rng.choice((80.0, 150.0, 500.0)):
                return target
        return target

    def _reckless_target(self, serial: str) -> tuple[float, float]:
        """Beyond the boundary, in a zone, or where another vehicle is: the gate must refuse it."""
        rng, truth = self.rng, self.scene.truth
        others = [each for each in self.serials if each != serial]
        corner = rng.choice(truth.boundary_m)
        places = [self.place(rng.choice(others))[:2], (1.1 * corner[0], 1.1 * corner[1])]
        places += [_middle(zone.corners_m) for zone in truth.zones]
        return rng.choice(places)

    def _reckless_height_m(self, serial: str) -> float:
        """Too low, too high, or another vehicle's; above the ground at the origin's height."""
        truth, other = self.scene.truth, self.place(self.rng.choice(self.serials))
        ground_m = truth.ground.height_m(other[0], other[1])
        heights_m = (other[2] - ground_m, 0.5 * truth.least_height_m, truth.most_height_m + 8.0)
        return self.rng.choice(heights_m)

    def _goto(self, serial: str, now_s: float) -> None:
        home, target = self.scene.homes_m[serial], self._target(serial)
        here = self.place(serial)
        ground_m = self.scene.truth.ground.height_m(*target)
        up_m = here[2] + self.rng.uniform(-15.0, 15.0)
        if self.rng.random() < RECKLESS_SHARE:
            up_m = ground_m + self._reckless_height_m(serial)
        else:
            up_m = max(ground_m + self.scene.truth.least_height_m + 4.0, up_m)
        up_m -= home[2]
        self._steer(serial, GoTo(degrees(*target), up_m, self.rng.uniform(1.0, 12.0)), now_s)

    def _nudge(self, serial: str, now_s: float) -> None:
        rng = self.rng
        north, east = rng.uniform(-20.0, 20.0), rng.uniform(-20.0, 20.0)
        self._steer(serial, Nudge(north, east, rng.uniform(-5.0, 5.0), 3.0), now_s)

    def _steer(self, serial: str, body: Body, now_s: float) -> None:
        owner = f"stream {self.rng.randrange(4)}"
        self.handle(OwnerConnected(owner))
        self.order(serial, body, owner=owner)
        self._streams.append((now_s + self.rng.choice((0.2, 3.0, 15.0, 60.0)), owner))

    def _end_streams(self, now_s: float) -> None:
        over = [owner for at_s, owner in self._streams if at_s <= now_s]
        self._streams = [item for item in self._streams if item[0] > now_s]
        for owner in over:
            self.handle(OwnerDisconnected(owner))

    def _stick(self, serial: str) -> VirtualStick:
        rng, home = self.rng, self.scene.homes_m[serial]
        height_m = max(0.0, self.place(serial)[2] - home[2] + rng.choice((0.0, 0.0, -4.0, 4.0)))
        heading, speed = radians(rng.uniform(0.0, 360.0)), rng.choice((0.0, 2.0, 6.0))
        return VirtualStick(
            rng.choice(tuple(StickFrame)),
            rng.uniform(-180.0, 180.0),
            speed * cos(heading),
            speed * sin(heading),
            height_m,
            rng.uniform(0.3, 4.0),
        )

    def _call_fleet(self) -> None:
        count = self.rng.randint(1, len(self.serials))
        called = tuple(self.rng.sample(self.serials, count))
        first = self._next_id + 1
        self._next_id += count
        self.handle(FleetReturnOrdered(first, called, "operator"))

    def _take(self, serial: str, holder: AuthorityHolder) -> None:
        self.handle(AuthorityTaken(serial, holder, "operator"))

    def _acknowledge(self, station: Station) -> None:
        if station.alarms.alarms:
            number = self.rng.choice(sorted(station.alarms.alarms))
            self.handle(AlarmAcknowledged(number, "operator"))

    def _survey(self, station: Station) -> None:
        rng, records = self.rng, station.surveys.records
        if not records or rng.random() < 0.3:
            self._request_survey()
            return
        number = rng.choice(sorted(records))
        if rng.random() < 0.6:
            chosen = tuple(rng.sample(self.serials, rng.randint(1, min(3, len(self.serials)))))
            self.handle(SurveyStarted(number, chosen, "operator", rng.random() < 0.8))
        else:
            self.handle(SurveyStopped(number, "operator", rng.random() < 0.3))

    def _request_survey(self) -> None:
        rng, truth = self.rng, self.scene.truth
        east_m, north_m = somewhere(rng, truth, 25.0)
        wide_m, high_m = rng.uniform(20.0, 80.0), rng.uniform(20.0, 80.0)
        corners = [(0.0, 0.0), (wide_m, 0.0), (wide_m, high_m), (0.0, high_m)]
        region = Region(np.array(corners) + np.array([east_m, north_m]))
        self._next_survey += 1
        height_m = rng.uniform(20.0, max(25.0, truth.most_height_m - 15.0))
        asked = Survey(self._next_survey, "field", region, height_m, rng.uniform(3.0, 8.0))
        self.handle(SurveyRequested(asked, "operator"))

    def _react(self, station: Station, now_s: float) -> None:
        """Call a vehicle home some seconds after its battery alarm."""
        active = {
            alarm.condition.serial
            for alarm in station.alarms.alarms.values()
            if alarm.is_active and alarm.condition.rule in BATTERY_RULES
        }
        for serial in self.serials:
            if serial not in active:
                self._battery_since_s.pop(serial, None)
            elif now_s - self._battery_since_s.setdefault(serial, now_s) >= REACTS_AFTER_S:
                self._battery_since_s[serial] = now_s + 20.0
                self.order(serial, ReturnHome())

    def _invalid_order(self, serial: str, now_s: float) -> None:
        rng = self.rng
        spot = degrees(0.0, 0.0)
        bad = rng.choice((nan, inf, -inf, 1e30, -1.0, 0.0, 1e9, 600.0))
        far = rng.choice((LatLon(bad, 0.0), LatLon(0.0, 0.0), LatLon(91.0, 200.0), spot))
        flat = Waypoint(far.latitude_deg, far.longitude_deg, bad, bad)
        good = Waypoint(spot.latitude_deg, spot.longitude_deg, 40.0, 5.0)
        bodies: tuple[Body, ...] = (
            GoTo(far, bad, bad),
            Nudge(bad, 0.0, bad, bad),
            VirtualStick(StickFrame.GROUND, bad, bad, 0.0, bad, bad),
            VirtualStick(StickFrame.BODY, 0.0, 15.0, 15.0, 40.0, 5.0),
            FlyMission(Mission((flat, good))),
            FlyMission(Mission((good,))),
            FlyMission(Mission((good,) * rng.choice((2, 150)))),
            FlyMission(Mission((good, flat))),
            StartCamera(bad),
            LandNow(),
            ReturnHome(),
        )
        body = rng.choice(bodies)
        role = rng.choice(tuple(AuthorityHolder)) if rng.random() < 0.2 else None
        more: dict[str, object] = {"takeoff": rng.random() < 0.4}
        if role is not None and role is not AuthorityHolder.PILOT:
            more["role"] = role
        if rng.random() < 0.1:
            more["link_id"] = rng.choice((-1, 0, 10**6))
            self.order(None, body, **more)
            return
        target = serial if rng.random() < 0.9 else rng.choice(("", "SIM-99", "00000"))
        if rng.random() < 0.2:
            more["owner"] = "a stream that was never opened"
        self.order(target, body, **more)


def _middle(corners_m: Sequence[tuple[float, float]]) -> tuple[float, float]:
    east, north = zip(*corners_m, strict=True)
    return sum(east) / len(east), sum(north) / len(north)
