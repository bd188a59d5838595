"""What each vehicle was last commanded to do. The only writer of `VehicleControl.intent`.

`mode_tracking` keeps it true to telemetry. After a landing, a pilot's takeover, a failsafe or an
order that failed, a vehicle is commanded nothing.
"""

from recon.fleet.confirmation import STANDING_SPEED_MPS
from recon.fleet.flight_table import AT_END_M, GOOD_GNSS_LEVEL, Instruction, ModeKind, Place
from recon.fleet.mission_progress import distance_to_m
from recon.geo.distance import horizontal_distance_m
from recon.model.command import Body, FlyMission, Hover, LandNow, ReturnHome, VirtualStick
from recon.model.control import Commanded, Intent
from recon.model.replacing import replace
from recon.model.vehicle import VehicleState
from recon.station.state.setpoint_stream import SetpointStream
from recon.station.state.station import Station

_COMMANDED: dict[type, Commanded] = {
    Hover: Commanded.HOLD,
    LandNow: Commanded.LAND,
    ReturnHome: Commanded.RETURN,
    FlyMission: Commanded.MISSION,
    VirtualStick: Commanded.STICK,
}

_SENT: dict[Commanded, Instruction] = {
    Commanded.NOTHING: Instruction.NOTHING,
    Commanded.HOLD: Instruction.HOLD_SENT,
    Commanded.MISSION: Instruction.MISSION_SENT,
    Commanded.STICK: Instruction.STICK_SENT,
    Commanded.RETURN: Instruction.RETURN_SENT,
    Commanded.LAND: Instruction.LAND_SENT,
}
_BEGUN: dict[Commanded, Instruction] = {
    Commanded.NOTHING: Instruction.NOTHING,
    Commanded.HOLD: Instruction.HOLD,
    Commanded.MISSION: Instruction.MISSION,
    Commanded.STICK: Instruction.STICK,
    Commanded.RETURN: Instruction.RETURN,
    Commanded.LAND: Instruction.LAND,
}


def with_intent(station: Station, serial: str, intent: Intent) -> Station:
    """Return the station with a vehicle commanded something else."""
    return station.with_control(serial, intent=intent)


def of_order(command_id: int, body: Body, sent_at_ns: int) -> Intent | None:
    """Return the intent of an order that was sent; None for a camera order."""
    commanded = _COMMANDED.get(type(body))
    if commanded is None:
        return None
    return Intent(
        commanded,
        sent_at_ns,
        command_id,
        mission=body.mission if isinstance(body, FlyMission) else None,
        target_height_above_takeoff_m=(
            body.height_above_takeoff_m if isinstance(body, VirtualStick) else None
        ),
    )


def of_stream(stream: SetpointStream) -> Intent:
    """Return the intent of a steered order."""
    return Intent(
        Commanded.STICK,
        stream.started_at_ns,
        stream.command.id,
        target=stream.goal.target,
        target_height_above_takeoff_m=stream.goal.height_above_takeoff_m,
        speed_mps=stream.goal.speed_mps,
        mission=None if stream.path is None else stream.path.mission,
        passed=0 if stream.path is None else stream.path.index,
    )


def after_stream(
    station: Station, serial: str, command_id: int, commanded: Commanded, now_ns: int
) -> Station:
    """Return the station after a stream ended, unless a newer order has replaced its intent."""
    if station.control(serial).intent.command_id != command_id:
        return station
    return with_intent(station, serial, Intent(commanded, now_ns))


def with_held_place(station: Station, serial: str) -> Station:
    """Return the station with the place known that a vehicle holds, once it hovers there."""
    control, vehicle = station.control(serial), station.fleet.vehicles[serial]
    intent, tracking = control.intent, control.tracking
    if intent.commanded is not Commanded.HOLD or intent.target is not None:
        return station
    velocity = vehicle.velocity_ned.value
    if tracking is None or not tracking.has_begun or velocity is None:
        return station
    if velocity.speed_mps >= STANDING_SPEED_MPS or vehicle.position.value is None:
        return station
    return with_intent(station, serial, replace(intent, target=vehicle.position.value))


def with_passed(station: Station, serial: str, passed: int) -> Station:
    """Return the station with the count of a mission's passed waypoints."""
    intent = station.control(serial).intent
    if passed == intent.passed:
        return station
    return with_intent(station, serial, replace(intent, passed=passed))


def instruction_of(intent: Intent, has_begun: bool) -> Instruction:
    """Return the flight table's row for an intent that telemetry shows begun, or not yet."""
    if not has_begun:
        return _SENT[intent.commanded]
    mission = intent.mission
    if intent.commanded is Commanded.MISSION and mission is not None and mission.land_at_end:
        return Instruction.MISSION_TO_LAND
    return _BEGUN[intent.commanded]


def place_of(intent: Intent, vehicle: VehicleState, kind: ModeKind | None) -> Place | None:
    """Return where a vehicle is for the flight table; None while its position is unknown."""
    is_down = vehicle.is_flying.value is False
    is_at_end = _is_at_end(intent, vehicle, is_down or kind is ModeKind.LANDING)
    if is_at_end is None:
        return None
    if is_down:
        return Place.GROUND_AT_END if is_at_end else Place.GROUND_ELSEWHERE
    return Place.AT_END if is_at_end else Place.ELSEWHERE


def _is_at_end(intent: Intent, vehicle: VehicleState, is_level: bool) -> bool | None:
    position = vehicle.position.value
    if intent.commanded is Commanded.MISSION and intent.mission is not None:
        if position is None:
            return None
        end = intent.mission.waypoints[-1]
        height_m = None if is_level else vehicle.height_above_takeoff_m.value
        is_on_last_leg = intent.passed >= len(intent.mission.waypoints) - 1
        return is_on_last_leg and distance_to_m(end, position, height_m) <= AT_END_M
    if intent.commanded is Commanded.HOLD and intent.target is not None:
        if position is None:
            return None
        level = vehicle.gnss_signal_level.value
        if level is None or level < GOOD_GNSS_LEVEL:
            return True  # with poor satellite reception the position wanders, not the vehicle
        return horizontal_distance_m(intent.target, position) <= AT_END_M
    return True
