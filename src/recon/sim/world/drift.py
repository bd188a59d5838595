"""How far a layer has drifted: its velocity, which may turn at shifts, summed over time."""

from math import cos, radians, sin

import numpy as np

from recon.sim.world.keyframes import FloatArray
from recon.sim.world.settings import LayerSettings


def drift_m(layer: LayerSettings, time_s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return how far east and north the clouds have moved since time 0; before it: negative."""
    east_mps, north_mps = velocity(layer.speed_mps, layer.heading_deg)
    east_m, north_m = east_mps * time_s, north_mps * time_s
    for shift in layer.shifts:
        to_east, to_north = velocity(shift.speed_mps, shift.heading_deg)
        # The change comes in evenly: its integral is a parabola, then a straight line.
        during_s = np.clip(time_s - shift.start_s, 0.0, shift.duration_s)
        after_s = np.maximum(time_s - shift.start_s - shift.duration_s, 0.0)
        lasting_s = during_s * during_s / (2.0 * shift.duration_s) + after_s
        east_m = east_m + (to_east - east_mps) * lasting_s
        north_m = north_m + (to_north - north_mps) * lasting_s
        east_mps, north_mps = to_east, to_north
    return east_m, north_m


def velocity(speed_mps: float, heading_deg: float) -> tuple[float, float]:
    """Return the parts to the east and to the north."""
    heading = radians(heading_deg)
    return speed_mps * sin(heading), speed_mps * cos(heading)
