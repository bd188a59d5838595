"""Whether a vehicle without telemetry can have landed since its last report.

A hover on the ground makes apps in the field take off. As long as no aircraft could have come down
to the ground, that cannot happen, and a stop needs no newer telemetry (decisions on the ICD, 16 a).
"""

from typing import Final

import numpy as np

from recon.model.units import ns_to_seconds
from recon.model.vehicle import VehicleState
from recon.safety.datum import is_ground_assumed_flat, vehicle_enu_m
from recon.safety.situation import Situation

AROUND_UNIT_CIRCLE: Final = np.array([[(0.0, 2.0), (-np.sqrt(3.0), -1.0), (np.sqrt(3.0), -1.0)]])
"""A triangle (1, 3, 2), east and north, with the circle of radius 1 in it."""


def cannot_have_landed(situation: Situation) -> bool:
    """Return whether the fastest descent from the last reported height takes longer than its age.

    Unknown height, flight or ground, and two links that claim the serial: it may have landed.
    """
    vehicle, limits = situation.vehicle, situation.settings.blind_stop
    if vehicle is None or vehicle.is_flying.value is not True:
        return False
    reported_ns = vehicle.height_above_takeoff_m.received_at_ns
    if reported_ns is None or len(situation.claiming_links) != 1:
        return False
    age_s = ns_to_seconds(situation.now_ns - reported_ns)
    height_m = _height_above_ground_m(vehicle, situation, limits.fastest_mps * age_s)
    if height_m is None:
        return False
    return age_s * limits.fastest_descent_mps < height_m - limits.height_error_m


def _height_above_ground_m(
    vehicle: VehicleState, situation: Situation, reach_m: float
) -> float | None:
    """The last reported height above the highest ground that it may have come over since."""
    airspace = situation.airspace
    if is_ground_assumed_flat(airspace):
        return vehicle.height_above_takeoff_m.value
    place_m = vehicle_enu_m(airspace, vehicle)
    if place_m is None:
        return None
    east_m, north_m, up_m = place_m
    triangle_m = np.array([east_m, north_m]) + reach_m * AROUND_UNIT_CIRCLE
    _, highest_m = airspace.ground_within_up_m(triangle_m)
    return float(up_m - highest_m[0])
