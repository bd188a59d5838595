"""The way to the first row: each vehicle of a survey flies it at a height of its own.

All rows are flown at one height. A vehicle on its way to them, or past another one that hovers at
the end of its own, would come too near to it there; the gate would refuse it until the other one is
gone.
"""

from dataclasses import replace

from recon.geo.distance import horizontal_distance_m
from recon.model.airspace import FlightLimits
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
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
    mission: Mission, vehicle: VehicleState, number: int, limits: FlightLimits
) -> Mission:
    """Return the mission with the way to it at the first height that is the vehicle's.

    `number` counts the survey's vehicles from 0; too many for the room share the last height.
    """
    return with_approaches(mission, vehicle, number, number + 1, limits)[0]


def with_approaches(
    mission: Mission, vehicle: VehicleState, number: int, count: int, limits: FlightLimits
) -> tuple[Mission, ...]:
    """Return the mission with each way to it: straight up or down, across, onto the first row.

    One for each height that is the vehicle's, the nearest to the rows first: no height is that of
    two of the survey's `count` vehicles, while there is room. Zones are not looked at.
    """
    here, height_m = vehicle.position.value, vehicle.height_above_takeoff_m.value
    if here is None or height_m is None:
        return (mission,)
    first = mission.waypoints[0]
    rows_m = first.height_above_takeoff_m
    far_m = horizontal_distance_m(here, LatLon(first.latitude_deg, first.longitude_deg))
    if far_m < NEAR_M and (abs(height_m - rows_m) < LEVEL_M or far_m < 1.0):
        return (mission,)
    plain = replace(first, gimbal_pitch_deg=None)
    above = replace(plain, latitude_deg=here.latitude_deg, longitude_deg=here.longitude_deg)
    if far_m < NEAR_M:
        return (replace(mission, waypoints=(above, *mission.waypoints)),)
    layers_m = _layers_m(rows_m, limits)
    own_m = layers_m[number::count] or layers_m[-1:]
    return tuple(_over(mission, above, plain, layer_m) for layer_m in own_m)


def _over(mission: Mission, above: Waypoint, first: Waypoint, layer_m: float) -> Mission:
    way = tuple(replace(each, height_above_takeoff_m=layer_m) for each in (above, first))
    return replace(mission, waypoints=(*way, *mission.waypoints))


def _layers_m(rows_m: float, limits: FlightLimits) -> list[float]:
    """The heights of ways: above the rows, below, and so on; without room the rows' own."""
    ceiling_m = limits.max_height_above_ground_m - SPARE_M
    steps = range(1, 1 + int(max(ceiling_m, rows_m) // LAYER_M))
    outwards = [rows_m + sign * step * LAYER_M for step in steps for sign in (1.0, -1.0)]
    return [height_m for height_m in outwards if LOWEST_M <= height_m <= ceiling_m] or [rows_m]
