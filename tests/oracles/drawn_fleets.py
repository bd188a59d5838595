"""Fleets drawn by chance: an order to move for one vehicle, and one to five others in its air."""

from dataclasses import dataclass, replace
from functools import partial
from math import hypot

import numpy as np
from tests.oracles import sampled_orders as sampled
from tests.oracles.agreement import Agreement, over
from tests.oracles.places import NOW_NS, ORIGIN, FloatArray, degrees, lat_lon
from tests.oracles.sampled_fleets import Course, Need, margin
from tests.oracles.sampled_flights import EAST, HIGH, LOW, NORTH, Aircraft, Flight

from recon.model.airspace import Airspace, FlightLimits
from recon.model.command import (
    Body,
    Command,
    FlyMission,
    GoTo,
    HoldPosition,
    Nudge,
    StickFrame,
    VirtualStick,
)
from recon.model.control import Commanded, Intent
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.mission import Mission, Waypoint
from recon.model.units import Stamped
from recon.model.vehicle import Attitude, Failsafe, VehicleProfile, VehicleState, VelocityNed
from recon.safety import PreparedAirspace, Situation, Traffic
from recon.safety.rules import Rule
from recon.safety.rules.separation import separation

TRAFFIC = ("mission", "set out", "goto", "stick", "hover", "return", "landing", "free", "hazard")
TRAFFIC_SHARES = (0.16, 0.12, 0.13, 0.12, 0.12, 0.12, 0.09, 0.09, 0.05)
ORDERS = ("mission", "goto", "nudge", "stick", "hold")
IN_THE_WAY = ("stick", "hover", "landing", "free")
HAZARD_SPREAD_M = 400.0
"""A hazard area is 150 m wide: nearer, it alone would decide every scene."""
ORDER_SHARES = (0.45, 0.2, 0.08, 0.2, 0.07)


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """An order among traffic, as the rule and as the sampling see it."""

    order: str
    command: Command
    situation: Situation
    own: Course
    others: list[Course]
    need: Need


def draw(seed: int) -> Scene:
    """Return the scene of a seed."""
    rng = np.random.default_rng(seed)
    need = Need(float(rng.uniform(8.0, 25.0)), float(rng.uniform(3.0, 10.0)))
    # The rule keeps 3 m and 1.5 m beyond the site's limits: watchdog margin and track error.
    limits = FlightLimits(
        min_separation_horizontal_m=need.horizontal_m - 3.0,
        min_separation_vertical_m=need.vertical_m - 1.5,
    )
    spread_m = float(rng.choice([50.0, 100.0, 200.0, 300.0]))
    order = str(rng.choice(ORDERS, p=ORDER_SHARES))
    aircraft, body, flight = _order(rng, order, spread_m)
    traffic: list[Traffic] = []
    others: list[Course] = []
    for number in range(rng.integers(1, 6)):
        kind = str(rng.choice(TRAFFIC, p=TRAFFIC_SHARES))
        other, intent, courses = _traffic(rng, kind, spread_m, flight)
        is_flying = kind != "set out"
        state = _vehicle(rng, other, f"B{number}", is_flying=is_flying)
        traffic.append(Traffic(state, intent))
        others += courses
    airspace = PreparedAirspace(Airspace(limits=limits, frame=LocalFrame(ORIGIN)))
    is_up = bool(aircraft.here_m[2] > aircraft.takeoff_m)
    vehicle = _vehicle(rng, aircraft, "A", is_flying=is_up)
    return Scene(
        order,
        Command(1, body, "study", NOW_NS, NOW_NS + 5 * 10**9, serial="A", takeoff=not is_up),
        Situation(NOW_NS, vehicle, (), airspace=airspace, traffic=tuple(traffic)),
        Course.of(order, flight),
        others,
        need,
    )


def _order(rng: np.random.Generator, order: str, spread_m: float) -> tuple[Aircraft, Body, Flight]:
    aircraft = _aircraft(rng, spread_m)
    takeoff_m = aircraft.takeoff_m
    if order == "mission":
        if rng.random() < 0.25:
            aircraft = _on_ground(aircraft)
        route = _route(rng, aircraft, spread_m)
        mission = FlyMission(_mission(route, takeoff_m))
        return aircraft, mission, sampled.ordered_mission(aircraft, route)
    if order == "goto":
        target_m, speed_mps = _somewhere(rng, aircraft, spread_m), float(rng.uniform(2.0, 12.0))
        body: Body = GoTo(lat_lon(target_m), float(target_m[2]) - takeoff_m, speed_mps)
        return aircraft, body, sampled.ordered_goto(aircraft, target_m, speed_mps)
    if order == "nudge":
        east_m, north_m, up_m = (float(metres) for metres in rng.uniform(-25.0, 25.0, 3))
        target_m = aircraft.here_m + np.array([east_m, north_m, up_m])
        body = Nudge(north_m, east_m, up_m, 3.0)
        return aircraft, body, sampled.ordered_goto(aircraft, target_m, 3.0)
    if order == "hold":
        return aircraft, HoldPosition(), sampled.ordered_hold(aircraft)
    velocity_mps = rng.uniform(-12.0, 12.0, 2)
    up_m, timeout_s = float(aircraft.here_m[2] + rng.uniform(-8.0, 8.0)), float(rng.uniform(0.3, 5))
    north_mps, east_mps = float(velocity_mps[1]), float(velocity_mps[0])
    body = VirtualStick(StickFrame.GROUND, 0.0, north_mps, east_mps, up_m - takeoff_m, timeout_s)
    return aircraft, body, sampled.ordered_stick(aircraft, velocity_mps, up_m, timeout_s)


