"""Trajectories of a whole situation: the order's own, and the traffic's."""

from dataclasses import dataclass, replace
from math import hypot

import numpy as np

from recon.model.command import Body, FlyMission, FollowPath
from recon.model.control import Commanded, Intent
from recon.model.mission import Mission
from recon.model.vehicle import VehicleState
from recon.safety.path.order_path import StickFlight, StraightFlight, TakeoffClimb, order_path
from recon.safety.prediction.hazard_area import hazard_area_of, hazard_trajectories
from recon.safety.prediction.legs import LEAST_S, STANDING_MPS, stop, stopping_distance_m
from recon.safety.prediction.motion import (
    Plane,
    VehicleMotion,
    age_at,
    last_place,
    plausible_speed_mps,
)
from recon.safety.prediction.predictor import UNHOMED_RADIUS_M, Predictor
from recon.safety.prediction.protected_volumes import latest_entry_s, latest_s
from recon.safety.prediction.trajectory import (
    ALL_HEIGHTS_M,
    EAST_0,
    EAST_1,
    HIGH_0,
    HIGH_1,
    LOW_0,
    LOW_1,
    NORTH_0,
    NORTH_1,
    RADIUS_0,
    RADIUS_1,
    FlightPart,
    Trajectory,
)
from recon.safety.prediction_settings import PredictionSettings
from recon.safety.separation_minima import SeparationMinima

ROUNDING_M = 1e-6


def predict_order(motion: VehicleMotion, body: Body, settings: PredictionSettings) -> Trajectory:
    """Return the trajectory an order to move would send its vehicle on."""
    predictor = Predictor(motion, settings)
    write_order(predictor, body)
    trajectory = predictor.writer.trajectory(motion.name, motion.drift_m)
    late_s = settings.starts_within_s(body.mission) if isinstance(body, FlyMission) else 0.0
    if isinstance(body, FollowPath):
        late_s = settings.steered_lateness_s(body.mission)
    return replace(trajectory, delay_s=predictor.delay_s + late_s)


def predict_traffic(
    motion: VehicleMotion, intent: Intent, settings: PredictionSettings, until_s: float
) -> tuple[Trajectory, ...]:
    """Return what others must keep clear of: a vehicle's trajectory; of a stale one, its hazard
    area
    too.

    The hazard area does not replace the trajectory: an app that loses the station flies its mission
    on. A mission that has not begun may begin late, as one under judgement may.
    """
    hazard = hazard_area_of(motion, intent, settings)
    volumes = () if hazard is None else hazard_trajectories(hazard)
    if hazard is not None and intent.commanded is not Commanded.MISSION:
        return volumes
    predictor = Predictor(motion, settings, until_s=until_s)
    predictor.follow(intent)
    trajectory = predictor.writer.trajectory(motion.name, motion.drift_m)
    late_s = settings.starts_within_s(intent.mission) if _has_not_begun(motion, intent) else 0.0
    if intent.commanded is Commanded.STICK and intent.mission is not None:
        late_s = settings.steered_lateness_s(intent.mission, intent.passed)
    return (replace(trajectory, delay_s=predictor.delay_s + late_s), *volumes)


def _has_not_begun(motion: VehicleMotion, intent: Intent) -> bool:
    east_mps, north_mps, up_mps = motion.velocity_mps
    stands = max(hypot(east_mps, north_mps), abs(up_mps)) < STANDING_MPS
    return intent.commanded is Commanded.MISSION and intent.passed == 0 and stands


@dataclass(frozen=True, slots=True)
class TrajectoryBounds:
    """A circle in the plane and a band of heights that hold a trajectory, what it must be kept
    clear of included, and until when others are of interest: they may fly earlier than they are
    thought to."""

    east_m: float
    north_m: float
    radius_m: float
    low_m: float
    high_m: float
    until_s: float


