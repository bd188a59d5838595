"""The same flights twice: in the simulator's apps through the whole station in virtual time (gear
2), and worked out by events (gear 3). Their arrival times must agree.

    python -m studies.gears --seeds 20

Single missions first, drawn at random: from the ground or from the air, over waypoints at many
distances, heights and speeds, with stops, in calm air and in wind; then the way home, a landing on
the spot, or a landing at the mission's end. Then whole surveys (`studies.survey_gears`): by one
drone from the first order to the landing at home, and each mission of three drones by itself.
Prints how far apart the arrival times are, counted since the flight was ordered, and ends with 1
when one differs by 3 % or more.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import cos, radians, sin
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

import numpy as np

from recon.geo import geo_from_enu
from recon.model.command import Body, FlyMission, LandNow, ReturnHome
from recon.model.event import OperatorOrder
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.mission import Mission, Waypoint
from recon.model.units import NS_PER_S
from recon.model.vehicle import AltitudeReference, Failsafe, VehicleProfile
from recon.model.zone import Region
from recon.score.autopilot import Autopilot
from recon.score.flight import Hop, Spot
from recon.score.missions import points_of
from recon.score.settings import FLIGHT
from recon.score.simulation import wind_of
from recon.score.whole.apps import AppConnection
from recon.sim.app.app import SimulatedApp
from recon.sim.fleet import Airborne, SimulationConfig, build_fleet
from recon.sim.flight.aircraft import Aircraft
from recon.sim.flight.flight_modes import TakeOff
from recon.sim.flight.kinematics import AircraftMotion
from recon.sim.flight.mission import MissionFlight
from recon.sim.world import Wind, WindSettings
from recon.site import Site
from recon.site.site import Layers
from recon.station.kernel.build import first_state
from recon.station.kernel.virtual import VirtualDriver
from recon.station.kernel.worker import JobRunner
from studies.survey_gears import LANDED, by_events, by_the_station, drawn_survey

HOME = GeoPoint(41.9, -93.6, 275.0)
FRAME = LocalFrame(HOME)
SERIAL = "SIM-1"
GO_HOME_HEIGHT_M = 40.0
ENDURANCE_S = 3_000.0
HALF_FENCE_M = 2_000.0
STEP_S = 0.05
HEARD_AFTER_S = 3.0
HOVERS_S = 2.0
"""Between the end of a mission and what follows it."""
AT_MOST_S = 900.0
LONGEST_RADIUS_M = 15.0
FASTEST_MPS, STRONGEST_MPS = 10.0, 5.0
"""Of flights, and of the wind 10 m up: against it the airframe's 17 m/s through the air are just
enough. Beyond, gusts decide, of which events know nothing."""
ALLOWED, ALLOWED_S = 0.03, 0.2
"""Of the time; what takes seconds may differ by four steps of the flight controller."""

MISSIONS, CURVES = "missions", "missions past rounded corners"
SURVEYS, SHARES = "surveys by one drone", "missions of three drones"


@dataclass(frozen=True, slots=True)
class Flight:
    """One flight: a mission, and the order that follows it unless it lands at its end."""

    mission: Mission
    start_m: Spot
    wind: WindSettings | None
    after: Body | None

    @property
    def name(self) -> str:
        """In few words."""
        begins = "from the ground" if self.start_m[2] == 0.0 else "from the air"
        ends = "lands at its end" if self.after is None else type(self.after).__name__
        air = "calm" if self.wind is None else f"wind {self.wind.speed_10m_mps:.1f} m/s"
        corners = "rounded " * self.mission.curved
        return f"{begins}, {len(self.mission.waypoints)} {corners}waypoints, {ends}, {air}"


@dataclass(frozen=True, slots=True)
class Arrival:
    """When something was reached, in both gears, in seconds since the flight was ordered."""

    kind: str
    flight: str
    what: str
    gear_2_s: float
    gear_3_s: float

    @property
    def off(self) -> float:
        """The difference over the time, as it is in gear 2."""
        return (self.gear_3_s - self.gear_2_s) / self.gear_2_s

    @property
    def share_of_allowed(self) -> float:
        """The difference over what may be."""
        allowed_s = max(ALLOWED * self.gear_2_s, ALLOWED_S)
        return abs(self.gear_3_s - self.gear_2_s) / allowed_s

    @property
    def is_end(self) -> bool:
        """Whether the flight has ended by this: the drone has landed."""
        return self.what == LANDED


def drawn_flight(random: Random) -> Flight:
    """Return a flight that nothing speaks against."""
    flies = random.random() < 0.5
    start_m = (0.0, 0.0, random.uniform(25.0, 80.0) if flies else 0.0)
    after = random.choice((ReturnHome(), LandNow(), None))
    wind = WindSettings(
        random.randrange(1000), random.uniform(1.0, STRONGEST_MPS), random.uniform(0.0, 360.0)
    )
    points = list(_drawn_points(random, random.randint(1, 8)))
    return Flight(
        _mission(points, after is None),
        start_m,
        wind if random.random() < 0.5 else None,
        after,
    )


def drawn_curve(random: Random) -> Flight:
    """Return a flight past rounded corners."""
    count = random.randint(3, 8)
    east_m = north_m = 0.0
    points: list[tuple[Spot, float, float | None]] = []
    height_m, speed_mps = random.uniform(30.0, 60.0), random.uniform(2.0, FASTEST_MPS)
    bearing = random.uniform(0.0, 360.0)
    for _ in range(count):
        points.append(((east_m, north_m, height_m), speed_mps, None))
        bearing += random.uniform(-135.0, 135.0)
        far_m = random.uniform(2.5, 12.0) * LONGEST_RADIUS_M
        east_m += far_m * sin(radians(bearing))
        north_m += far_m * cos(radians(bearing))
        height_m += random.choice((0.0, 0.0, 5.0))
    mission = _mission(points, False)
    radius_m = random.uniform(1.0, LONGEST_RADIUS_M)
    waypoints = tuple(replace(each, corner_radius_m=radius_m) for each in mission.waypoints)
    start_m = (0.0, 0.0, random.choice((0.0, height_m)))
    return Flight(replace(mission, waypoints=waypoints, curved=True), start_m, None, LandNow())


def _drawn_points(random: Random, count: int) -> Iterator[tuple[Spot, float, float | None]]:
    east_m = north_m = 0.0
    height_m, speed_mps = random.uniform(30.0, 80.0), random.uniform(2.0, FASTEST_MPS)
    yield (east_m, north_m, height_m), speed_mps, None
    for _ in range(count):
        if random.random() < 0.7:
            bearing, far_m = random.uniform(0.0, 360.0), 10.0 ** random.uniform(0.8, 2.6)
            east_m += far_m * sin(radians(bearing))
            north_m += far_m * cos(radians(bearing))
        else:
            height_m += random.uniform(3.0, 30.0) * (1.0 if height_m < 55.0 else -1.0)
        if random.random() < 0.3:
            speed_mps = random.uniform(2.0, FASTEST_MPS)
        loiter_s = random.uniform(0.0, 5.0) if random.random() < 0.2 else None
        yield (east_m, north_m, height_m), speed_mps, loiter_s


def _mission(points: Sequence[tuple[Spot, float, float | None]], lands: bool) -> Mission:
    waypoints = []
    for (east_m, north_m, height_m), speed_mps, loiter_s in points:
        latitude, longitude, _ = geo_from_enu(FRAME, (east_m, north_m, 0.0))
        at = float(latitude[0]), float(longitude[0])
        waypoints.append(Waypoint(*at, height_m, speed_mps, loiter_s=loiter_s))
    return Mission(tuple(waypoints), land_at_end=lands)


def site() -> Site:
    """Return a wide fence round one pad."""
    profile = VehicleProfile(
        SERIAL,
        waypoint_altitude=AltitudeReference.TAKEOFF,
        pad=HOME,
        endurance_s=ENDURANCE_S,
        go_home_height_m=GO_HOME_HEIGHT_M,
        failsafe=Failsafe.GO_HOME,
    )
    half = HALF_FENCE_M
    corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
    fence = Region(np.array(corners))
    return Site("gears", frame=FRAME, profiles={SERIAL: profile}, layers=Layers(boundary=fence))


class SimulatedFlight:
    """Gear 2: an app, its aircraft and the station."""

    def __init__(self, flight: Flight) -> None:
        self._flight = flight
        place = site()
        self._driver = VirtualDriver(first_state(place), jobs=JobRunner(place), keeps_log=False)
        app = _app(flight)
        app.connected(0)
        self._aircraft = app.aircraft
        self._driver.connect(AppConnection(app))
        self._driver.run_for(HEARD_AFTER_S)
        self._orders = 0
        self._start_ns = self._driver.now_ns

    def arrivals_s(self) -> dict[str, float]:
        """Fly, and return when each waypoint was reached, and the ground."""
        reached: dict[str, float] = {}
        self._order(FlyMission(self._flight.mission))
        flown, mission = 0, None
        last, is_curved = len(self._flight.mission.waypoints), self._flight.mission.curved
        while flown < last:
            self._step()
            flying = _mission_of(self._aircraft)
            mission = mission or flying
            index = flown if mission is None else mission.next_index
            if is_curved:
                # Past rounded corners waypoints are not counted; the mission's end is.
                index = last if mission is not None and flying is None else flown
            for number in range(max(flown, index - 1) if is_curved else flown, index):
                reached[f"waypoint {number + 1}"] = self._now_s
            flown = index
            if self._now_s > AT_MOST_S:
                raise RuntimeError(f"not flown: {self._flight.name}: {self._why()}")
        if self._flight.after is not None:
            self._run_for(HOVERS_S)
            self._order(self._flight.after)
        while not self._aircraft.is_on_ground:
            self._step()
            if self._now_s > AT_MOST_S:
                raise RuntimeError(f"not landed: {self._flight.name}: {self._why()}")
        return {**reached, LANDED: self._now_s}

    @property
    def _now_s(self) -> float:
        return (self._driver.now_ns - self._start_ns) / NS_PER_S

    def _step(self) -> None:
        self._driver.run_for(STEP_S)

    def _run_for(self, seconds: float) -> None:
        self._driver.run_for(seconds)

    def _order(self, body: Body) -> None:
        self._orders += 1
        takes_off = isinstance(body, FlyMission)
        order = OperatorOrder(self._orders, body, "study", serial=SERIAL, takeoff=takes_off)
        self._driver.handle(order)

    def _why(self) -> str:
        return "; ".join(
            f"{type(each.command.body).__name__} {each.phase.value} {each.note}"
            for each in self._driver.station.orders.records.values()
        )


def _app(flight: Flight) -> SimulatedApp:
    config = SimulationConfig(
        home=HOME,
        vehicle_count=1,
        airborne=Airborne.NONE if flight.start_m[2] == 0.0 else Airborne.ALL,
        endurance_s=ENDURANCE_S,
        wind=flight.wind,
        pads={SERIAL: HOME},
        go_home_heights_m={SERIAL: GO_HOME_HEIGHT_M},
    )
    (app,) = build_fleet(config, 0)
    east_m, north_m, up_m = flight.start_m
    app.aircraft.motion = AircraftMotion(north_m, east_m, up_m)
    return app


def _mission_of(aircraft: Aircraft) -> MissionFlight | None:
    active_mode = aircraft.active_mode
    if isinstance(active_mode, TakeOff):
        active_mode = active_mode.then
    return active_mode if isinstance(active_mode, MissionFlight) else None


def worked_out_s(flight: Flight) -> dict[str, float]:
    """Return the same by events (gear 3)."""
    wind = None if flight.wind is None else Wind(flight.wind)
    autopilot = Autopilot(FLIGHT.acts_after_s, flight.start_m, wind)
    if flight.start_m[2] == 0.0:
        autopilot.take_off()
    fly = autopilot.fly_curved if flight.mission.curved else autopilot.fly
    fly(points_of(flight.mission, FRAME))
    reached = arrivals_s(autopilot.hops)
    if flight.after is not None:
        autopilot.wait(HOVERS_S + FLIGHT.acts_after_s)
    if isinstance(flight.after, ReturnHome):
        autopilot.go_home((0.0, 0.0), GO_HOME_HEIGHT_M)
    else:
        autopilot.land()
    return {**reached, LANDED: autopilot.now_s}


def arrivals_s(hops: Sequence[Hop]) -> dict[str, float]:
    """Return when each waypoint of one mission counts as reached: when its stop is over."""
    return {f"waypoint {hop.waypoint + 1}": hop.end_s for hop in hops if hop.waypoint is not None}


def compared(flight: Flight) -> list[Arrival]:
    """Return the arrivals of one flight in both gears."""
    slow, fast = SimulatedFlight(flight).arrivals_s(), worked_out_s(flight)
    kind = CURVES if flight.mission.curved else MISSIONS
    return [Arrival(kind, flight.name, what, slow[what], fast[what]) for what in slow]


def compared_survey(folder: Path, seed: int) -> Iterator[Arrival]:
    """Yield the arrivals of a whole survey by one drone, from its first order to its landing."""
    scenario = drawn_survey(folder, seed)
    slow, fast = by_the_station(scenario, seed).ways(), by_events(scenario, seed)
    for serial, way in slow.items():
        if way.keys() != fast[serial].keys():
            raise RuntimeError(f"survey {seed}: the gears fly different missions")
        for what, at_s in way.items():
            yield Arrival(SURVEYS, f"survey {seed}", what, at_s, fast[serial][what])


def compared_shares(folder: Path, seed: int) -> Iterator[Arrival]:
    """Yield the arrivals of each mission of a survey by three drones, as the station gave them.

    Which of them flies what, and who waits for whom, is the gate's and the fleet return's matter,
    which events know nothing of.
    """
    scenario = drawn_survey(folder, seed, drones=3)
    wind = wind_of(scenario, seed)
    for serial, missions in by_the_station(scenario, seed).missions.items():
        for number, mission in enumerate(missions, 1):
            worked_out_s = mission.worked_out_s(wind)
            for what, at_s in mission.reached_s.items():
                times_s = at_s - mission.begun_s, worked_out_s[what] - mission.begun_s
                yield Arrival(SHARES, f"survey {seed}, {serial}, mission {number}", what, *times_s)


def arrivals(seeds: int) -> list[Arrival]:
    """Return all that is compared for so many seeds of each kind."""
    found = [each for seed in range(seeds) for each in compared(drawn_flight(Random(seed)))]
    found += [each for seed in range(seeds) for each in compared(drawn_curve(Random(seed)))]
    with TemporaryDirectory() as folder:
        for seed in range(seeds):
            found += compared_survey(Path(folder), seed)
            found += compared_shares(Path(folder), seed)
    return found


def table(found: Sequence[Arrival]) -> Iterator[str]:
    """Yield the lines that tell how far apart the gears are."""
    yield "| flights | arrivals | mean difference | worst | at | it took, s |"
    yield "| --- | --- | --- | --- | --- | --- |"
    for kind in (MISSIONS, CURVES, SURVEYS, SHARES):
        for name, is_of in (("on the way", False), ("at the end", True)):
            own = [each for each in found if each.kind == kind and each.is_end == is_of]
            worst = max(own, key=lambda each: each.share_of_allowed)
            mean = sum(abs(each.off) for each in own) / len(own)
            yield (
                f"| {kind}, {name} | {len(own)} | {mean:.2%} | {worst.off:+.2%} "
                f"| {worst.flight}, {worst.what} | {worst.gear_2_s:.1f} |"
            )


def main() -> int:
    """Compare, print, and say whether all is within what is allowed."""
    parser = argparse.ArgumentParser(description="Arrival times of gears 2 and 3.")
    parser.add_argument("--seeds", type=int, default=10, help="of each kind of flight")
    found = arrivals(parser.parse_args().seeds)
    print("\n".join(table(found)))
    beyond = [each for each in found if each.share_of_allowed >= 1.0]
    for each in beyond:
        print(f"too far off: {each}")
    return 1 if beyond else 0


if __name__ == "__main__":
    sys.exit(main())