def _traffic(
    rng: np.random.Generator, kind: str, spread_m: float, ordered: Flight
) -> tuple[Aircraft, Intent, list[Course]]:
    """A vehicle, its command, and its sampled courses; often in the order's way."""
    aircraft = _aircraft(rng, HAZARD_SPREAD_M if kind == "hazard" else spread_m)
    if kind in IN_THE_WAY and rng.random() < 0.4:
        aircraft = replace(aircraft, here_m=_beside(rng, ordered))
    if kind in ("mission", "set out", "hazard"):
        return _flying_a_mission(rng, kind, aircraft, spread_m)
    intent, flight = _commanded(rng, kind, aircraft, spread_m)
    return aircraft, intent, [Course.of(kind, flight)]


def _flying_a_mission(
    rng: np.random.Generator, kind: str, aircraft: Aircraft, spread_m: float
) -> tuple[Aircraft, Intent, list[Course]]:
    """A mission under way, about to take off for it, or with telemetry lost."""
    route, passed = _route(rng, aircraft, spread_m), 0
    if kind == "set out":
        aircraft = _on_ground(aircraft)
    else:
        passed = int(rng.integers(0, len(route.points_m)))
        aircraft = _on_route(rng, aircraft, route, passed)
    if kind == "hazard":
        aircraft = replace(aircraft, age_s=float(rng.uniform(3.2, 60.0)))
    is_known = kind != "hazard" or bool(rng.random() < 0.5)
    courses = [Course.of(kind, sampled.on_mission(aircraft, route, passed))] if is_known else []
    if kind == "hazard":
        known_mps = float(route.speeds_mps.max()) if is_known else 0.0
        courses += [Course.around(kind, volume) for volume in sampled.hidden(aircraft, known_mps)]
    mission = _mission(route, aircraft.takeoff_m)
    intent = Intent(Commanded.MISSION, mission=mission, passed=passed) if is_known else Intent()
    return aircraft, intent, courses


def _commanded(
    rng: np.random.Generator, kind: str, aircraft: Aircraft, spread_m: float
) -> tuple[Intent, Flight]:
    if kind == "goto":
        target_m, speed_mps = _somewhere(rng, aircraft, spread_m), float(rng.uniform(2.0, 12.0))
        intent = Intent(
            Commanded.STICK,
            target=lat_lon(target_m),
            target_height_above_takeoff_m=float(target_m[2]) - aircraft.takeoff_m,
            speed_mps=speed_mps,
        )
        return intent, sampled.on_goto(aircraft, target_m, speed_mps)
    commanded, flies = {
        "stick": (Commanded.STICK, sampled.on_stick),
        "hover": (Commanded.HOLD, sampled.on_hold),
        "return": (Commanded.RETURN, sampled.on_return),
        "landing": (Commanded.LAND, sampled.on_landing),
        "free": (Commanded.NOTHING, sampled.without_command),
    }[kind]
    return Intent(commanded), flies(aircraft)


def _aircraft(rng: np.random.Generator, spread_m: float) -> Aircraft:
    """Half of them stand, or nearly so."""
    home_m, takeoff_m = rng.uniform(-spread_m, spread_m, 2), float(rng.uniform(-5.0, 5.0))
    here_m = np.array([*rng.uniform(-spread_m, spread_m, 2), rng.uniform(25.0, 65.0)])
    velocity_mps = np.zeros(3)
    if rng.random() < 0.5:
        speed_mps, course = rng.uniform(0.6, 12.0), rng.uniform(0.0, 2.0 * np.pi)
        velocity_mps[:2] = speed_mps * np.cos(course), speed_mps * np.sin(course)
        velocity_mps[2] = rng.uniform(-3.0, 3.0) if rng.random() < 0.3 else 0.0
    go_home_m = float(takeoff_m + rng.uniform(20.0, 100.0)) if rng.random() < 0.9 else None
    goes_home, age_s = bool(rng.random() < 0.6), float(rng.uniform(0.0, 1.0))
    return Aircraft(here_m, velocity_mps, home_m, takeoff_m, go_home_m, goes_home, age_s)


def _beside(rng: np.random.Generator, ordered: Flight) -> FloatArray:
    """Somewhere about the ordered way."""
    samples = ordered.certain
    sample = samples[rng.integers(0, len(samples))]
    up_m = rng.uniform(max(sample[LOW], 0.0), max(sample[HIGH], 1.0))
    return np.array([sample[EAST], sample[NORTH], up_m]) + rng.normal(0.0, (20.0, 20.0, 6.0))


