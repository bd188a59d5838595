"""The plan of a fleet return: the positions of vehicles and pads, and the worker's job.

For a large fleet planning takes longer than a step may.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import dist

import numpy as np

from recon.guidance.fleet_return import (
    CalledVehicle,
    Hovering,
    Pad,
    ReturnPlan,
    Separation,
    plan_return,
    route_home,
)
from recon.model.airspace import Airspace
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.safety.datum import home_enu_m, places_m, takeoff_up_m, vehicle_enu_m
from recon.safety.prediction import height_drift_m
from recon.safety.separation_minima import gate_minima
from recon.station.operations.settings import ReturnSettings
from recon.station.state.fleet_return_record import UNDER_WAY, FleetReturn, ReturningVehicle, Stage
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobKind, Output, Stepped

AROUND_M = 50.0
"""Ground this far around all positions and pads counts: detours leave the straight lines."""


def in_the_air(station: Station, frame: LocalFrame) -> dict[str, Hovering]:
    """Return the last known position of everything that flies, or may; by serial, or by link.

    Vehicles without any known position are excluded: the gate refuses all motion because of them.
    """
    flying = {
        serial: vehicle
        for serial, vehicle in station.fleet.vehicles.items()
        if vehicle.is_flying.value is not False
    }
    for link in station.fleet.unbound_links():
        if link.own_state.is_flying.value is True:
            flying[f"link {link.id}"] = link.own_state
    known = [(k, v, v.position.value) for k, v in flying.items() if v.position.value is not None]
    spots = places_m(frame, [position for _, _, position in known if position is not None])
    found: dict[str, Hovering] = {}
    for (key, vehicle, _), (east_m, north_m) in zip(known, spots, strict=True):
        base_m = takeoff_up_m(station.airspace, vehicle)
        height_m = vehicle.height_above_takeoff_m.value
        if base_m is not None and height_m is not None:
            place_m = float(east_m), float(north_m), base_m + height_m
            found[key] = Hovering(key, vehicle.display_name, place_m)
    return found


def returning(station: Station, serial: str, frame: LocalFrame) -> CalledVehicle | str:
    """Return a vehicle as the plan needs it, or a sentence about what is unknown."""
    vehicle = station.fleet.vehicles[serial]
    found = vehicle_enu_m(station.airspace, vehicle, frame)
    takeoff_m = takeoff_up_m(station.airspace, vehicle)
    pad = _pad(station, vehicle, frame)
    if found is None or takeoff_m is None or pad is None:
        return (
            "its position or takeoff point is unknown, and its heights count from there; give it a "
            "pad in the site's file"
        )
    place_m = float(found[0]), float(found[1]), float(found[2])
    battery = vehicle.battery_fraction.value
    return CalledVehicle(serial, vehicle.display_name, place_m, takeoff_m, pad, battery)


def ground_up_m(station: Station, vehicles: Sequence[CalledVehicle]) -> tuple[float, float]:
    """Return the lowest and the highest ground on and around the paths of these vehicles."""
    spots = [v.place_m[:2] for v in vehicles] + [v.pad.east_north_m for v in vehicles]
    lowest_m, highest_m = station.airspace.ground_within_up_m(_box(spots))
    return float(np.min(lowest_m)), float(np.max(highest_m))


def separation(
    station: Station, settings: ReturnSettings, now_ns: int, ahead_s: float = 0.0
) -> Separation:
    """Return how far apart vehicles are kept: the gate's minima, and some slack, or what two
    barometers may have drifted by then where that is more."""
    safety = station.settings.safety
    gate = gate_minima(station.airspace.airspace.limits, safety)
    drifts_m = sorted(
        height_drift_m(vehicle, now_ns, safety.prediction, ahead_s)
        for vehicle in station.fleet.vehicles.values()
    )
    return Separation(
        gate.horizontal_m + settings.plan.horizontal_slack_m,
        gate.vertical_m + max(sum(drifts_m[-2:]), settings.plan.vertical_slack_m),
    )


def is_same_pad(one: Pad, other: Pad, settings: ReturnSettings) -> bool:
    """Return whether two pads are so near that only one vehicle fits."""
    return dist(one.east_north_m, other.east_north_m) < settings.same_pad_m


def _pad(station: Station, vehicle: VehicleState, frame: LocalFrame) -> Pad | None:
    """Return its own pad, from the site's layer or its profile; else its takeoff point."""
    for pad in station.airspace.airspace.landing_pads:
        if pad.serial is not None and pad.serial == vehicle.serial:
            return _pad_at(station, pad.name, pad.place, frame)
    if vehicle.profile is not None and vehicle.profile.pad is not None:
        return _pad_at(station, "of its own", vehicle.profile.pad, frame)
    home_m = home_enu_m(station.airspace, vehicle, frame)
    if home_m is None:
        return None
    return Pad("at its takeoff point", float(home_m[0]), float(home_m[1]), float(home_m[2]))


def _pad_at(station: Station, name: str, point: GeoPoint, frame: LocalFrame) -> Pad:
    (east_m, north_m), *_ = places_m(frame, [point])
    origin_m = frame.origin.ellipsoid_height_m
    is_site = station.airspace.airspace.frame is not None
    up_m = point.ellipsoid_height_m - origin_m if is_site else 0.0
    return Pad(name, float(east_m), float(north_m), up_m)


