"""Kinematics of a multirotor: velocities follow demands within limits.

Positions are north and east metres of the tangent plane at the vehicle's home point; heights are
above that point. A step is pure: (motion, demand, seconds) -> motion.
"""

from dataclasses import dataclass
from math import atan2, cos, degrees, hypot, radians, sin, sqrt
from typing import NamedTuple

from recon.model.units import wrap_degrees

GRAVITY_MPS2 = 9.80665

DRAG_PER_S = 0.22
"""Deceleration by drag per m/s of airspeed: gives about 18 degrees of tilt at 15 m/s."""

BRAKING_MPS2 = 2.0
"""Deceleration of approaches: a fifth of the acceleration is kept for wind and steering."""

Wind = tuple[float, float]
"""North and east components of the air's motion, in m/s."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of the airframe and its flight controller."""

    speed_mps: float = 15.0
    """Ground speed, limited by the flight controller."""
    airspeed_mps: float = 17.0
    """Largest airspeed: against a wind of 10 m/s it leaves 7 m/s of ground speed."""
    acceleration_mps2: float = 2.5
    climb_mps: float = 2.6
    descent_mps: float = 3.2
    vertical_acceleration_mps2: float = 2.0
    yaw_rate_dps: float = 60.0


class AircraftMotion(NamedTuple):
    """Position, velocity and attitude of an aircraft."""

    north_m: float = 0.0
    east_m: float = 0.0
    height_m: float = 0.0
    velocity_north_mps: float = 0.0
    velocity_east_mps: float = 0.0
    velocity_up_mps: float = 0.0
    yaw_deg: float = 0.0
    pitch_deg: float = 0.0
    roll_deg: float = 0.0

    @property
    def ground_speed_mps(self) -> float:
        """Horizontal speed."""
        return hypot(self.velocity_north_mps, self.velocity_east_mps)


class VelocityDemand(NamedTuple):
    """Requested velocity; `yaw_deg` None keeps the present heading."""

    velocity_north_mps: float = 0.0
    velocity_east_mps: float = 0.0
    velocity_up_mps: float = 0.0
    yaw_deg: float | None = None


def step(
    motion: AircraftMotion,
    demand: VelocityDemand,
    seconds: float,
    limits: Limits,
    wind: Wind = (0.0, 0.0),
) -> AircraftMotion:
    """Return the motion `seconds` later, within all limits. Pure.

    The airframe tilts against `wind`, and where the airspeed limit is reached it flies slower over
    the ground, on the same course.
    """
    north, east = _follow_horizontally(motion, demand, seconds, limits, wind)
    up = _follow_vertically(motion.velocity_up_mps, demand.velocity_up_mps, seconds, limits)
    yaw = _turn(motion.yaw_deg, demand.yaw_deg, seconds, limits.yaw_rate_dps)
    pitch, roll = _tilt(motion, (north, east), seconds, yaw, wind)
    return AircraftMotion(
        north_m=motion.north_m + 0.5 * (motion.velocity_north_mps + north) * seconds,
        east_m=motion.east_m + 0.5 * (motion.velocity_east_mps + east) * seconds,
        height_m=motion.height_m + 0.5 * (motion.velocity_up_mps + up) * seconds,
        velocity_north_mps=north,
        velocity_east_mps=east,
        velocity_up_mps=up,
        yaw_deg=yaw,
        pitch_deg=pitch,
        roll_deg=roll,
    )


def braking_speed_mps(distance_m: float, deceleration_mps2: float) -> float:
    """Return the speed from which a stop within `distance_m` is possible.

    Near the target the square root is replaced by its tangent: its slope grows without bound at 0,
    and with a finite time step the approach would oscillate about the target.
    """
    # There the tangent of slope 1/s meets the square root: v = d at d = a.
    settling_m = deceleration_mps2
    if distance_m < settling_m:
        return distance_m
    return sqrt(2.0 * deceleration_mps2 * (distance_m - 0.5 * settling_m))


