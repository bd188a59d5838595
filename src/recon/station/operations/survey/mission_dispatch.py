"""A survey's mission as an order, with an approach to its first row and an exit from its last.

Rows are flown at one height above takeoff, or above ground. A vehicle that crosses other rows at
that height, or hovers at the end of its own, comes too near to other vehicles, and the gate would
refuse their missions until it is gone. So each vehicle of a survey has heights of its own
(`approach_layers`): it flies to its first row at one of them, and climbs or sinks back to it after
the last row. A planner that gives the next mission at once leaves that out: then the vehicle flies
straight to a row that is near, where the gate sees room, and one that has to wait steps aside into
its layer.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from recon.geo.distance import horizontal_distance_m
from recon.guidance.survey import SurveyPlan
from recon.model.command import Hover, Refusal
from recon.model.control import AuthorityHolder
from recon.model.event import OperatorOrder
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.survey import MissionAssignment
from recon.model.vehicle import VehicleState
from recon.safety import judge
from recon.safety.datum import places_m, takeoff_up_m
from recon.safety.rules.height_zones import RULE as HEIGHT_ZONES
from recon.safety.rules.keep_out import RULE as KEEP_OUT
from recon.safety.rules.max_height import RULE as MAX_HEIGHT
from recon.safety.rules.min_height import RULE as MIN_HEIGHT
from recon.safety.rules.separation import RULE as SEPARATION
from recon.station.control.missions import body_for
from recon.station.control.situation_builder import command_of, situation
from recon.station.operations.survey.approach_layers import (
    layers_above_takeoff_m,
    layers_over_terrain_m,
)
from recon.station.state.station import Station
from recon.station.state.survey_record import SurveyRecord

OTHER_HEIGHT_RULES = frozenset({HEIGHT_ZONES, KEEP_OUT, MAX_HEIGHT, MIN_HEIGHT, SEPARATION})
"""Rules that another height of the approach may satisfy; others refuse every height."""

NEAR_M = 20.0
"""A vehicle this near to its first row, at its height, flies straight there."""

LEVEL_M = 3.0
"""Heights that differ by less count as the same: barometers are no better."""


NO_ROOM = Refusal(MAX_HEIGHT, "there is no other height to wait at below the site's ceiling")


@dataclass(frozen=True, slots=True)
class Dispatch:
    """The order for a mission, and words to add to a refusal by the gate; without number."""

    order: OperatorOrder
    tried: str = ""
    in_the_way: Refusal | None = None
    """Another vehicle is in its way at all its heights, or it has none: it is not ordered now."""
    is_takeoff: bool = False
    """The order is a takeoff alone; the mission is to be asked for again in the air."""


def dispatch(
    station: Station,
    record: SurveyRecord,
    given: MissionAssignment,
    vehicle: VehicleState,
    now_ns: int,
) -> Dispatch:
    """Return the order for a mission, judged beforehand by the gate's own rules.

    The first height is taken that neither a height rule nor another vehicle rules out. If height
    rules refuse all, the first is ordered, so that the gate's refusal is on record. A path that is
    steered begins in the air: its vehicle takes off first.
    """
    if vehicle.is_flying.value is False and not vehicle.flies_missions:
        return Dispatch(replace(_order(record, given, vehicle), body=Hover()), is_takeoff=True)
    straight = _straight(station, record, given, vehicle)
    if straight is not None and _refusal(station, straight, now_ns) is None:
        return Dispatch(straight)
    orders = _orders(station, record, given, vehicle)
    if not orders:
        return Dispatch(_order(record, given, vehicle), in_the_way=NO_ROOM)
    refusals: list[Refusal] = []
    for order in orders:
        refusal = _refusal(station, order, now_ns)
        if refusal is None or refusal.rule not in OTHER_HEIGHT_RULES:
            return Dispatch(order)
        refusals.append(refusal)
    tried = "; no other height of its approach is free" if len(orders) > 1 else ""
    near = next((each for each in refusals if each.rule == SEPARATION), None)
    return Dispatch(orders[0], tried, near)


def _straight(
    station: Station, record: SurveyRecord, given: MissionAssignment, vehicle: VehicleState
) -> OperatorOrder | None:
    """The order to fly its rows from where it is, at their height; None where that is too far."""
    here, height_m = vehicle.position.value, vehicle.height_above_takeoff_m.value
    within_m = given.straight_within_m
    if here is None or height_m is None or within_m is None or given.approach:
        return None
    first = given.mission.waypoints[0]
    far_m = horizontal_distance_m(here, LatLon(first.latitude_deg, first.longitude_deg))
    is_level = _is_at_rows_height(station, record, vehicle, here, height_m, first)
    if not is_level or far_m > within_m or given.stands_by:
        return None
    return replace(_order(record, given, vehicle), body=body_for(vehicle, given.mission))


def _is_at_rows_height(
    station: Station,
    record: SurveyRecord,
    vehicle: VehicleState,
    here: LatLon,
    height_m: float,
    first: Waypoint,
) -> bool:
    """Whether a vehicle is as high as rows are: at the first one, or above ground where it is."""
    plan, frame = _plan_of(record), station.airspace.airspace.frame
    if plan is None or plan.terrain is None or frame is None:
        return abs(height_m - first.height_above_takeoff_m) < LEVEL_M
    east_m, north_m = places_m(frame, [here])[0].tolist()
    takeoff_m = takeoff_up_m(station.airspace, vehicle)
    return plan.is_at_rows_height((east_m, north_m), height_m, takeoff_m)


def _plan_of(record: SurveyRecord) -> SurveyPlan | None:
    return None if record.state is None else record.state.plan


def _refusal(station: Station, order: OperatorOrder, now_ns: int) -> Refusal | None:
    command = command_of(station, order, now_ns)
    return judge(command, situation(station, command, now_ns))


def _orders(
    station: Station, record: SurveyRecord, given: MissionAssignment, vehicle: VehicleState
) -> tuple[OperatorOrder, ...]:
    """The order with each possible approach, the nearest of the vehicle's layers first."""
    layers_m = _own_layers_m(station, record, given, vehicle)
    if given.stands_by:
        missions = standing_by(given.mission, vehicle, layers_m, given.approach)
    else:
        ends_in_layer = len(record.members) > 1 and given.straight_within_m is None
        missions = with_approaches(
            given.mission, vehicle, layers_m, given.approach, ends_in_layer=ends_in_layer
        )
    order = _order(record, given, vehicle)
    return tuple(replace(order, body=body_for(vehicle, mission)) for mission in missions)


