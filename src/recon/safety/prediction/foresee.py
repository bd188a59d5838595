"""Courses of a whole situation: the order's own, and the traffic's."""

from dataclasses import dataclass, replace
from math import hypot

import numpy as np

from recon.model.command import Body, FlyMission
from recon.model.intent import Commanded, Intent
from recon.safety.prediction.course import (
    ALL_HEIGHTS_M,
    EAST_0,
    EAST_1,
    END_S,
    HIGH_0,
    HIGH_1,
    LOW_0,
    LOW_1,
    NORTH_0,
    NORTH_1,
    RADIUS_0,
    RADIUS_1,
    Course,
)
from recon.safety.prediction.flyer import Flyer
from recon.safety.prediction.hazard_area import hazard_area_of, hazard_courses
from recon.safety.prediction.intents import UNHOMED_RADIUS_M, Follower
from recon.safety.prediction.legs import STANDING_MPS, stopping_distance_m
from recon.safety.prediction.orders import write_order
from recon.safety.separation_minima import SeparationMinima
from recon.safety.settings import PredictionSettings

ROUNDING_M = 1e-6


def foresee_order(flyer: Flyer, body: Body, settings: PredictionSettings) -> Course:
    """Return the course an order to move would send its vehicle on."""
    follower = Follower(flyer, settings)
    write_order(follower, body)
    course = follower.writer.course(flyer.name, flyer.state.serial)
    may_wait = isinstance(body, FlyMission)
    return replace(course, delay_s=settings.start_delay_s) if may_wait else course


def foresee_traffic(
    flyer: Flyer, intent: Intent, settings: PredictionSettings, until_s: float
) -> tuple[Course, ...]:
    """Return what others must keep clear of: a vehicle's course; of a stale one, its hazard area
    too.

    The hazard area does not replace the course: an app that loses the station flies its mission on.
    A mission that has not begun may begin late, as one under judgement may.
    """
    hazard = hazard_area_of(flyer, intent, settings)
    volumes = () if hazard is None else hazard_courses(hazard)
    if hazard is not None and intent.commanded is not Commanded.MISSION:
        return volumes
    follower = Follower(flyer, settings, until_s=until_s)
    follower.follow(intent)
    course = follower.writer.course(flyer.name, flyer.state.serial)
    if _has_not_begun(flyer, intent):
        course = replace(course, delay_s=settings.start_delay_s)
    return (course, *volumes)


def _has_not_begun(flyer: Flyer, intent: Intent) -> bool:
    east_mps, north_mps, up_mps = flyer.velocity_mps
    stands = max(hypot(east_mps, north_mps), abs(up_mps)) < STANDING_MPS
    return intent.commanded is Commanded.MISSION and intent.passed == 0 and stands


@dataclass(frozen=True, slots=True)
class Surroundings:
    """A circle in the plane and a band of heights that hold a course, what it must be kept clear of
    included, and how long it is of interest."""

    east_m: float
    north_m: float
    radius_m: float
    low_m: float
    high_m: float
    until_s: float


def surroundings(
    course: Course, need: SeparationMinima, settings: PredictionSettings
) -> Surroundings:
    """Return where and until when anything can come too near to a course."""
    rows = course.rows
    east_m, north_m = float(rows[0, EAST_0]), float(rows[0, NORTH_0])
    wide_m = np.hypot(rows[:, EAST_1] - east_m, rows[:, NORTH_1] - north_m)
    wide_m += np.maximum(rows[:, RADIUS_0], rows[:, RADIUS_1])
    ends_s = float(rows[-1, END_S])
    return Surroundings(
        east_m,
        north_m,
        float(wide_m.max()) + need.horizontal_m,
        float(rows[:, [LOW_0, LOW_1]].min()) - need.vertical_m,
        float(rows[:, [HIGH_0, HIGH_1]].max()) + need.vertical_m,
        ends_s * (1.0 + settings.time_uncertainty) + settings.slack_s,
    )


