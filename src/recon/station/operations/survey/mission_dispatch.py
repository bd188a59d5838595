"""A survey's mission as an order, with an approach to its first row and an exit from its last.

All rows are flown at one height. A vehicle that crosses other rows at that height, or hovers at the
end of its own, comes too near to other vehicles, and the gate would refuse their missions until it
is gone. So each vehicle of a survey has heights of its own: it flies to its first row at one of
them, and climbs or sinks back to it after the last row. A planner that gives the next mission at
once leaves that out: then the vehicle flies straight to a row that is near, where the gate sees
room, and one that has to wait steps aside into its layer.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from recon.geo.distance import horizontal_distance_m
from recon.model.airspace import FlightLimits
from recon.model.command import FlyMission, Refusal
from recon.model.control import AuthorityHolder
from recon.model.event import OperatorOrder
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.survey import MissionAssignment
from recon.model.vehicle import VehicleState
from recon.safety import judge
from recon.safety.rules.height_zones import RULE as HEIGHT_ZONES
from recon.safety.rules.keep_out import RULE as KEEP_OUT
from recon.safety.rules.max_height import RULE as MAX_HEIGHT
from recon.safety.rules.min_height import RULE as MIN_HEIGHT
from recon.safety.rules.separation import RULE as SEPARATION
from recon.station.control.situation_builder import command_of, situation
from recon.station.state.station import Station
from recon.station.state.survey_record import SurveyRecord

OTHER_HEIGHT_RULES = frozenset({HEIGHT_ZONES, KEEP_OUT, MAX_HEIGHT, MIN_HEIGHT, SEPARATION})
"""Rules that another height of the approach may satisfy; others refuse every height."""

LAYER_M = 8.0
"""Between two approach heights: the same as between two layers of a fleet return."""

SPARE_M = 5.0
"""Under the site's ceiling: the ground under an approach may lie higher than the takeoff point."""

LOWEST_M = 20.0
"""No approach is lower: trees and buildings are in a zone, or lower than this."""

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


def dispatch(
    station: Station,
    record: SurveyRecord,
    given: MissionAssignment,
    vehicle: VehicleState,
    now_ns: int,
) -> Dispatch:
    """Return the order for a mission, judged beforehand by the gate's own rules.

    The first height is taken that neither a height rule nor another vehicle rules out. If height
    rules refuse all, the first is ordered, so that the gate's refusal is on record.
    """
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
    is_level = abs(height_m - first.height_above_takeoff_m) < LEVEL_M
    if not is_level or far_m > within_m or given.stands_by:
        return None
    return replace(_order(record, given, vehicle), body=FlyMission(given.mission))


def _refusal(station: Station, order: OperatorOrder, now_ns: int) -> Refusal | None:
    command = command_of(station, order, now_ns)
    return judge(command, situation(station, command, now_ns))


def _orders(
    station: Station, record: SurveyRecord, given: MissionAssignment, vehicle: VehicleState
) -> tuple[OperatorOrder, ...]:
    number, count = tuple(record.members).index(given.serial), len(record.members)
    limits = station.airspace.airspace.limits
    order = _order(record, given, vehicle)
    if given.stands_by:
        missions = standing_by(given.mission, vehicle, number, count, limits, given.approach)
    else:
        missions = with_approaches(
            given.mission,
            vehicle,
            number,
            count,
            limits,
            given.approach,
            ends_in_layer=given.straight_within_m is None,
        )
    return tuple(replace(order, body=FlyMission(mission)) for mission in missions)


def _order(record: SurveyRecord, given: MissionAssignment, vehicle: VehicleState) -> OperatorOrder:
    member = record.members[given.serial]
    return OperatorOrder(
        0,
        FlyMission(given.mission),
        f"{record.started_by}: survey {record.survey.name}",
        serial=given.serial,
        takeoff=member.may_take_off and vehicle.is_flying.value is False,
        role=AuthorityHolder.GUIDANCE,
    )


def standing_by(
    mission: Mission,
    vehicle: VehicleState,
    number: int,
    count: int,
    limits: FlightLimits,
    corners: tuple[LatLon, ...] = (),
) -> tuple[Mission, ...]:
    """Return the mission to the mission's first waypoint, at each of the vehicle's own heights.

    Where it is there already it climbs or sinks on the spot; none where there is no other height.
    """
    here, height_m = vehicle.position.value, vehicle.height_above_takeoff_m.value
    first = replace(mission.waypoints[0], gimbal_pitch_deg=None)
    if here is None or height_m is None:
        return (replace(mission, waypoints=(first,)),)
    far_m = horizontal_distance_m(here, LatLon(first.latitude_deg, first.longitude_deg))
    is_there = far_m < NEAR_M and abs(height_m - first.height_above_takeoff_m) < LEVEL_M
    flown = []
    for layer_m in _own_layers_m(first.height_above_takeoff_m, number, count, limits):
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
    number: int,
    count: int,
    limits: FlightLimits,
    corners: tuple[LatLon, ...] = (),
    *,
    ends_in_layer: bool = True,
) -> tuple[Mission, ...]:
    """Return the mission with each possible approach: straight up or down, across, onto the first
    row; and off the last row to the same height, if it `ends_in_layer`.

    One for each of the vehicle's heights, the nearest to the rows first. `number` counts the
    survey's `count` vehicles from 0: no two share a height, as long as there are enough; beyond,
    they share the last one. The way across turns at `corners`; zones are left to the gate.
    """
    rows_m = mission.waypoints[0].height_above_takeoff_m
    own_m = _own_layers_m(rows_m, number, count, limits)
    flown = tuple(_with_approach(mission, vehicle, layer_m, corners) for layer_m in own_m)
    if count > 1 and ends_in_layer:
        flown = tuple(_with_end(each, layer_m) for each, layer_m in zip(flown, own_m, strict=True))
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
    way = (above, *turns, plain)
    approach = (replace(each, height_above_takeoff_m=layer_m) for each in way)
    return replace(mission, waypoints=(*approach, *mission.waypoints))


def _with_end(mission: Mission, layer_m: float) -> Mission:
    """Leave the rows' height at the end, so that the vehicle does not hover in others' rows."""
    last = mission.waypoints[-1]
    if abs(layer_m - last.height_above_takeoff_m) < LEVEL_M:
        return mission
    end = replace(last, height_above_takeoff_m=layer_m, gimbal_pitch_deg=None)
    return replace(mission, waypoints=(*mission.waypoints, end))


def _own_layers_m(rows_m: float, number: int, count: int, limits: FlightLimits) -> list[float]:
    layers_m = _layers_m(rows_m, limits)
    return layers_m[number::count] or layers_m[-1:]


def _layers_m(rows_m: float, limits: FlightLimits) -> list[float]:
    """The heights of approaches: above the rows, below, and so on; without room the rows' own."""
    ceiling_m = limits.max_height_above_ground_m - SPARE_M
    steps = range(1, 1 + int(max(ceiling_m, rows_m) // LAYER_M))
    outwards = [rows_m + sign * step * LAYER_M for step in steps for sign in (1.0, -1.0)]
    return [height_m for height_m in outwards if LOWEST_M <= height_m <= ceiling_m] or [rows_m]
