"""Flying a waypoint mission (ICD 3.2.3): stopping at waypoints, or rounding their corners.

A straight mission climbs to the first waypoint's height, flies to it, and then leg by leg, with
loiter and gimbal action at each stop. A curved mission does the same up to the first waypoint and
then follows the rounded path without stopping; the SDK ignores its actions.
"""

from dataclasses import dataclass
from math import hypot, sqrt

from recon.model.vehicle import FlightMode
from recon.sim.flight.flight_modes import ActiveMode, Land, PositionHold, heading_deg
from recon.sim.flight.kinematics import (
    BRAKING_MPS2,
    AircraftMotion,
    Limits,
    VelocityDemand,
    braking_speed_mps,
    hold_height_mps,
)
from recon.sim.flight.path import Corner, FlightPath, rounded_path

ARRIVED_WITHIN_M = 0.5
ARRIVED_BELOW_MPS = 0.4
GIMBAL_RATE_DPS = 30.0
PATH_GAIN_PER_S = 0.8
"""Velocity correction per metre off the path: corrects within about a second, without overshoot."""
LEAST_PATH_SPEED_MPS = 0.3
"""Speeds along a path are 0 at its ends: without this the target point would never start."""
LONGEST_LAG_M = 4.0
"""The target point slows down linearly with the aircraft's lag and waits at this distance."""


@dataclass(frozen=True, slots=True)
class MissionPoint:
    """A waypoint in home metres; None means no action there."""

    north_m: float
    east_m: float
    height_m: float
    speed_mps: float
    corner_radius_m: float = 0.2
    loiter_s: float | None = None
    gimbal_pitch_deg: float | None = None


@dataclass(slots=True)
class Gimbal:
    """The survey camera's gimbal: turns at a limited rate to the pitch commanded last."""

    pitch_deg: float = -90.0
    wanted_deg: float = -90.0

    def step(self, seconds: float) -> None:
        """Turn for `seconds`."""
        largest = GIMBAL_RATE_DPS * seconds
        self.pitch_deg += max(-largest, min(largest, self.wanted_deg - self.pitch_deg))

    @property
    def has_arrived(self) -> bool:
        """Whether the commanded pitch is reached."""
        return abs(self.wanted_deg - self.pitch_deg) < 0.1


@dataclass(slots=True)
class MissionFlight:
    """A mission being flown; with `is_curved` the corners after the first are rounded."""

    points: tuple[MissionPoint, ...]
    is_curved: bool
    lands_at_end: bool
    gimbal: Gimbal
    limits: Limits
    confirmation_s: float = 1.0
    mode: FlightMode = FlightMode.GPS_WAYPOINT
    next_index: int = 0
    _has_risen: bool = False
    _loiter_left_s: float | None = None
    _curve: "CurveFollower | None" = None

    def demand(self, motion: AircraftMotion, seconds: float) -> VelocityDemand:
        """Fly to the next waypoint, or stand still while its action runs."""
        if self._curve is not None:
            return self._curve.demand(motion, seconds)
        if self.next_index >= len(self.points):
            return VelocityDemand()
        target = self.points[self.next_index]
        if not self._has_risen:
            return self._rise(motion, target)
        if self._loiter_left_s is not None:
            return self._act(seconds)
        if _has_arrived(motion, target):
            self._begin_action(target)
        previous = self.points[max(0, self.next_index - 1)]
        return _pursue(motion, previous, target, self.limits)

    def successor(self, motion: AircraftMotion) -> ActiveMode | None:
        """Land or hover after the last waypoint."""
        flown = self.next_index >= len(self.points)
        if self._curve is not None:
            flown = self._curve.is_flown and motion.ground_speed_mps < ARRIVED_BELOW_MPS
        if not flown:
            return None
        return Land(self.confirmation_s) if self.lands_at_end else PositionHold()

    def _rise(self, motion: AircraftMotion, target: MissionPoint) -> VelocityDemand:
        """Climb to the first waypoint's height before flying there (DJI's safe start)."""
        if motion.height_m >= target.height_m - 1.0:
            self._has_risen = True
        return VelocityDemand(
            velocity_up_mps=hold_height_mps(motion.height_m, target.height_m, self.limits)
        )

    def _begin_action(self, point: MissionPoint) -> None:
        if self.is_curved:
            self._curve = CurveFollower(self.points, self.limits)
            return
        self._loiter_left_s = point.loiter_s or 0.0
        if point.gimbal_pitch_deg is not None:
            self.gimbal.wanted_deg = point.gimbal_pitch_deg

    def _act(self, seconds: float) -> VelocityDemand:
        """Stay until both the loiter time and the gimbal's turn are complete."""
        left_s = (self._loiter_left_s or 0.0) - seconds
        self._loiter_left_s = max(0.0, left_s)
        if left_s <= 0.0 and self.gimbal.has_arrived:
            self._loiter_left_s = None
            self.next_index += 1
        return VelocityDemand()