def may_enter(
    flyer: Flyer, intent: Intent, around: Surroundings, settings: PredictionSettings
) -> bool:
    """Return whether a vehicle can come into the surroundings in time: in doubt yes.

    Cheap, so that a stick is judged at once however many vehicles fly.
    """
    far_m = hypot(flyer.east_m - around.east_m, flyer.north_m - around.north_m)
    if far_m > around.radius_m + _reach_m(flyer, intent, around.until_s, settings):
        return False
    low_m, high_m = _band_m(flyer, intent, around.until_s, settings)
    return low_m < around.high_m and around.low_m < high_m


def may_meet(course: Course, around: Surroundings) -> bool:
    """Return whether any of a course comes into the surroundings, at whatever time: in doubt yes.

    Before its pieces are compared one by one: most traffic is elsewhere, or at other heights.
    """
    least, most = course.rows.min(axis=0).tolist(), course.rows.max(axis=0).tolist()
    far_m = hypot(
        _outside_m(around.east_m, (least[EAST_0], least[EAST_1]), (most[EAST_0], most[EAST_1])),
        _outside_m(
            around.north_m, (least[NORTH_0], least[NORTH_1]), (most[NORTH_0], most[NORTH_1])
        ),
    )
    if far_m > around.radius_m + max(most[RADIUS_0], most[RADIUS_1]) + ROUNDING_M:
        return False
    is_above = min(least[LOW_0], least[LOW_1]) > around.high_m + ROUNDING_M
    is_below = max(most[HIGH_0], most[HIGH_1]) < around.low_m - ROUNDING_M
    return not (is_above or is_below)


def _outside_m(at_m: float, least_m: tuple[float, float], most_m: tuple[float, float]) -> float:
    """How far a place is outside a span of places, along one axis."""
    return max(min(least_m) - at_m, at_m - max(most_m), 0.0)


def _reach_m(flyer: Flyer, intent: Intent, seconds: float, settings: PredictionSettings) -> float:
    """How far from its last place a vehicle comes at most."""
    is_told = intent.commanded in (Commanded.MISSION, Commanded.STICK, Commanded.RETURN)
    fastest_mps = max(flyer.speed_mps, settings.unknown_speed_mps if is_told else 0.0)
    lasts_s = flyer.age_s + max(seconds, settings.stick_horizon_s)
    own_m = fastest_mps * lasts_s + stopping_distance_m(fastest_mps, settings)
    if flyer.age_s <= settings.stale_s and (
        flyer.home_m is not None or intent.commanded is not Commanded.RETURN
    ):
        return own_m
    home_m = (0.0, 0.0) if flyer.home_m is None else flyer.home_m
    home_far_m = hypot(home_m[0] - flyer.east_m, home_m[1] - flyer.north_m)
    hidden_m = max(settings.hazard_radius_m, UNHOMED_RADIUS_M, home_far_m + settings.corridor_m)
    return max(own_m, hidden_m)


def _band_m(
    flyer: Flyer, intent: Intent, seconds: float, settings: PredictionSettings
) -> tuple[float, float]:
    """The heights it can be at within so many seconds."""
    if flyer.age_s > settings.stale_s or intent.commanded in (Commanded.LAND, Commanded.RETURN):
        return -ALL_HEIGHTS_M, 2.0 * ALL_HEIGHTS_M
    low_m, high_m = flyer.low_m, flyer.high_m
    heights_m = [intent.target_height_above_takeoff_m]
    if intent.mission is not None and intent.passed == 0:
        heights_m.append(intent.mission.waypoints[0].height_above_takeoff_m)
    for height_m in heights_m:
        if height_m is not None:
            band_m = flyer.up_m(height_m)
            low_m, high_m = min(low_m, band_m[0]), max(high_m, band_m[1])
    fastest_mps = max(settings.climb_mps, settings.sink_mps, abs(flyer.velocity_mps[2]))
    change_m = fastest_mps * (flyer.age_s + max(seconds, settings.stick_horizon_s))
    return low_m - change_m, high_m + change_m
