"""The kinematic state steering needs, and the goal of a steered order from there."""

from dataclasses import replace
from math import hypot
from typing import assert_never

from recon.geo.distance import moved_m
from recon.guidance.path_following import goal_on, path_from
from recon.guidance.steering import Goal, KinematicState, SteeringSettings, stopping_place
from recon.model.command import FollowPath, GoTo, HoldPosition, Nudge, Refusal, SteeredBody
from recon.model.units import wrap_degrees
from recon.model.vehicle import VehicleState
from recon.station.state.setpoint_stream import StreamSettings

SIGHT = "sight"


def kinematic_state(vehicle: VehicleState, now_ns: int) -> KinematicState | None:
    """Return a vehicle's kinematic state, None while any part of it is unknown.

    Its age is that of the oldest part.
    """
    position, velocity = vehicle.position.value, vehicle.velocity_ned.value
    height_m, attitude = vehicle.height_above_takeoff_m.value, vehicle.attitude.value
    if position is None or velocity is None or height_m is None or attitude is None:
        return None
    parts = vehicle.position, vehicle.velocity_ned, vehicle.height_above_takeoff_m, vehicle.attitude
    return KinematicState(
        position,
        velocity.north_mps,
        velocity.east_mps,
        height_m,
        attitude.yaw_deg,
        max(part.age_s(now_ns) or 0.0 for part in parts),
    )


def refusal_without_telemetry(
    vehicle: VehicleState, now_ns: int, settings: StreamSettings
) -> Refusal | None:
    """Return why steering cannot start: a part of the kinematic state is unknown or old."""
    seen = kinematic_state(vehicle, now_ns)
    if seen is not None and seen.age_s <= settings.max_telemetry_age_s:
        return None
    return Refusal(
        SIGHT,
        f"{vehicle.display_name}: steering needs position, velocity, height and heading, at most "
        f"{settings.max_telemetry_age_s:g} s old: wait for its telemetry",
    )


def goal_of(
    body: SteeredBody, seen: KinematicState, steering: SteeringSettings, settings: StreamSettings
) -> Goal:
    """Return the goal of a steered order from the present kinematic state."""
    match body:
        case GoTo():
            yaw_deg = seen.yaw_deg if body.yaw_deg is None else wrap_degrees(body.yaw_deg)
            return Goal(body.target, body.height_above_takeoff_m, body.speed_mps, yaw_deg)
        case Nudge():
            return Goal(
                moved_m(seen.position, body.north_m, body.east_m),
                seen.height_above_takeoff_m + body.up_m,
                body.speed_mps,
                wrap_degrees(seen.yaw_deg + body.turn_deg),
            )
        case HoldPosition():
            place = stopping_place(seen, steering)
            return Goal(place, seen.height_above_takeoff_m, settings.hold_speed_mps, seen.yaw_deg)
        case FollowPath(mission):
            return goal_on(path_from(mission, seen), seen, steering)
        case _ as unknown:
            assert_never(unknown)


def no_faster_than(seen: KinematicState, speed_mps: float) -> KinematicState:
    """Return the state with its horizontal speed limited: no setpoint starts above a limit."""
    speed = hypot(seen.velocity_north_mps, seen.velocity_east_mps)
    share = 1.0 if speed <= speed_mps else speed_mps / speed
    return replace(
        seen,
        velocity_north_mps=share * seen.velocity_north_mps,
        velocity_east_mps=share * seen.velocity_east_mps,
    )
