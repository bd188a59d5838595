"""A site with pads, a fleet in the air over its field, and a station that recalls it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import hypot

import numpy as np
from tests.flown_once import flown_once
from tests.ready import ready_airspace, ready_profile, ready_site
from tests.station.station_world import HOME, World

from recon.geo import point_from_enu
from recon.guidance.survey.terrain import ground_up_m
from recon.model.airspace import ElevationModel, FlightLimits, LandingPad, Zone
from recon.model.command import Phase
from recon.model.event import FleetReturnOrdered
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.mission import DJI
from recon.model.vehicle import Failsafe
from recon.safety import PreparedAirspace
from recon.sim.app.faults import parse_fault
from recon.sim.fleet import Airborne, ImagerSetup, SimulationConfig, build_fleet
from recon.sim.flight.flight_modes import Grounded, PositionHold
from recon.station.kernel.build import first_state
from recon.station.kernel.virtual import VirtualDriver
from recon.station.kernel.worker import JobRunner
from recon.station.state.fleet_return_record import ReturningVehicle, Stage

FRAME = LocalFrame(HOME)
NO_IMAGERS: Mapping[str, ImagerSetup] = {}
LEAST_LEVEL_M, LEAST_HEIGHT_M = 15.0, 6.0


@dataclass(slots=True)
class Nearest:
    """The worst pair seen: its level distance where heights were too near, and who."""

    level_m: float = float("inf")
    who: str = ""
    pad_users: int = 0


@dataclass(slots=True)
class ReturningWorld:
    """Runs a world and watches the true distances of all that fly."""

    world: World
    pads_m: dict[str, tuple[float, float]]
    pads_up_m: dict[str, float]
    nearest: Nearest = field(default_factory=Nearest)
    heights_m: dict[str, list[tuple[float, float, float]]] = field(default_factory=dict)
    """Of each vehicle: time, height over the site, distance to its pad."""

    def call(self, *serials: str) -> None:
        first = 1000 + len(self.world.driver.station.orders.records)
        self.world.driver.handle(FleetReturnOrdered(first, serials, "test"))

    def called(self, *serials: str) -> list[tuple[Phase, str]]:
        """Call vehicles one by one; return each order's phase, and its note after any rule."""
        answers = []
        for serial in serials:
            self.call(serial)
            newest = list(self.world.driver.station.orders.records.values())[-1]
            assert newest.command.serial == serial
            refusal = newest.refusal
            rule = "" if refusal is None else f"{refusal.rule}: "
            answers.append((newest.phase, f"{rule}{newest.note}"))
        return answers

    def member(self, serial: str) -> ReturningVehicle:
        running = self.world.driver.station.fleet_return
        assert running is not None
        return running.members[serial]

    def stages(self) -> dict[str, Stage]:
        running = self.world.driver.station.fleet_return
        return {} if running is None else {m.serial: m.stage for m in running.members.values()}

    def place_m(self, serial: str) -> tuple[float, float, float]:
        """Where it truly is, east, north, up of the site."""
        motion, pad = self.world.app(serial).aircraft.motion, self.pads_m[serial]
        up_m = self.pads_up_m[serial] + motion.height_m
        return pad[0] + motion.east_m, pad[1] + motion.north_m, up_m

    def put(self, serial: str, place_m: tuple[float, float, float]) -> None:
        """Have it hover somewhere else, as if its pilot had flown it there meanwhile."""
        aircraft, pad = self.world.app(serial).aircraft, self.pads_m[serial]
        aircraft.motion = aircraft.motion._replace(
            east_m=place_m[0] - pad[0],
            north_m=place_m[1] - pad[1],
            height_m=place_m[2] - self.pads_up_m[serial],
        )
        if isinstance(aircraft.active_mode, PositionHold):
            aircraft.hover()  # at this height

    def flies(self, serial: str) -> bool:
        return self.world.app(serial).aircraft.is_flying

    def runs(self, seconds: float) -> None:
        for _ in range(round(seconds * 10)):
            self.world.run_for(0.1)
            self._watch()

    def runs_until_over(self, at_most_s: float) -> bool:
        for _ in range(round(at_most_s)):
            self.runs(1.0)
            running = self.world.driver.station.fleet_return
            if running is not None and running.is_over:
                return True
        return False

    def alarms(self) -> set[tuple[str, str | None]]:
        book = self.world.driver.station.alarms.alarms.values()
        return {(a.condition.rule, a.condition.serial) for a in book if a.is_active}

    def _watch(self) -> None:
        now_s = self.world.driver.now_ns / 1e9
        flying = [serial for serial in self.pads_m if self.flies(serial)]
        places = {serial: self.place_m(serial) for serial in flying}
        for serial, (east_m, north_m, up_m) in places.items():
            pad = self.pads_m[serial]
            far_m = hypot(east_m - pad[0], north_m - pad[1])
            self.heights_m.setdefault(serial, []).append((now_s, up_m, far_m))
        for one, other in combinations(flying, 2):
            a, b = places[one], places[other]
            level_m = hypot(a[0] - b[0], a[1] - b[1])
            if abs(a[2] - b[2]) < LEAST_HEIGHT_M and level_m < self.nearest.level_m:
                self.nearest.level_m, self.nearest.who = level_m, f"{one} and {other}"