def trajectory_bounds(
    trajectory: Trajectory, need: SeparationMinima, settings: PredictionSettings
) -> TrajectoryBounds:
    """Return where and until when anything can come too near to a trajectory."""
    rows = trajectory.rows
    east_m, north_m = float(rows[0, EAST_0]), float(rows[0, NORTH_0])
    wide_m = np.hypot(rows[:, EAST_1] - east_m, rows[:, NORTH_1] - north_m)
    wide_m += np.maximum(rows[:, RADIUS_0], rows[:, RADIUS_1])
    return TrajectoryBounds(
        east_m,
        north_m,
        float(wide_m.max()) + need.horizontal_m,
        float(rows[:, [LOW_0, LOW_1]].min()) - need.vertical_m,
        float(rows[:, [HIGH_0, HIGH_1]].max()) + need.vertical_m,
        latest_entry_s(latest_s(trajectory, settings), settings),
    )


def is_too_far(
    state: VehicleState,
    intent: Intent,
    plane: Plane,
    around: TrajectoryBounds,
    now_ns: int,
    settings: PredictionSettings,
) -> bool:
    """Return whether a vehicle in contact is too far away to come into the bounds in time: in
    doubt not.

    `may_enter` denies it too; this needs neither its heights nor its home, and most traffic is far.
    """
    place, at_ns = last_place(state)
    if place is None or intent.commanded is Commanded.RETURN:
        return False
    age_s = age_at(now_ns, at_ns)
    if age_s > settings.stale_s:
        return False
    east_m, north_m = plane.east_north_m(place)
    speed_mps = plausible_speed_mps(state, settings)
    reach_m = _flown_m(speed_mps, age_s, intent, around.until_s, settings)
    return hypot(east_m - around.east_m, north_m - around.north_m) > around.radius_m + reach_m


def may_enter(
    motion: VehicleMotion, intent: Intent, around: TrajectoryBounds, settings: PredictionSettings
) -> bool:
    """Return whether a vehicle can come into the trajectory_bounds in time: in doubt yes.

    Cheap, so that a stick is judged at once however many vehicles fly.
    """
    far_m = hypot(motion.east_m - around.east_m, motion.north_m - around.north_m)
    if far_m > around.radius_m + _reach_m(motion, intent, around.until_s, settings):
        return False
    low_m, high_m = _band_m(motion, intent, around.until_s, settings)
    return low_m < around.high_m and around.low_m < high_m


def may_conflict(trajectory: Trajectory, around: TrajectoryBounds) -> bool:
    """Return whether any of a trajectory comes into the bounds, at whatever time: in doubt yes.

    Asked before its pieces are compared one by one: most traffic is elsewhere, or at other heights.
    """
    least, most = trajectory.rows.min(axis=0).tolist(), trajectory.rows.max(axis=0).tolist()
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


def _reach_m(
    motion: VehicleMotion, intent: Intent, seconds: float, settings: PredictionSettings
) -> float:
    """How far from its last place a vehicle comes at most."""
    own_m = _flown_m(motion.speed_mps, motion.age_s, intent, seconds, settings)
    if motion.age_s <= settings.stale_s and (
        motion.home_m is not None or intent.commanded is not Commanded.RETURN
    ):
        return own_m
    reach_m = max(own_m, settings.hazard_radius_m, UNHOMED_RADIUS_M)
    if motion.home_m is not None:
        east_m, north_m = motion.home_m
        home_far_m = hypot(east_m - motion.east_m, north_m - motion.north_m)
        reach_m = max(reach_m, home_far_m + settings.corridor_m)
    return reach_m


def _flown_m(
    speed_mps: float, age_s: float, intent: Intent, seconds: float, settings: PredictionSettings
) -> float:
    """Return how far it flies at most from its place `age_s` ago until `seconds` from now."""
    is_commanded = intent.commanded in (Commanded.MISSION, Commanded.STICK, Commanded.RETURN)
    fastest_mps = max(speed_mps, settings.unknown_speed_mps if is_commanded else 0.0)
    lasts_s = age_s + max(seconds, settings.stick_horizon_s)
    return fastest_mps * lasts_s + stopping_distance_m(fastest_mps, settings)