def hold_height_mps(height_m: float, target_m: float, limits: Limits) -> float:
    """Return the vertical velocity that brings the aircraft to a height and holds it."""
    error_m = target_m - height_m
    # With 0.4 of the acceleration the approach to a height does not overshoot.
    speed = braking_speed_mps(abs(error_m), 0.4 * limits.vertical_acceleration_mps2)
    return min(speed, limits.climb_mps) if error_m > 0.0 else -min(speed, limits.descent_mps)


def _follow_horizontally(
    motion: AircraftMotion, demand: VelocityDemand, seconds: float, limits: Limits, wind: Wind
) -> tuple[float, float]:
    asked = _clip(demand.velocity_north_mps, demand.velocity_east_mps, limits.speed_mps)
    # Airspeed limit before the acceleration limit: the demand itself must be reachable.
    wanted_north, wanted_east = _against(asked, wind, limits.airspeed_mps)
    change_north, change_east = _clip(
        wanted_north - motion.velocity_north_mps,
        wanted_east - motion.velocity_east_mps,
        limits.acceleration_mps2 * seconds,
    )
    return motion.velocity_north_mps + change_north, motion.velocity_east_mps + change_east


def _follow_vertically(current: float, wanted: float, seconds: float, limits: Limits) -> float:
    wanted = max(-limits.descent_mps, min(limits.climb_mps, wanted))
    largest = limits.vertical_acceleration_mps2 * seconds
    return current + max(-largest, min(largest, wanted - current))


def _turn(yaw_deg: float, wanted_deg: float | None, seconds: float, rate_dps: float) -> float:
    if wanted_deg is None:
        return yaw_deg
    largest = rate_dps * seconds
    change = max(-largest, min(largest, wrap_degrees(wanted_deg - yaw_deg)))
    return wrap_degrees(yaw_deg + change)


def _against(asked: tuple[float, float], wind: Wind, fastest_mps: float) -> tuple[float, float]:
    """Return the part of the ground velocity `asked` that the airspeed limit leaves; course kept.

    In a wind faster than the airspeed limit the aircraft drifts with the wind.
    """
    through = asked[0] - wind[0], asked[1] - wind[1]
    if hypot(*through) <= fastest_mps:
        return asked
    if hypot(*wind) >= fastest_mps:
        north, east = _clip(-wind[0], -wind[1], fastest_mps)
        return wind[0] + north, wind[1] + east
    # Solve |k asked - wind| = fastest for the larger k: a quadratic equation.
    square = asked[0] ** 2 + asked[1] ** 2
    along = asked[0] * wind[0] + asked[1] * wind[1]
    rest = fastest_mps**2 - wind[0] ** 2 - wind[1] ** 2
    share = (along + sqrt(along * along + square * rest)) / square
    return share * asked[0], share * asked[1]


def _tilt(
    motion: AircraftMotion,
    velocity: tuple[float, float],
    seconds: float,
    yaw_deg: float,
    wind: Wind,
) -> tuple[float, float]:
    """Return pitch (nose up) and roll (right down) that give this acceleration against drag."""
    north, east = velocity
    # Thrust per mass: acceleration plus drag of the motion through the air.
    push_north = (north - motion.velocity_north_mps) / seconds + DRAG_PER_S * (north - wind[0])
    push_east = (east - motion.velocity_east_mps) / seconds + DRAG_PER_S * (east - wind[1])
    heading = radians(yaw_deg)
    forward = push_north * cos(heading) + push_east * sin(heading)
    right = push_east * cos(heading) - push_north * sin(heading)
    # First-order lag of 0.25 s, about that of an airframe's attitude.
    share = min(1.0, seconds / 0.25)
    pitch = degrees(atan2(-forward, GRAVITY_MPS2))
    roll = degrees(atan2(right, GRAVITY_MPS2))
    return (
        motion.pitch_deg + share * (pitch - motion.pitch_deg),
        motion.roll_deg + share * (roll - motion.roll_deg),
    )


def _clip(x: float, y: float, longest: float) -> tuple[float, float]:
    length = hypot(x, y)
    if length <= longest:
        return x, y
    return x * longest / length, y * longest / length
