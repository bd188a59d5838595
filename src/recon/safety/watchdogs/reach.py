"""Where each vehicle can be within the horizon at most: asked before anything is predicted.

Theory of operation. Prediction (`look_ahead`) is the most expensive part of a watchdog run, and
nearly always shows that nothing comes near. A `Reach` bounds it without predicting: a vehicle stays
in the circle that its fastest speed allows, and between the lowest and the highest of its own and
its commanded heights, vertical speed included. A trajectory is predicted only if the vehicle's
bound comes nearer to another's than the minima (`near_each_other`), or is not clear of the
boundary, a zone or the height limits (`near_limits`).

    a bound is clear               -> no findings about this vehicle
    not clear                      -> predict and sample this vehicle
    a vehicle unbounded, or lost   -> predict and sample all

A vehicle that returns, lands, flies a curved mission, or whose mission is unknown has no bound.
`tests/safety/watchdogs/test_reach.py` compares the findings with and without the bounds.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from recon.geo import TangentPlane, tangent_plane
from recon.model.airspace import ZoneKind
from recon.model.arrays import BoolArray
from recon.model.control import Commanded, Intent
from recon.model.geo import LatLon, LocalFrame
from recon.model.vehicle import VehicleState
from recon.safety.airspace import Cylinder, PreparedAirspace
from recon.safety.heights import stays_above, stays_below
from recon.safety.prediction import PredictionSettings, VehicleMotion
from recon.safety.prediction.legs import LEAST_M, VERTICAL_BRAKING_MPS2
from recon.safety.prediction.motion import last_place
from recon.safety.separation_minima import SeparationMinima
from recon.safety.settings import WatchdogSettings

SLOWEST_MPS = 1.0
"""Legs shorter than `LEAST_M` are predicted as flown in `LEAST_S`: this fast."""

ROUNDING_M = 0.01

_ROUND_CIRCLE = np.array([(-1.0, -1.0), (3.0, -1.0), (-1.0, 3.0)])
"""A triangle around the square around the unit circle."""


class Reach(NamedTuple):
    """The bound on one vehicle: its place, on earth and in the plane, its fastest speed, its band
    of heights.

    `slack_m` holds rounding, and the phases of legs that are too short to be predicted.
    """

    place: LatLon
    east_m: float
    north_m: float
    low_m: float
    high_m: float
    fastest_mps: float
    age_s: float
    slack_m: float
    drift_m: float = 0.0
    """Drift added to its band of heights where vehicles are compared."""

    def radius_m(self, seconds: float) -> float:
        """Return how far from its last place it comes until `seconds` from now."""
        return self.fastest_mps * (self.age_s + seconds) + self.slack_m


def reach_of(
    motion: VehicleMotion, intent: Intent, horizon_s: float, prediction: PredictionSettings
) -> Reach | None:
    """Return the bound on what `next_rows` predicts for a vehicle; None without one.

    It holds whether the vehicle flies as commanded, brakes, or goes straight on.
    """
    mission = intent.mission
    is_mission = intent.commanded is Commanded.MISSION
    if intent.commanded in (Commanded.LAND, Commanded.RETURN) or is_mission is (mission is None):
        return None
    fastest_mps, slack_m = max(motion.speed_mps, SLOWEST_MPS), ROUNDING_M
    lasts_s = max(horizon_s, prediction.stick_horizon_s, prediction.reaction_s) + motion.age_s
    up_mps = abs(motion.velocity_mps[2])
    change_m = up_mps * lasts_s + up_mps**2 / (2.0 * VERTICAL_BRAKING_MPS2) + ROUNDING_M
    low_m, high_m = motion.low_m, motion.high_m
    heights_m: tuple[float, ...] = ()
    if mission is not None:
        if mission.curved or mission.land_at_end:
            return None
        fastest_mps = max(fastest_mps, mission.bounds[0])
        heights_m = mission.bounds[1:]
        slack_m += 3.0 * LEAST_M * len(mission.waypoints)
    elif intent.target_height_above_takeoff_m is not None:
        heights_m = (intent.target_height_above_takeoff_m,)
    if intent.commanded is Commanded.STICK:
        fastest_mps = max(fastest_mps, intent.speed_mps or prediction.go_home_speed_mps)
    for height_m in heights_m:
        band_m = motion.up_m(height_m)
        low_m, high_m = min(low_m, *band_m), max(high_m, *band_m)
    # A stick that climbs or sinks may do so from its commanded height on.
    return Reach(
        last_known_place(motion.state),
        motion.east_m,
        motion.north_m,
        low_m - change_m,
        high_m + change_m,
        fastest_mps,
        motion.age_s,
        slack_m,
        motion.drift_m,
    )


def last_known_place(vehicle: VehicleState) -> LatLon:
    """Return the last position of a vehicle that has one, as each with a motion has."""
    place, _at_ns = last_place(vehicle)
    assert place is not None
    return place


def near_each_other(
    reaches: Sequence[Reach],
    need: SeparationMinima,
    horizon_s: float,
    unknown: BoolArray | None = None,
) -> set[int]:
    """Return which vehicles can come nearer to another than the minima within the horizon.

    What is not finite is near to all. Heights of pairs in `unknown` (V, V) say nothing.
    """
    if len(reaches) < 2:
        return set()
    bounds_m = np.array(
        [
            (r.east_m, r.north_m, r.low_m - r.drift_m, r.high_m + r.drift_m, r.radius_m(horizon_s))
            for r in reaches
        ]
    )
    east_m, north_m, low_m, high_m, radius_m = bounds_m.T[:, :, np.newaxis]
    apart_m = np.hypot(east_m - east_m.T, north_m - north_m.T)
    is_clear = apart_m >= need.horizontal_m + (radius_m + radius_m.T)
    is_above = low_m - high_m.T >= need.vertical_m
    is_above |= is_above.T
    is_clear |= is_above if unknown is None else is_above & ~unknown
    is_clear.flat[:: len(reaches) + 1] = True  # each of itself
    return set(np.flatnonzero(~is_clear.all(axis=1)).tolist())


def near_limits(
    reaches: Sequence[Reach],
    airspace: PreparedAirspace,
    frame: LocalFrame,
    settings: WatchdogSettings,
    prediction: PredictionSettings,
) -> set[int]:
    """Return which vehicles can reach a fence or a height limit in their path ahead.

    The path ahead ends at most one sample later than its time. Most vehicles are cleared by plain
    comparisons of numbers; only the rest are asked of the polygon and the ground.
    """
    plane, height_m = tangent_plane(frame), frame.origin.ellipsoid_height_m
    cylinders = {
        number: _cylinder(
            reach,
            path_ahead_s(reach.fastest_mps, settings, prediction) + settings.sample_s,
            plane,
            height_m,
        )
        for number, reach in enumerate(reaches)
    }
    kinds = ZoneKind.KEEP_OUT, ZoneKind.HEIGHT
    near = {
        number for number, cylinder in cylinders.items() if airspace.may_touch_zone(kinds, cylinder)
    }
    return near | _may_leave(airspace, cylinders) | _may_break_heights(airspace, cylinders)


def path_ahead_s(
    speed_mps: float, settings: WatchdogSettings, prediction: PredictionSettings
) -> float:
    """Return the time of the path ahead of a vehicle at this speed: in it fences are looked for."""
    stop_s = prediction.reaction_s + speed_mps / (2.0 * prediction.braking_mps2)
    return min(settings.fence_factor * stop_s, settings.horizon_s)


def _cylinder(reach: Reach, seconds: float, plane: TangentPlane, height_m: float) -> Cylinder:
    """Return what a vehicle can reach in `seconds`, in the site's frame, at its origin's height."""
    place = reach.place
    east_m, north_m, _up_m = plane.enu_m(place.latitude_deg, place.longitude_deg, height_m)
    return Cylinder(east_m, north_m, reach.radius_m(seconds), reach.low_m, reach.high_m)


def _may_leave(airspace: PreparedAirspace, cylinders: Mapping[int, Cylinder]) -> set[int]:
    fence = airspace.boundary
    if fence is None:
        return set()
    asked = {
        number: cylinder
        for number, cylinder in cylinders.items()
        if not fence.has_circle_in_the_middle(*cylinder[:3])
    }
    if not asked:
        return set()
    east_m, north_m, far_m, _low_m, _high_m = np.array(list(asked.values())).T
    is_inside = fence.distance_to_edge_m(np.stack([east_m, north_m], axis=1)) > far_m
    return _numbers(asked, ~is_inside)


def _may_break_heights(airspace: PreparedAirspace, cylinders: Mapping[int, Cylinder]) -> set[int]:
    limits = airspace.airspace.limits
    asked = {
        number: cylinder
        for number, cylinder in cylinders.items()
        if not airspace.is_surely_between_heights(cylinder)
    }
    if not asked:
        return set()
    east_m, north_m, far_m, low_m, high_m = np.array(list(asked.values())).T
    middles_m = np.stack([east_m, north_m], axis=1)[:, np.newaxis]
    triangles_m = far_m[:, np.newaxis, np.newaxis] * _ROUND_CIRCLE + middles_m
    clear = stays_above(airspace, triangles_m, low_m, limits.min_height_above_ground_m)
    clear &= stays_below(airspace, triangles_m, high_m, limits.max_height_above_ground_m)
    return _numbers(asked, ~clear)


def _numbers(asked: Mapping[int, Cylinder], which: BoolArray) -> set[int]:
    return set(np.array(list(asked))[which].tolist())
