"""The hazard area of a vehicle with lost telemetry: everywhere it may be.

It is somewhere in a circle about its last place, or returning home. The circle grows with its last
plausible speed and reaches down to the ground, for its battery ends somewhere.
"""

from dataclasses import dataclass

from recon.model.control import Commanded, Intent
from recon.safety.prediction.legs import stopping_distance_m
from recon.safety.prediction.motion import VehicleMotion
from recon.safety.prediction.predictor import go_home_top_m
from recon.safety.prediction.trajectory import (
    ALL_HEIGHTS_M,
    FOREVER_S,
    FlightPart,
    Trajectory,
    TrajectoryWriter,
)
from recon.safety.prediction_settings import PredictionSettings

LONGEST_RISE_S = 10.0
"""Longest time that a climb under way is assumed to continue."""


@dataclass(frozen=True, slots=True)
class HazardArea:
    """Where a stale vehicle may be, in the plane; heights are bands of up metres.

    `radius_m` is now's, and grows by `growth_mps` up to `largest_m`. `home_m` ends its corridor,
    None when it is not expected to go home, or its home is unknown.
    """

    name: str
    age_s: float
    east_m: float
    north_m: float
    radius_m: float
    growth_mps: float
    largest_m: float
    low_m: float
    high_m: float
    home_m: tuple[float, float] | None
    corridor_low_m: float
    corridor_half_m: float


def hazard_area_of(
    motion: VehicleMotion, intent: Intent, settings: PredictionSettings
) -> HazardArea | None:
    """Return the hazard area of a vehicle with lost telemetry; None while it is in contact."""
    if motion.age_s <= settings.stale_s:
        return None
    growth_mps = max(_plausible_mps(motion, intent), settings.hazard_least_speed_mps)
    largest_m = max(settings.hazard_radius_m, stopping_distance_m(growth_mps, settings))
    rise_m = max(0.0, motion.velocity_mps[2]) * min(motion.age_s, LONGEST_RISE_S)
    top_m = motion.high_m + rise_m
    if motion.goes_home:
        top_m = max(top_m, go_home_top_m(motion, settings))
    return HazardArea(
        name=motion.name,
        age_s=motion.age_s,
        east_m=motion.east_m,
        north_m=motion.north_m,
        radius_m=min(largest_m, growth_mps * motion.age_s),
        growth_mps=growth_mps,
        largest_m=largest_m,
        low_m=-ALL_HEIGHTS_M,
        high_m=top_m + motion.drift_m,
        home_m=motion.home_m if motion.goes_home else None,
        corridor_low_m=motion.low_m - motion.drift_m,
        corridor_half_m=settings.corridor_m,
    )


def hazard_trajectories(hazard: HazardArea) -> tuple[Trajectory, ...]:
    """Return the hazard area's volumes as trajectories: the circle, the route home, the landing."""
    circle = TrajectoryWriter(hazard.east_m, hazard.north_m, hazard.low_m, hazard.high_m)
    circle.radius_m = hazard.radius_m
    if hazard.radius_m < hazard.largest_m:
        grows_s = (hazard.largest_m - hazard.radius_m) / hazard.growth_mps
        circle.grows(hazard.largest_m, grows_s, FlightPart.HAZARD)
    circle.stays(FlightPart.HAZARD)
    writers = [circle]
    if hazard.home_m is not None:
        path = TrajectoryWriter(hazard.east_m, hazard.north_m, hazard.corridor_low_m, hazard.high_m)
        path.radius_m = hazard.corridor_half_m
        path.moves(*hazard.home_m, FOREVER_S, FlightPart.HAZARD)
        landing = TrajectoryWriter(*hazard.home_m, hazard.low_m, hazard.high_m)
        landing.radius_m = hazard.corridor_half_m
        landing.stays(FlightPart.HAZARD)
        writers += [path, landing]
    return tuple(writer.trajectory(hazard.name) for writer in writers)


def _plausible_mps(motion: VehicleMotion, intent: Intent) -> float:
    """Return its last speed, or the commanded one when that is higher."""
    commanded_mps = 0.0
    if intent.commanded is Commanded.MISSION and intent.mission is not None:
        commanded_mps = max(w.speed_mps for w in intent.mission.waypoints)
    elif intent.commanded is Commanded.STICK:
        commanded_mps = intent.speed_mps or 0.0
    return max(motion.speed_mps, commanded_mps)