def _own_layers_m(
    station: Station, record: SurveyRecord, given: MissionAssignment, vehicle: VehicleState
) -> Sequence[float]:
    """The vehicle's own layers, metres above its takeoff point, at least one.

    Where none over terrain is free of ground and rows, it is the height of its first row: the gate
    judges.
    """
    number, count = tuple(record.members).index(given.serial), len(record.members)
    first, last = given.mission.waypoints[0], given.mission.waypoints[-1]
    plan, air = _plan_of(record), station.airspace
    frame, limits = air.airspace.frame, air.airspace.limits
    here, takeoff_m = vehicle.position.value, takeoff_up_m(air, vehicle)
    if plan is None or plan.terrain is None or frame is None or here is None or takeoff_m is None:
        return layers_above_takeoff_m(first.height_above_takeoff_m, number, count, limits)
    *path_m, end_m = places_m(frame, [here, *given.approach, first, last])
    up_m = layers_over_terrain_m(plan.terrain, air, np.array(path_m), end_m, number, count)
    layers_m = [round(each - takeoff_m, 2) for each in up_m]
    return layers_m or [first.height_above_takeoff_m]


def _order(record: SurveyRecord, given: MissionAssignment, vehicle: VehicleState) -> OperatorOrder:
    member = record.members[given.serial]
    return OperatorOrder(
        0,
        body_for(vehicle, given.mission),
        record.issuer,
        serial=given.serial,
        takeoff=member.may_take_off and vehicle.is_flying.value is False,
        role=AuthorityHolder.GUIDANCE,
    )


