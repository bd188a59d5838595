"""Where each vehicle can be within the horizon at most: asked before anything is predicted.

Theory of operation. Prediction (`look_ahead`) is the most expensive part of a watchdog run, and
nearly always shows that nothing comes near. A `Reach` bounds it without predicting: a vehicle stays
in the circle that its fastest speed allows, and between the lowest and the highest of its own and
its commanded heights, vertical speed included. Trajectories are predicted only if two bounds come
nearer than the minima, or one is not clear of the boundary, a zone or the height limits.

    all bounds clear             -> no findings
    one not clear, or unbounded  -> predict and sample, as if there were no bounds

A vehicle that returns, lands, flies a curved mission, or whose mission is unknown has no bound.
`tests/safety/watchdogs/test_reach.py` compares the findings with and without the bounds.
"""

from typing import NamedTuple

from recon.model.control import Commanded, Intent
from recon.safety.prediction import PredictionSettings, VehicleMotion
from recon.safety.prediction.legs import LEAST_M, VERTICAL_BRAKING_MPS2

SLOWEST_MPS = 1.0
"""Legs shorter than `LEAST_M` are predicted as flown in `LEAST_S`: this fast."""

ROUNDING_M = 0.01


class Reach(NamedTuple):
    """The bound on one vehicle: its place in the plane, its fastest speed, its band of heights.

    `slack_m` holds rounding, and the phases of legs that are too short to be predicted.
    """

    east_m: float
    north_m: float
    low_m: float
    high_m: float
    fastest_mps: float
    age_s: float
    slack_m: float

    def radius_m(self, seconds: float) -> float:
        """Return how far from its last place it comes until so many seconds from now."""
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
        low_m, high_m = min(low_m, band_m[0]), max(high_m, band_m[1])
    # A stick that climbs or sinks may do so from its commanded height on.
    return Reach(
        motion.east_m,
        motion.north_m,
        low_m - change_m,
        high_m + change_m,
        fastest_mps,
        motion.age_s,
        slack_m,
    )