class CurveFollower:
    """Follows a target point on a rounded path; the point waits when the aircraft lags behind."""

    def __init__(self, points: tuple[MissionPoint, ...], limits: Limits) -> None:
        corners = [
            Corner(p.north_m, p.east_m, p.height_m, p.corner_radius_m, p.speed_mps) for p in points
        ]
        self.path: FlightPath = rounded_path(corners, limits)
        self._along_m = 0.0

    @property
    def is_flown(self) -> bool:
        """Whether the target point has reached the end."""
        return self._along_m >= self.path.length_m

    def demand(self, motion: AircraftMotion, seconds: float) -> VelocityDemand:
        """Return the target point's velocity plus a correction towards it."""
        place = self.path.place_at(self._along_m)
        behind = [
            wanted - is_at
            for wanted, is_at in zip(
                place.point_m, (motion.north_m, motion.east_m, motion.height_m), strict=True
            )
        ]
        lag_m = sqrt(sum(part * part for part in behind))
        # The target point waits for a lagging aircraft, else corners would be cut short.
        pace = max(0.0, 1.0 - lag_m / LONGEST_LAG_M)
        speed = 0.0 if self.is_flown else pace * max(LEAST_PATH_SPEED_MPS, place.speed_mps)
        self._along_m += speed * seconds
        north, east, up = (
            speed * along + PATH_GAIN_PER_S * back
            for along, back in zip(place.direction, behind, strict=True)
        )
        # On a vertical piece of the path the heading is undefined: keep it.
        yaw = heading_deg(*place.direction[:2]) if hypot(*place.direction[:2]) > 1e-3 else None
        return VelocityDemand(north, east, up, yaw)


def _has_arrived(motion: AircraftMotion, point: MissionPoint) -> bool:
    distance = sqrt(
        (point.north_m - motion.north_m) ** 2
        + (point.east_m - motion.east_m) ** 2
        + (point.height_m - motion.height_m) ** 2
    )
    return distance < ARRIVED_WITHIN_M and motion.ground_speed_mps < ARRIVED_BELOW_MPS


def _pursue(
    motion: AircraftMotion, previous: MissionPoint, target: MissionPoint, limits: Limits
) -> VelocityDemand:
    """Return the demand that flies on to a waypoint in 3D, back to the leg's height, and stops."""
    north, east = target.north_m - motion.north_m, target.east_m - motion.east_m
    up = target.height_m - motion.height_m
    distance = sqrt(north * north + east * east + up * up)
    if distance < 1e-6:
        return VelocityDemand()
    share = min(previous.speed_mps, braking_speed_mps(distance, BRAKING_MPS2)) / distance
    # On a steep leg the climb or descent limit sets the speed.
    steepest = limits.climb_mps if up > 0.0 else limits.descent_mps
    if abs(up) * share > steepest:
        share = steepest / abs(up)
    # Near the waypoint the bearing is noise: keep the heading.
    yaw = heading_deg(north, east) if hypot(north, east) > 3.0 else None
    up_mps = up * share + PATH_GAIN_PER_S * _below_leg_m(motion, previous, target)
    return VelocityDemand(north * share, east * share, up_mps, yaw)


def _below_leg_m(motion: AircraftMotion, previous: MissionPoint, target: MissionPoint) -> float:
    """Return how far the leg's line is above the aircraft; 0 on a vertical leg."""
    length_m = hypot(target.north_m - previous.north_m, target.east_m - previous.east_m)
    if length_m < ARRIVED_WITHIN_M and previous is not target:
        return 0.0
    left_m = hypot(target.north_m - motion.north_m, target.east_m - motion.east_m)
    left = 0.0 if previous is target else min(1.0, left_m / length_m)
    return target.height_m + left * (previous.height_m - target.height_m) - motion.height_m
