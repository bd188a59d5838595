"""The ways to the first row and off the last: each vehicle of a survey has a height of its own.

All rows are flown at one height. A vehicle on its way to them would come too near to others there,
and one that waited at the end of its own would keep them from theirs: the gate would refuse them
until it is gone. So it flies to them in its own layer, and climbs or sinks back to that at the end.
"""

from dataclasses import replace

from recon.geo.distance import horizontal_distance_m
from recon.model.airspace import FlightLimits
from recon.model.geo import LatLon
from recon.model.mission import Mission
from recon.model.vehicle import VehicleState

LAYER_M = 8.0
"""Between two ways: the fleet return's layers are as far apart."""

SPARE_M = 5.0
"""Under the site's ceiling: the ground under a way may lie higher than the takeoff point."""

LOWEST_M = 20.0
"""No way is lower: trees and buildings are in a zone, or lower than this."""

NEAR_M = 20.0
"""A vehicle this near to its first row, at its height, flies there as it is."""

LEVEL_M = 3.0
"""Apart by less in height counts as level: barometers are no better."""


def with_approach(
    mission: Mission, vehicle: VehicleState, number: int, count: int, limits: FlightLimits
) -> Mission:
    """Return the mission with its ways at the first height that is the vehicle's.

    `number` counts the survey's `count` vehicles from 0; too many for the room share the last
    height.
    """
    return with_approaches(mission, vehicle, number, count, limits)[0]


def with_approaches(
    mission: Mission, vehicle: VehicleState, number: int, count: int, limits: FlightLimits
) -> tuple[Mission, ...]:
    """Return the mission with each way to it: straight up or down, across, onto the first row; and
    off the last row to the same height.

    One for each height that is the vehicle's, the nearest to the rows first: no height is that of
    two of the survey's `count` vehicles, while there is room. Zones are not looked at.
    """
    rows_m = mission.waypoints[0].height_above_takeoff_m
    layers_m = _layers_m(rows_m, limits)
    own_m = layers_m[number::count] or layers_m[-1:]
    ways = tuple(_with_way(mission, vehicle, layer_m) for layer_m in own_m)
    if count > 1:
        ways = tuple(_with_end(way, layer_m) for way, layer_m in zip(ways, own_m, strict=True))
    return tuple(dict.fromkeys(ways))


def _with_way(mission: Mission, vehicle: VehicleState, layer_m: float) -> Mission:
    here, height_m = vehicle.position.value, vehicle.height_above_takeoff_m.value
    if here is None or height_m is None:
        return mission
    first = mission.waypoints[0]
    far_m = horizontal_distance_m(here, LatLon(first.latitude_deg, first.longitude_deg))
    is_level = abs(height_m - first.height_above_takeoff_m) < LEVEL_M
    if far_m < NEAR_M and (is_level or far_m < 1.0):
        return mission
    plain = replace(first, gimbal_pitch_deg=None)
    above = replace(plain, latitude_deg=here.latitude_deg, longitude_deg=here.longitude_deg)
    if far_m < NEAR_M:
        return replace(mission, waypoints=(above, *mission.waypoints))
    way = (replace(each, height_above_takeoff_m=layer_m) for each in (above, plain))
    return replace(mission, waypoints=(*way, *mission.waypoints))


def _with_end(mission: Mission, layer_m: float) -> Mission:
    """A lone vehicle is in nobody's way; where there is no room for layers, nor is there an end."""
    last = mission.waypoints[-1]
    if abs(layer_m - last.height_above_takeoff_m) < LEVEL_M:
        return mission
    end = replace(last, height_above_takeoff_m=layer_m, gimbal_pitch_deg=None)
    return replace(mission, waypoints=(*mission.waypoints, end))


def _layers_m(rows_m: float, limits: FlightLimits) -> list[float]:
    """The heights of ways: above the rows, below, and so on; without room the rows' own."""
    ceiling_m = limits.max_height_above_ground_m - SPARE_M
    steps = range(1, 1 + int(max(ceiling_m, rows_m) // LAYER_M))
    outwards = [rows_m + sign * step * LAYER_M for step in steps for sign in (1.0, -1.0)]
    return [height_m for height_m in outwards if LOWEST_M <= height_m <= ceiling_m] or [rows_m]
