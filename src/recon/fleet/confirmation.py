"""When telemetry confirms a command, and when the pilot has taken over.

An app acknowledges before it acts, so an acknowledgment confirms nothing. Only telemetry received
after the command was sent counts.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
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
from recon.model.vehicle import FlightMode, VehicleState, VelocityNed

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
        FlightMode.CONFIRM_LANDING,
    }
)
"""Decision 14 names 9 to 12 for hover; 21 is a landing too, though it stands still at 0.3 m."""

_LANDING_MODES = frozenset({FlightMode.AUTO_LANDING, FlightMode.CONFIRM_LANDING})
_PILOT_MODES = frozenset(
    {
        FlightMode.MANUAL,
        FlightMode.GPS_COURSE_LOCK,
        FlightMode.GPS_HOME_LOCK,
        FlightMode.GPS_SPORT,
        FlightMode.TRIPOD,
    }
)
"""Modes that only a person with the sticks selects. GPS_ATTI is not among them: an app that cancels
a mission passes through it. Nor is GPS_NOVICE: with the beginner setting it stands for GPS_ATTI."""

_FALLBACK_MODES = frozenset({FlightMode.ATTI, FlightMode.ATTI_COURSE_LOCK})
"""Selected by a pilot, but also by the aircraft itself when it loses GNSS."""

GOOD_GNSS_LEVEL = 3
"""From this level on DJI holds position by GNSS: no reason to fall back to ATTI by itself."""


class Progress(IntEnum):
    """How far telemetry shows a command carried out."""

    UNSEEN = 0
    BEGUN = 1
    """Hover: its mode has left the mission; it is not standing yet."""
    CONFIRMED = 2
    """Land: it is landing; the ground is still to be seen."""
    COMPLETE = 3


@dataclass(frozen=True, slots=True)
class SentContext:
    """What was known when a command was first sent."""

    sent_at_ns: int
    mode_when_sent: FlightMode | None
    was_flying: bool | None


def progress(body: Body, sent: SentContext, state: VehicleState, now_ns: int) -> Progress:
    """Return what telemetry newer than the command shows of it (decisions on the ICD, 14)."""
    return _CONFIRMATIONS[type(body)](body, sent, state, now_ns)


def pilot_took_over(sent: SentContext, state: VehicleState) -> bool:
    """Return whether the mode changed, after the command, to one that only a pilot selects."""
    mode = _new_mode(sent, state)
    if mode is sent.mode_when_sent:
        return False
    if mode in _FALLBACK_MODES:
        level = state.gnss_signal_level.value
        return level is not None and level >= GOOD_GNSS_LEVEL
    return mode in _PILOT_MODES


def has_stopped_landing(sent: SentContext, state: VehicleState) -> bool:
    """Return whether a vehicle that was landing flies on in another mode."""
    mode = _new_mode(sent, state)
    return mode is not None and mode not in _LANDING_MODES and state.is_flying.value is not False


def _complete_if(is_seen: bool) -> Progress:
    return Progress.COMPLETE if is_seen else Progress.UNSEEN


def _new_mode(sent: SentContext, state: VehicleState) -> FlightMode | None:
    stamped = state.flight_mode
    is_new = stamped.received_at_ns is not None and stamped.received_at_ns > sent.sent_at_ns
    return stamped.value if is_new else None


def _core_is_new(sent: SentContext, state: VehicleState) -> bool:
    return state.core_received_at_ns is not None and state.core_received_at_ns > sent.sent_at_ns


def _hover(_body: Hover, sent: SentContext, state: VehicleState, _now_ns: int) -> Progress:
    mode = _new_mode(sent, state)
    if mode is None or mode in _COMMANDED_MODES or not _core_is_new(sent, state):
        return Progress.UNSEEN
    if sent.was_flying is not True and state.is_flying.value is not True:
        return Progress.UNSEEN  # a takeoff by hover that has not left the ground
    velocity = state.velocity_ned.value
    is_standing = velocity is not None and velocity.speed_mps < STANDING_SPEED_MPS
    return Progress.COMPLETE if is_standing else Progress.BEGUN


def _land(_body: LandNow, sent: SentContext, state: VehicleState, _now_ns: int) -> Progress:
    if _core_is_new(sent, state) and state.is_flying.value is False:
        return Progress.COMPLETE
    is_landing = _new_mode(sent, state) in _LANDING_MODES
    return Progress.CONFIRMED if is_landing else Progress.UNSEEN


def _return_home(
    _body: ReturnHome, sent: SentContext, state: VehicleState, _now_ns: int
) -> Progress:
    return _complete_if(_new_mode(sent, state) is FlightMode.GO_HOME)


def _mission(body: FlyMission, sent: SentContext, state: VehicleState, _now_ns: int) -> Progress:
    if _new_mode(sent, state) is not FlightMode.GPS_WAYPOINT:
        return Progress.UNSEEN
    if sent.mode_when_sent not in (None, FlightMode.GPS_WAYPOINT):
        return Progress.COMPLETE
    return _complete_if(_core_is_new(sent, state) and _is_on_first_leg(body, state))


def _is_on_first_leg(body: FlyMission, state: VehicleState) -> bool:
    """Whether the vehicle flies towards the first waypoint, or is there and flies no other way."""
    position, velocity = state.position.value, state.velocity_ned.value
    if position is None or velocity is None:
        return False
    first, second = (LatLon(w.latitude_deg, w.longitude_deg) for w in body.mission.waypoints[:2])
    is_at_first = hypot(*offset_north_east_m(position, first)) < AT_WAYPOINT_M
    if hypot(velocity.north_mps, velocity.east_mps) < MOVING_SPEED_MPS:
        return is_at_first
    return _flies_towards(first, position, velocity) or (
        is_at_first and _flies_towards(second, position, velocity)
    )


def _flies_towards(point: LatLon, position: LatLon, velocity: VelocityNed) -> bool:
    north_m, east_m = offset_north_east_m(position, point)
    course_deg = degrees(atan2(velocity.east_mps, velocity.north_mps))
    bearing_deg = degrees(atan2(east_m, north_m))
    return abs(wrap_degrees(course_deg - bearing_deg)) < LEG_DIRECTION_TOLERANCE_DEG


def _stick(_body: VirtualStick, sent: SentContext, state: VehicleState, _now_ns: int) -> Progress:
    return _complete_if(_new_mode(sent, state) is FlightMode.JOYSTICK)


def _camera_start(
    _body: StartCamera, sent: SentContext, state: VehicleState, _now_ns: int
) -> Progress:
    received_at_ns = state.image_received_at_ns
    return _complete_if(received_at_ns is not None and received_at_ns > sent.sent_at_ns)


def _camera_stop(
    _body: StopCamera, sent: SentContext, state: VehicleState, now_ns: int
) -> Progress:
    last_ns = max(sent.sent_at_ns, state.image_received_at_ns or 0)
    is_quiet = now_ns - last_ns >= seconds_to_ns(CAMERA_QUIET_S)
    return _complete_if(_core_is_new(sent, state) and is_quiet)


_CONFIRMATIONS: dict[type, Callable[[Any, SentContext, VehicleState, int], Progress]] = {
    Hover: _hover,
    LandNow: _land,
    ReturnHome: _return_home,
    FlyMission: _mission,
    VirtualStick: _stick,
    StartCamera: _camera_start,
    StopCamera: _camera_stop,
}