def _band_m(
    motion: VehicleMotion, intent: Intent, seconds: float, settings: PredictionSettings
) -> tuple[float, float]:
    """Return the heights that it can reach within `seconds`."""
    if motion.age_s > settings.stale_s or intent.commanded in (Commanded.LAND, Commanded.RETURN):
        return -ALL_HEIGHTS_M, ALL_HEIGHTS_M
    heights_m = [intent.target_height_above_takeoff_m]
    if intent.mission is not None and intent.passed == 0:
        heights_m.append(intent.mission.waypoints[0].height_above_takeoff_m)
    bands_m = [motion.up_m(height_m) for height_m in heights_m if height_m is not None]
    bands_m.append((motion.low_m, motion.high_m))
    fastest_mps = max(settings.climb_mps, settings.sink_mps, abs(motion.velocity_mps[2]))
    change_m = fastest_mps * (motion.age_s + max(seconds, settings.stick_horizon_s))
    off_m = change_m + motion.drift_m
    return min(low_m for low_m, _ in bands_m) - off_m, max(high_m for _, high_m in bands_m) + off_m


def write_order(predictor: Predictor, body: Body) -> None:
    """Write what an order to move makes its vehicle do, until it is judged anew."""
    motion, writer, settings = predictor.motion, predictor.writer, predictor.settings
    path = order_path(body, motion.state)
    match path:
        case Mission():
            if motion.speed_mps >= STANDING_MPS:
                stop(writer, motion.velocity_mps, settings, reaction_s=settings.reaction_s)
            predictor.fly_mission(path, 0)
            return
        case StickFlight():
            _stick(predictor, path)
            return
        case StraightFlight(target, height_m, speed_mps):
            predictor.go_to(target, height_m, speed_mps)
        case TakeoffClimb():
            _climbs(predictor, (writer.low_m, writer.high_m + settings.takeoff_height_m))
        case _:
            stop(writer, motion.velocity_mps, settings, reaction_s=settings.reaction_s)
    writer.waits(settings.stands_s, FlightPart.HOVERING)


def _stick(predictor: Predictor, path: StickFlight) -> None:
    """The velocity is reached, kept for the stick's time and the reaction, and braked.

    A body-frame stick that turns the vehicle reaches anywhere in a disc: at its own speed or the
    vehicle's present one, whichever is faster.
    """
    writer, settings = predictor.writer, predictor.settings
    _climbs(predictor, predictor.motion.up_m(path.height_above_takeoff_m))
    if path.turn_deg is None or abs(path.turn_deg) > settings.stick_line_deg:
        fastest_mps = max(path.speed_mps, predictor.motion.speed_mps)
        reach_m = path.reach_m(settings.stick, speed_mps=fastest_mps)
        writer.grows(reach_m, path.timeout_s + settings.stick.reaction_s, FlightPart.STEERED)
        return
    velocity = path.east_north_mps()
    _reach_velocity(predictor, velocity)
    writer.moves(
        writer.east_m + velocity[0] * path.timeout_s,
        writer.north_m + velocity[1] * path.timeout_s,
        path.timeout_s,
        FlightPart.STEERED,
    )
    reaction_s = settings.stick.reaction_s
    stop(writer, (*velocity, 0.0), settings, reaction_s=reaction_s, part=FlightPart.STEERED)


def _climbs(predictor: Predictor, band_m: tuple[float, float]) -> None:
    """Write a climb: any height between these from now on; its own height and velocity until now.

    So the climb itself does not separate two vehicles that are too near already.
    """
    writer, (east_mps, north_mps, _up_mps) = predictor.writer, predictor.motion.velocity_mps
    until_now_s = max(0.0, -writer.time_s) + LEAST_S
    writer.moves(
        writer.east_m + east_mps * until_now_s,
        writer.north_m + north_mps * until_now_s,
        until_now_s,
        FlightPart.STEERED,
    )
    writer.widens(*band_m)


def _reach_velocity(predictor: Predictor, velocity: tuple[float, float]) -> None:
    """Write the change to the stick's velocity: a parabola, within its bow of the chord."""
    writer, settings = predictor.writer, predictor.settings
    east_mps, north_mps, _up_mps = predictor.motion.velocity_mps
    change_mps = hypot(velocity[0] - east_mps, velocity[1] - north_mps)
    takes_s = change_mps / settings.braking_mps2
    if takes_s < 0.05:
        return
    bow_m = change_mps * takes_s / 8.0
    writer.radius_m = bow_m
    writer.moves(
        writer.east_m + 0.5 * (east_mps + velocity[0]) * takes_s,
        writer.north_m + 0.5 * (north_mps + velocity[1]) * takes_s,
        takes_s,
        FlightPart.STEERED,
    )
    writer.radius_m = 0.0