def _on_ground(aircraft: Aircraft) -> Aircraft:
    here_m = np.array([*aircraft.home_m, aircraft.takeoff_m])
    return replace(aircraft, here_m=here_m, velocity_mps=np.zeros(3))


def _on_route(
    rng: np.random.Generator, aircraft: Aircraft, route: sampled.Route, passed: int
) -> Aircraft:
    """Somewhere on the leg to its next waypoint, flying along it."""
    towards_m = route.points_m[passed]
    before_m = route.points_m[passed - 1] if passed > 0 else aircraft.here_m
    here_m = before_m + rng.uniform(0.0, 0.9) * (towards_m - before_m)
    along_m = (towards_m - here_m)[:2]
    speed_mps = float(route.speeds_mps[max(0, passed - 1)] * rng.choice([0.0, 0.5, 1.0]))
    velocity_mps = np.array([*(speed_mps * along_m / hypot(*along_m)), 0.0])
    return replace(aircraft, here_m=here_m, velocity_mps=velocity_mps)


def _route(rng: np.random.Generator, aircraft: Aircraft, spread_m: float) -> sampled.Route:
    """Level in half of the cases, as surveys are."""
    count = int(rng.integers(2, 7))
    points_m = np.array([_somewhere(rng, aircraft, spread_m) for _ in range(count)])
    if rng.random() < 0.5:
        points_m[:, 2] = points_m[0, 2]
    curved = bool(rng.random() < 0.4)
    waits_s = np.where(rng.random(count) < 0.2, rng.uniform(1.0, 20.0, count), 0.0)
    return sampled.Route(
        points_m,
        rng.uniform(3.0, 12.0, count),
        np.zeros(count) if curved else waits_s,
        rng.uniform(0.2, 40.0, count),
        curved,
        land_at_end=bool(rng.random() < 0.4),
    )


def _somewhere(rng: np.random.Generator, aircraft: Aircraft, spread_m: float) -> FloatArray:
    return np.array(
        [*rng.uniform(-spread_m, spread_m, 2), aircraft.takeoff_m + rng.uniform(25.0, 65.0)]
    )


def _mission(route: sampled.Route, takeoff_m: float) -> Mission:
    rows = zip(route.points_m, route.speeds_mps, route.radii_m, route.waits_s, strict=True)
    waypoints = tuple(
        Waypoint(
            *degrees(point_m),
            float(point_m[2]) - takeoff_m,
            float(speed_mps),
            corner_radius_m=float(radius_m),
            loiter_s=float(wait_s) if wait_s > 0.0 else None,
        )
        for point_m, speed_mps, radius_m, wait_s in rows
    )
    return Mission(waypoints, route.land_at_end, route.curved)


def _vehicle(
    rng: np.random.Generator, aircraft: Aircraft, serial: str, *, is_flying: bool
) -> VehicleState:
    at_ns = NOW_NS - round(aircraft.age_s * 1e9)
    east_mps, north_mps, up_mps = (float(mps) for mps in aircraft.velocity_mps)
    pad_m = ORIGIN.ellipsoid_height_m + aircraft.takeoff_m
    others = [Failsafe.HOVER, Failsafe.LAND]
    profile = VehicleProfile(
        serial,
        pad=GeoPoint(*degrees(aircraft.home_m), pad_m),
        go_home_height_m=None
        if aircraft.go_home_m is None
        else aircraft.go_home_m - aircraft.takeoff_m,
        failsafe=Failsafe.GO_HOME if aircraft.goes_home else others[rng.integers(0, 2)],
    )
    return VehicleState(
        serial,
        link_id=1,
        profile=profile,
        is_flying=Stamped(is_flying, at_ns),
        position=Stamped(lat_lon(aircraft.here_m), at_ns),
        height_above_takeoff_m=Stamped(float(aircraft.here_m[2]) - aircraft.takeoff_m, at_ns),
        velocity_ned=Stamped(VelocityNed(north_mps, east_mps, -up_mps), at_ns),
        attitude=Stamped(Attitude(0.0, 0.0, 0.0), at_ns),
        core_received_at_ns=at_ns,
        takeoff_point=lat_lon(aircraft.home_m),
    )


NAMES = (*TRAFFIC, *(f"order: {name}" for name in ORDERS))


def compare(seeds: range, rule: Rule = separation, progress: bool = False) -> Agreement:
    """Return how the rule and the sampling agree on the scenes of these seeds."""
    return over(seeds, partial(_compare, rule), progress)


def _compare(rule: Rule, seed: int, found: Agreement) -> None:
    scene = draw(seed)
    margins = [margin(scene.own, other, scene.need) for other in scene.others]
    worst = min(margins, key=lambda each: (not each.is_broken, each.possible_m))
    names = (worst.kind, f"order: {scene.order}")
    if not worst.is_broken and not worst.is_kept:
        found.unsure.update(names)
        return
    margin_m = worst.certain_m if worst.is_broken else worst.possible_m
    refusal = rule(scene.command, scene.situation)
    found.compare(f"scene {seed}, order: {scene.order}", worst.kind, margin_m, refusal)
    (found.broken if worst.is_broken else found.kept)[names[1]] += 1