def standing_by(
    mission: Mission,
    vehicle: VehicleState,
    layers_m: Sequence[float],
    corners: tuple[LatLon, ...] = (),
) -> tuple[Mission, ...]:
    """Return the mission to the mission's first waypoint, in each of the vehicle's own layers.

    Where it is there already it climbs or sinks on the spot; none where there is no other height.
    """
    here, height_m = vehicle.position.value, vehicle.height_above_takeoff_m.value
    first = replace(mission.waypoints[0], gimbal_pitch_deg=None)
    if here is None or height_m is None:
        return (replace(mission, waypoints=(first,)),)
    far_m = horizontal_distance_m(here, LatLon(first.latitude_deg, first.longitude_deg))
    is_there = far_m < NEAR_M and abs(height_m - first.height_above_takeoff_m) < LEVEL_M
    flown = []
    for layer_m in layers_m:
        if is_there and abs(layer_m - first.height_above_takeoff_m) < LEVEL_M:
            continue
        there = replace(first, height_above_takeoff_m=layer_m)
        begins = _turns(there, (here, *corners)) if not is_there else (first,)
        flown.append(replace(mission, waypoints=(*begins, there)))
    return tuple(dict.fromkeys(flown))


def _turns(waypoint: Waypoint, places: Iterable[LatLon]) -> tuple[Waypoint, ...]:
    """Return the waypoint at each of several places."""
    return tuple(
        replace(waypoint, latitude_deg=place.latitude_deg, longitude_deg=place.longitude_deg)
        for place in places
    )


def with_approaches(
    mission: Mission,
    vehicle: VehicleState,
    layers_m: Sequence[float],
    corners: tuple[LatLon, ...] = (),
    *,
    ends_in_layer: bool = True,
) -> tuple[Mission, ...]:
    """Return the mission with an approach in each of the vehicle's own layers: straight up or down,
    across, onto the first row; and off the last row to the same height, if it `ends_in_layer`.

    The path across turns at `corners`; zones are left to the gate.
    """
    flown = tuple(_with_approach(mission, vehicle, layer_m, corners) for layer_m in layers_m)
    if ends_in_layer:
        flown = tuple(
            _with_end(each, layer_m) for each, layer_m in zip(flown, layers_m, strict=True)
        )
    return tuple(dict.fromkeys(flown))


def _with_approach(
    mission: Mission, vehicle: VehicleState, layer_m: float, corners: tuple[LatLon, ...]
) -> Mission:
    here, height_m = vehicle.position.value, vehicle.height_above_takeoff_m.value
    if here is None or height_m is None:
        return mission
    first = mission.waypoints[0]
    far_m = horizontal_distance_m(here, LatLon(first.latitude_deg, first.longitude_deg))
    is_level = abs(height_m - first.height_above_takeoff_m) < LEVEL_M
    is_near = far_m < NEAR_M and not corners
    if is_near and (is_level or far_m < 1.0):
        return mission
    plain = replace(first, gimbal_pitch_deg=None)
    above, *turns = _turns(plain, (here, *corners))
    if is_near:
        return replace(mission, waypoints=(above, *mission.waypoints))
    path = (above, *turns, plain)
    approach = (replace(each, height_above_takeoff_m=layer_m) for each in path)
    return replace(mission, waypoints=(*approach, *mission.waypoints))


def _with_end(mission: Mission, layer_m: float) -> Mission:
    """Leave the rows' height at the end, so that the vehicle does not hover in others' rows."""
    last = mission.waypoints[-1]
    if abs(layer_m - last.height_above_takeoff_m) < LEVEL_M:
        return mission
    end = replace(last, height_above_takeoff_m=layer_m, gimbal_pitch_deg=None)
    return replace(mission, waypoints=(*mission.waypoints, end))
