"""When telemetry confirms a command, and when the pilot has taken over.

An app acknowledges before it acts, so an acknowledgment confirms nothing. Only telemetry received
after the command was sent counts.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import atan2, degrees, hypot
from typing import Any

from recon.geo.distance import offset_north_east_m
from recon.model.command import (
    Body,
    FlyMission,
    Hover,
    LandNow,
    ReturnHome,
    StartCamera,
    StopCamera,
    VirtualStick,
)
from recon.model.geo import LatLon
from recon.model.units import seconds_to_ns, wrap_degrees
from recon.model.vehicle import FlightMode, VehicleState

STANDING_SPEED_MPS = 0.5
"""Below this a vehicle counts as standing: GNSS velocity noise and gusts stay under it."""

MOVING_SPEED_MPS = 0.5
LEG_DIRECTION_TOLERANCE_DEG = 30.0
AT_WAYPOINT_M = 5.0

CAMERA_QUIET_S = 2.0
"""No image for this long after a stop was sent: the feed has stopped."""

_COMMANDED_MODES = frozenset(
    {
        FlightMode.AUTO_LANDING,
        FlightMode.GPS_WAYPOINT,
        FlightMode.GO_HOME,
        FlightMode.JOYSTICK,
    }
)
_LANDING_MODES = frozenset({FlightMode.AUTO_LANDING, FlightMode.CONFIRM_LANDING})
_PILOT_MODES = frozenset(
    {
        FlightMode.MANUAL,
        FlightMode.ATTI,
        FlightMode.ATTI_COURSE_LOCK,
        FlightMode.GPS_COURSE_LOCK,
        FlightMode.GPS_HOME_LOCK,
        FlightMode.GPS_SPORT,
        FlightMode.GPS_NOVICE,
        FlightMode.TRIPOD,
    }
)
"""Modes that only a person with the sticks selects. GPS_ATTI is not among them: an app that cancels
a mission passes through it."""


@dataclass(frozen=True, slots=True)
class SentContext:
    """What was known when a command was first sent."""

    sent_at_ns: int
    mode_when_sent: FlightMode | None


def is_confirmed(body: Body, sent: SentContext, state: VehicleState, now_ns: int) -> bool:
    """Return whether telemetry newer than the command shows that it is being carried out."""
    return _CONFIRMATIONS[type(body)](body, sent, state, now_ns)


def pilot_took_over(sent: SentContext, state: VehicleState) -> bool:
    """Return whether the mode changed, after the command, to one that only a pilot selects."""
    mode = _new_mode(sent, state)
    return mode in _PILOT_MODES and mode is not sent.mode_when_sent


def _new_mode(sent: SentContext, state: VehicleState) -> FlightMode | None:
    stamped = state.flight_mode
    is_new = stamped.received_at_ns is not None and stamped.received_at_ns > sent.sent_at_ns
    return stamped.value if is_new else None


def _core_is_new(sent: SentContext, state: VehicleState) -> bool:
    return state.core_received_at_ns is not None and state.core_received_at_ns > sent.sent_at_ns


def _hover(_body: Hover, sent: SentContext, state: VehicleState, _now_ns: int) -> bool:
    mode = _new_mode(sent, state)
    velocity = state.velocity_ned.value
    return (
        mode is not None
        and mode not in _COMMANDED_MODES
        and _core_is_new(sent, state)
        and velocity is not None
        and velocity.speed_mps < STANDING_SPEED_MPS
    )


def _land(_body: LandNow, sent: SentContext, state: VehicleState, _now_ns: int) -> bool:
    has_landed = _core_is_new(sent, state) and state.is_flying.value is False
    return has_landed or _new_mode(sent, state) in _LANDING_MODES


def _return_home(_body: ReturnHome, sent: SentContext, state: VehicleState, _now_ns: int) -> bool:
    return _new_mode(sent, state) is FlightMode.GO_HOME


def _mission(body: FlyMission, sent: SentContext, state: VehicleState, _now_ns: int) -> bool:
    if _new_mode(sent, state) is not FlightMode.GPS_WAYPOINT:
        return False
    if sent.mode_when_sent is not FlightMode.GPS_WAYPOINT:
        return True
    return _core_is_new(sent, state) and _is_on_first_leg(body, state)


def _is_on_first_leg(body: FlyMission, state: VehicleState) -> bool:
    """Whether the vehicle flies towards the first waypoint, or has reached it."""
    position, velocity = state.position.value, state.velocity_ned.value
    if position is None or velocity is None:
        return False
    first = body.mission.waypoints[0]
    north_m, east_m = offset_north_east_m(position, LatLon(first.latitude_deg, first.longitude_deg))
    if hypot(north_m, east_m) < AT_WAYPOINT_M:
        return True
    if hypot(velocity.north_mps, velocity.east_mps) < MOVING_SPEED_MPS:
        return False
    course_deg = degrees(atan2(velocity.east_mps, velocity.north_mps))
    bearing_deg = degrees(atan2(east_m, north_m))
    return abs(wrap_degrees(course_deg - bearing_deg)) < LEG_DIRECTION_TOLERANCE_DEG


def _stick(_body: VirtualStick, sent: SentContext, state: VehicleState, _now_ns: int) -> bool:
    return _new_mode(sent, state) is FlightMode.JOYSTICK


def _camera_start(_body: StartCamera, sent: SentContext, state: VehicleState, _now_ns: int) -> bool:
    received_at_ns = state.image_received_at_ns
    return received_at_ns is not None and received_at_ns > sent.sent_at_ns


def _camera_stop(_body: StopCamera, sent: SentContext, state: VehicleState, now_ns: int) -> bool:
    last_ns = max(sent.sent_at_ns, state.image_received_at_ns or 0)
    return _core_is_new(sent, state) and now_ns - last_ns >= seconds_to_ns(CAMERA_QUIET_S)


_CONFIRMATIONS: dict[type, Callable[[Any, SentContext, VehicleState, int], bool]] = {
    Hover: _hover,
    LandNow: _land,
    ReturnHome: _return_home,
    FlyMission: _mission,
    VirtualStick: _stick,
    StartCamera: _camera_start,
    StopCamera: _camera_stop,
}
