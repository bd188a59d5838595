"""Confirmation of sent commands by telemetry; `flight_table` interprets the flight modes.

An app acknowledges before it acts, so an acknowledgment confirms nothing. Only telemetry received
after the command was sent counts.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from math import atan2, degrees, hypot
from typing import Any

from recon.fleet.flight_table import Instruction, ModeKind, Place, Reading, Verdict, read
from recon.geo.distance import offset_north_east_m
from recon.model.command import (
    Body,
    FlyMission,
    Hover,
    LandNow,
    LockCamera,
    ReturnHome,
    StartCamera,
    StopCamera,
    VirtualStick,
)
from recon.model.geo import LatLon
from recon.model.units import seconds_to_ns, wrap_degrees
from recon.model.vehicle import FlightMode, MissionNumbers, VehicleState, VelocityNed

STANDING_SPEED_MPS = 0.5
"""Speed below which a vehicle counts as hovering: above GNSS velocity noise and gusts."""

MOVING_SPEED_MPS = 0.5
LEG_DIRECTION_TOLERANCE_DEG = 30.0
AT_WAYPOINT_M = 5.0

CAMERA_QUIET_S = 2.0
"""Time without an image after the stop was sent, after which the feed has stopped."""

_INSTRUCTION: dict[type, Instruction] = {
    Hover: Instruction.HOLD_SENT,
    LandNow: Instruction.LAND_SENT,
    ReturnHome: Instruction.RETURN_SENT,
    FlyMission: Instruction.MISSION_SENT,
    VirtualStick: Instruction.STICK_SENT,
}


class Progress(IntEnum):
    """How much of a command telemetry shows as carried out."""

    UNSEEN = 0
    BEGUN = 1
    """Hover: out of mission mode but not yet stationary. Mission: taking off."""
    CONFIRMED = 2
    """Being carried out; not yet complete."""
    COMPLETE = 3
    """Complete."""


@dataclass(frozen=True, slots=True)
class SentContext:
    """State of the vehicle when a command was first sent."""

    sent_at_ns: int
    mode_when_sent: FlightMode | None
    was_flying: bool | None
    mission_id: int | None = None
    """Last reported mission id."""


def progress(body: Body, sent: SentContext, state: VehicleState, now_ns: int) -> Progress:
    """Return the progress that telemetry newer than the command shows (ICD decision 14)."""
    return _CONFIRMATIONS[type(body)](body, sent, state, now_ns)


def reading_of_sent(body: Body, sent: SentContext, state: VehicleState) -> Reading:
    """Return the flight table's reading for a motion order not yet confirmed by telemetry."""
    is_down = _core_is_new(sent, state) and state.is_flying.value is False
    place = Place.GROUND_AT_END if is_down else Place.AT_END
    level = state.gnss_signal_level.value
    return read(_INSTRUCTION[type(body)], _new_mode(sent, state), level, place, sent.mode_when_sent)


def _complete_if(is_seen: bool) -> Progress:
    return Progress.COMPLETE if is_seen else Progress.UNSEEN


def _new_mode(sent: SentContext, state: VehicleState) -> FlightMode | None:
    stamped = state.flight_mode
    is_new = stamped.received_at_ns is not None and stamped.received_at_ns > sent.sent_at_ns
    return stamped.value if is_new else None


def _core_is_new(sent: SentContext, state: VehicleState) -> bool:
    return state.core_received_at_ns is not None and state.core_received_at_ns > sent.sent_at_ns


def _hover(body: Hover, sent: SentContext, state: VehicleState, _now_ns: int) -> Progress:
    if not _has_left(reading_of_sent(body, sent, state)) or not _core_is_new(sent, state):
        return Progress.UNSEEN
    if sent.was_flying is not True and state.is_flying.value is not True:
        return Progress.UNSEEN  # a takeoff by hover still on the ground
    velocity = state.velocity_ned.value
    is_standing = velocity is not None and velocity.speed_mps < STANDING_SPEED_MPS
    return Progress.COMPLETE if is_standing else Progress.BEGUN


def _has_left(reading: Reading) -> bool:
    """Whether it flies no mission, return, landing or sticks (ICD decision 14).

    A pilot mode counts as the pilot's action only when it is new.
    """
    was_so = reading.verdict is Verdict.UNDECIDED and reading.kind in _PILOTED
    return was_so or reading.verdict is Verdict.CARRIED_OUT


_PILOTED = (ModeKind.PILOT, ModeKind.ATTI_GOOD)


def _land(body: LandNow, sent: SentContext, state: VehicleState, _now_ns: int) -> Progress:
    return _until_on_ground(body, sent, state)


def _return_home(
    body: ReturnHome, sent: SentContext, state: VehicleState, _now_ns: int
) -> Progress:
    return _until_on_ground(body, sent, state)


def _until_on_ground(
    body: LandNow | ReturnHome, sent: SentContext, state: VehicleState
) -> Progress:
    if _core_is_new(sent, state) and state.is_flying.value is False:
        return Progress.COMPLETE
    verdict = reading_of_sent(body, sent, state).verdict
    return Progress.CONFIRMED if verdict is Verdict.CARRIED_OUT else Progress.UNSEEN


def _mission(body: FlyMission, sent: SentContext, state: VehicleState, _now_ns: int) -> Progress:
    verdict = reading_of_sent(body, sent, state).verdict
    if verdict is Verdict.CARRIED_OUT:
        return Progress.BEGUN
    if verdict is not Verdict.STARTED:
        return Progress.UNSEEN
    if sent.mode_when_sent not in (None, FlightMode.GPS_WAYPOINT):
        return Progress.CONFIRMED
    agrees = _core_is_new(sent, state) and _is_on_first_leg(body, state)
    return Progress.CONFIRMED if agrees and _is_another(sent, state) else Progress.UNSEEN


def _is_another(sent: SentContext, state: VehicleState) -> bool:
    """Whether the mission flown may be another than when the order was sent.

    A leg of the mission before may agree with the first one of the new mission: without a look at
    MissionID an order that the app ignored would pass for flown.
    """
    if state.mission_numbers is not MissionNumbers.COUNTED:
        return True
    return state.mission_id.value not in (None, 0, sent.mission_id)


def _is_on_first_leg(body: FlyMission, state: VehicleState) -> bool:
    """Whether the vehicle flies towards the first waypoint, or is there and not moving away."""
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


def _stick(body: VirtualStick, sent: SentContext, state: VehicleState, _now_ns: int) -> Progress:
    verdict = reading_of_sent(body, sent, state).verdict
    return Progress.CONFIRMED if verdict is Verdict.CARRIED_OUT else Progress.UNSEEN


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


def _camera_lock(
    body: LockCamera, sent: SentContext, state: VehicleState, _now_ns: int
) -> Progress:
    """Both are as ordered, as the app has read them back since."""
    facts, read_ns = state.app_facts.value, state.app_facts.received_at_ns
    if facts is None or read_ns is None or read_ns <= sent.sent_at_ns:
        return Progress.UNSEEN
    both = (facts.exposure_locked, facts.white_balance_locked)
    return _complete_if(both == (body.is_locked, body.is_locked))


_CONFIRMATIONS: dict[type, Callable[[Any, SentContext, VehicleState, int], Progress]] = {
    Hover: _hover,
    LandNow: _land,
    ReturnHome: _return_home,
    FlyMission: _mission,
    VirtualStick: _stick,
    StartCamera: _camera_start,
    StopCamera: _camera_stop,
    LockCamera: _camera_lock,
}