def _box(
    points: Sequence[tuple[float, float]],
) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Two triangles that cover all points and the ground around them, (2, 3, 2)."""
    low = np.min(points, axis=0) - AROUND_M
    high = np.max(points, axis=0) + AROUND_M
    return np.array([[low, (high[0], low[1]), high], [low, high, (low[0], high[1])]])


@dataclass(frozen=True, slots=True, eq=False)
class ReturnPlanRequest:
    """All that a plan needs. `ground_up_m`: the lowest and the highest ground on the paths."""

    vehicles: tuple[CalledVehicle, ...]
    others: tuple[Hovering, ...]
    airspace: Airspace
    ground_up_m: tuple[float, float]
    separation: Separation
    settings: ReturnSettings
    first_wave: int
    occupied_m: tuple[float, ...]
    """Layers of the flights that are under way."""


def make_plan(work: ReturnPlanRequest) -> ReturnPlan:
    """Return the plan: the worker's part."""
    spots = [v.place_m[:2] for v in work.vehicles]
    spots += [v.pad.east_north_m for v in work.vehicles]
    settings = work.settings.plan
    home = route_home(work.airspace, work.ground_up_m, spots, settings)
    return plan_return(
        work.vehicles,
        home,
        work.separation,
        settings,
        work.others,
        work.first_wave,
        work.occupied_m,
    )


def ask(
    station: Station, running: FleetReturn, settings: ReturnSettings, now_ns: int
) -> tuple[FleetReturn, tuple[Output, ...]]:
    """Request a plan for all that wait, unless one is being made; give up one that never comes."""
    if running.planning_since_ns is not None:
        within_s = settings.planned_within_s
        if now_ns - running.planning_since_ns < seconds_to_ns(within_s):
            return running, ()
        return _excluded(running, f"it was not planned within {within_s:g} s", now_ns), ()
    vehicles: list[CalledVehicle] = []
    for member in running.at(Stage.WAITING):
        found = returning(station, member.serial, running.frame)
        if isinstance(found, str):
            running = running.put(member.at(Stage.EXCLUDED, now_ns, found))
        else:
            vehicles.append(found)
    if not vehicles:
        return running, ()
    work = _work(station, running, vehicles, settings, now_ns)
    planning = replace(running, planning_since_ns=now_ns)
    return planning, (Job(now_ns, PLAN_RETURN, work),)


def _planned(station: Station, job_id: int, plan: ReturnPlan, now_ns: int) -> Stepped:
    """Give the plan's flights to the vehicles that still wait for it."""
    running = station.fleet_return
    if running is None or running.planning_since_ns != job_id:
        return station, ()
    running = replace(running, planning_since_ns=None, layers_up_m=plan.layers_up_m)
    for flight in plan.flights:
        member = running.members[flight.serial]
        if member.stage is Stage.WAITING:
            running = running.put(replace(member, flight=flight))
    for left in plan.excluded:
        member = running.members[left.serial]
        if member.stage is Stage.WAITING:
            running = running.put(member.at(Stage.EXCLUDED, now_ns, left.reason))
    turns = tuple(flight.serial for flight in plan.flights)
    return replace(station, fleet_return=replace(running, turns=turns)), ()


def _not_planned(station: Station, job_id: int, error: str, now_ns: int) -> Stepped:
    running = station.fleet_return
    if running is None or running.planning_since_ns != job_id:
        return station, ()
    reason = f"its flight home could not be planned: {error}"
    return replace(station, fleet_return=_excluded(running, reason, now_ns)), ()


def _dropped(station: Station, job_id: int, _now_ns: int) -> Stepped:
    """Request the plan again with the next tick."""
    running = station.fleet_return
    if running is None or running.planning_since_ns != job_id:
        return station, ()
    return replace(station, fleet_return=replace(running, planning_since_ns=None)), ()


PLAN_RETURN: JobKind[ReturnPlanRequest, ReturnPlan] = JobKind(
    "plan_fleet_return", lambda _site: make_plan, _planned, _not_planned, _dropped
)
"""Plans layers, waves and landing missions for all vehicles that wait."""


PLAN_LASTS_S = 600.0
"""Time until a plan's last vehicle has landed: the gate must still accept the layers then."""


def _work(
    station: Station,
    running: FleetReturn,
    vehicles: list[CalledVehicle],
    settings: ReturnSettings,
    now_ns: int,
) -> ReturnPlanRequest:
    theirs = {member.serial for member in running.at(Stage.WAITING, *UNDER_WAY)}
    flying = in_the_air(station, running.frame)
    return ReturnPlanRequest(
        tuple(vehicles),
        tuple(other for key, other in flying.items() if key not in theirs),
        station.airspace.airspace,
        ground_up_m(station, vehicles),
        separation(station, settings, now_ns, PLAN_LASTS_S),
        settings,
        1 + max((_wave(member) for member in running.members.values()), default=0),
        tuple(each.flight.layer_up_m for each in running.at(*UNDER_WAY) if each.flight is not None),
    )


def _wave(member: ReturningVehicle) -> int:
    """Vehicles whose wave has begun keep it; those that wait are planned again."""
    is_waiting = member.stage is Stage.WAITING
    return 0 if member.flight is None or is_waiting else member.flight.wave


def _excluded(running: FleetReturn, reason: str, now_ns: int) -> FleetReturn:
    for member in running.at(Stage.WAITING):
        if member.flight is None:
            running = running.put(member.at(Stage.EXCLUDED, now_ns, reason))
    return replace(running, planning_since_ns=None)
