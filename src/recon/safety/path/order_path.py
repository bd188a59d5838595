"""The one interpreter of orders: which motion an order asks for, as the wire carries it."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from math import copysign, cos, hypot, inf, radians, sin
from typing import assert_never

from recon.geo.distance import moved_m
from recon.model.command import (
    Body,
    Command,
    FlyMission,
    FollowPath,
    GoTo,
    HoldPosition,
    Hover,
    LandNow,
    LockCamera,
    Nudge,
    ReturnHome,
    StartCamera,
    StickFrame,
    StopCamera,
    VirtualStick,
)
from recon.model.geo import LatLon
from recon.model.mission import Mission
from recon.model.units import wrap_degrees
from recon.model.vehicle import VehicleState
from recon.safety.prediction_settings import StickBounds
from recon.safety.situation import Situation


@dataclass(frozen=True, slots=True)
class StraightFlight:
    """A goto or a nudge: straight to a target, at every height between; then the vehicle hovers.

    `height_above_takeoff_m` is None where the vehicle's own height, which a nudge adds to, is
    unknown.
    """

    target: LatLon
    height_above_takeoff_m: float | None
    speed_mps: float
    name: str


@dataclass(frozen=True, slots=True)
class StickFlight:
    """One virtual stick, in the 32-bit numbers of the wire.

    `north_mps` and `east_mps` are the velocity at yaw 0: over ground, or forward and right in the
    body's frame. `turn_deg` is the turn from the present yaw to the stick's: 0 in the ground frame,
    None when the present yaw is unknown; `first_yaw_deg` is where it begins.
    """

    north_mps: float
    east_mps: float
    frame: StickFrame
    first_yaw_deg: float
    turn_deg: float | None
    height_above_takeoff_m: float
    timeout_s: float

    @property
    def speed_mps(self) -> float:
        """The horizontal speed."""
        return hypot(self.north_mps, self.east_mps)

    def reach_m(self, bounds: StickBounds, *, speed_mps: float | None = None) -> float:
        """Return the distance flown in the timeout and in what the bounds add to it.

        `speed_mps` replaces the stick's own speed.
        """
        speed = self.speed_mps if speed_mps is None else speed_mps
        braking_m = 0.0 if bounds.braking_mps2 is None else speed**2 / (2.0 * bounds.braking_mps2)
        return speed * (self.timeout_s + bounds.reaction_s) + braking_m

    def east_north_mps(self) -> tuple[float, float]:
        """Return the velocity over ground once the vehicle has turned."""
        yaw = radians(self.first_yaw_deg + (self.turn_deg or 0.0))
        return (
            self.north_mps * sin(yaw) + self.east_mps * cos(yaw),
            self.north_mps * cos(yaw) - self.east_mps * sin(yaw),
        )


@dataclass(frozen=True, slots=True)
class HoldPath:
    """The vehicle stays where it is."""


@dataclass(frozen=True, slots=True)
class TakeoffClimb:
    """A hover that takes off: straight up."""


OrderPath = Mission | StraightFlight | StickFlight | HoldPath | TakeoffClimb


def order_path(body: Body, vehicle: VehicleState) -> OrderPath:
    """Return the motion that an order to move asks of a vehicle.

    A nudge of a vehicle without a position, or a mission without waypoints, is a `HoldPath`.
    """
    match body:
        case FlyMission(mission) | FollowPath(mission):
            return mission if mission.waypoints else HoldPath()
        case GoTo():
            return StraightFlight(
                body.target, body.height_above_takeoff_m, body.speed_mps, "the leg to the target"
            )
        case Nudge():
            return _nudge(body, vehicle)
        case VirtualStick():
            return _stick(body, vehicle)
        case Hover():
            return TakeoffClimb()
        case (
            LandNow() | ReturnHome() | HoldPosition() | StartCamera() | StopCamera() | LockCamera()
        ):
            return HoldPath()
        case _ as unknown:
            assert_never(unknown)


def speeds_mps(body: Body) -> Iterator[tuple[str, float]]:
    """Yield the speeds that an order asks for, each with what it is the speed of."""
    match body:
        case FlyMission(mission) | FollowPath(mission):
            for number, waypoint in enumerate(mission.waypoints, start=1):
                yield f"Speed at waypoint {number}", as_sent(waypoint.speed_mps)
        case GoTo() | Nudge():
            yield "Speed", as_sent(body.speed_mps)
        case VirtualStick():
            north_mps, east_mps = as_sent(body.velocity_x_mps), as_sent(body.velocity_y_mps)
            yield "Horizontal stick speed", hypot(north_mps, east_mps)
        case Hover() | LandNow() | ReturnHome() | HoldPosition():
            return
        case StartCamera() | StopCamera() | LockCamera():
            return
        case _ as unknown:
            assert_never(unknown)


def _nudge(body: Nudge, vehicle: VehicleState) -> StraightFlight | HoldPath:
    if vehicle.position.value is None:
        return HoldPath()
    target = moved_m(vehicle.position.value, body.north_m, body.east_m)
    height_m = vehicle.height_above_takeoff_m.value
    end_m = None if height_m is None else height_m + body.up_m
    return StraightFlight(target, end_m, body.speed_mps, "the nudge")


def _stick(body: VirtualStick, vehicle: VehicleState) -> StickFlight:
    first_yaw_deg = 0.0
    turn_deg: float | None = 0.0 if body.frame is StickFrame.GROUND else None
    attitude = vehicle.attitude.value
    if body.frame is StickFrame.BODY and attitude is not None:
        first_yaw_deg = attitude.yaw_deg
        turn_deg = wrap_degrees(as_sent(body.yaw_deg) - first_yaw_deg)
    return StickFlight(
        as_sent(body.velocity_x_mps),
        as_sent(body.velocity_y_mps),
        body.frame,
        first_yaw_deg,
        turn_deg,
        as_sent(body.height_above_takeoff_m),
        as_sent(body.timeout_s),
    )


def as_sent(value: float) -> float:
    """Return the number that the wire's 32-bit float makes of it: what is tiny becomes 0.

    What no such float can hold becomes infinite. Of a greater number it is never less.
    """
    try:
        return float(struct.unpack(">f", struct.pack(">f", value))[0])
    except OverflowError:
        return copysign(inf, value)


def is_stop(command: Command, situation: Situation) -> bool:
    """Return whether an order is a stick that only stops its vehicle, in height too.

    It has no velocity, and requests the vehicle's last known height, within
    `same_height_m`; while its height is unknown, the height that the previous stick requested.
    Any other height is a climb or a descent, and judged as motion. So is what may take off.
    """
    body, vehicle = command.body, situation.vehicle
    if not isinstance(body, VirtualStick) or command.takeoff or vehicle is None:
        return False
    if body.velocity_x_mps != 0.0 or body.velocity_y_mps != 0.0:
        return False
    height_m = vehicle.height_above_takeoff_m.value
    height_m = situation.stick_height_above_takeoff_m if height_m is None else height_m
    if height_m is None:
        return False
    off_m = abs(as_sent(body.height_above_takeoff_m) - height_m)
    return off_m <= situation.settings.fences.same_height_m