@flown_once
def returning_world(
    places_m: Sequence[tuple[float, float, float]],
    pads_m: Sequence[tuple[float, float]],
    *,
    max_height_m: float = 120.0,
    zones: tuple[Zone, ...] = (),
    faults: tuple[str, ...] = (),
    seed: int = 0,
    go_home_height_m: float | None = None,
    knows_pads: bool = True,
    plans: bool = True,
    plan_takes_s: float = 0.05,
    elevation: ElevationModel | None = None,
    imagers: Mapping[str, ImagerSetup] = NO_IMAGERS,
    takes_missions: bool = True,
    photo_interval_s: float | None = None,
    **profile: object,
) -> ReturningWorld:
    """Return a fleet that hovers at (east, north, height above its pad), each with its pad.

    With an elevation model pads lie on its ground. Pads may be the same place for several vehicles.
    `go_home_height_m` is set in all aircraft. `profile` changes the profile of every vehicle.
    `imagers` are the first of them. With a photo interval their apps report facts and photos.
    """
    others = len(places_m) - len(imagers)
    serials = [*imagers, *(f"SIM-{number}" for number in range(1, others + 1))]
    points = {
        serial: point_from_enu(FRAME, (*pad, 0.0))
        for serial, pad in zip(serials, pads_m, strict=True)
    }
    grounds_m = np.zeros(len(serials)) if elevation is None else ground_up_m(elevation, pads_m)
    pads_up_m = dict(zip(serials, grounds_m.tolist(), strict=True))
    points = {
        s: GeoPoint(p.latitude_deg, p.longitude_deg, HOME.ellipsoid_height_m + pads_up_m[s])
        for s, p in points.items()
    }
    config = SimulationConfig(
        home=HOME,
        vehicle_count=len(serials),
        imagers=imagers,
        airborne=Airborne.ALL,
        takes_missions=takes_missions,
        seed=seed,
        pads=points,
        photo_interval_s=photo_interval_s,
        faults=tuple(parse_fault(text) for text in faults),
    )
    apps = build_fleet(config, 0)
    profiles = [
        ready_profile(
            serial,
            points[serial] if knows_pads else None,
            **{
                "failsafe": Failsafe.HOVER,
                "max_waypoints": DJI.max_waypoints if takes_missions else 0,
                "go_home_height_m": go_home_height_m or app.aircraft.settings.go_home_height_m,
                **profile,
            },
        )
        for serial, app in zip(serials, apps, strict=True)
    ]
    for app, place, pad in zip(apps, places_m, pads_m, strict=True):
        motion = app.aircraft.motion
        app.aircraft.motion = motion._replace(
            east_m=place[0] - pad[0], north_m=place[1] - pad[1], height_m=place[2]
        )
        app.aircraft.active_mode = Grounded() if place[2] == 0.0 else PositionHold()
        if go_home_height_m is not None:
            settings = app.aircraft.settings
            app.aircraft.settings = replace(settings, go_home_height_m=go_home_height_m)
    airspace = ready_airspace(
        HOME,
        limits=FlightLimits(max_height_above_ground_m=max_height_m),
        zones=zones,
        elevation=elevation,
        landing_pads=tuple(
            LandingPad(f"pad {s[-1]}", s, p) for s, p in points.items() if knows_pads
        ),
    )
    site = ready_site(HOME, profiles)
    station = first_state(site)
    station = replace(station, airspace=PreparedAirspace(airspace))
    jobs = JobRunner(site) if plans else None
    driver = VirtualDriver(station, jobs=jobs, work_takes_s=plan_takes_s, keeps_log=False)
    world = World(driver)
    for app in apps:
        world.connect(app)
    made = ReturningWorld(world, dict(zip(serials, map(tuple, pads_m), strict=True)), pads_up_m)
    made.runs(3.0)
    return made
