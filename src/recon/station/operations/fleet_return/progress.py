"""The stage of each vehicle of a fleet return, read from telemetry and from its orders."""

from dataclasses import replace

from recon.model.command import FollowPath, Hover, Phase
from recon.model.units import seconds_to_ns
from recon.model.vehicle import FlightMode, VehicleState
from recon.station.operations.motion_orders import mission_end_text, newest_motion
from recon.station.operations.settings import ReturnSettings
from recon.station.state.fleet_return_record import ENDED, UNDER_WAY, ReturningVehicle, Stage
from recon.station.state.station import Station

STANDING_MPS = 0.5
FRESH_S = 1.0

_RETURN_MODES = (FlightMode.GPS_WAYPOINT, FlightMode.AUTO_LANDING, FlightMode.CONFIRM_LANDING)
_FLOWN = (Phase.CONFIRMED, Phase.STARTED, Phase.DONE)
_NOT_FLOWN = (
    Phase.REFUSED_BY_STATION,
    Phase.REFUSED_BY_APP,
    Phase.TIMED_OUT,
    Phase.SUPERSEDED,
    Phase.EXPIRED,
    Phase.FAILED,
)


def updated(
    station: Station, member: ReturningVehicle, settings: ReturnSettings, now_ns: int
) -> ReturningVehicle:
    """Return a vehicle at the stage that telemetry and its orders show now."""
    if member.stage in ENDED:
        return member
    vehicle = station.fleet.vehicles.get(member.serial)
    if vehicle is None:
        return member.at(Stage.EXCLUDED, now_ns, "it was removed from the fleet")
    taken = _taken(station, member, now_ns)
    if taken is not None:
        return taken
    if member.stage in UNDER_WAY:
        return _under_way(station, member, vehicle, settings, now_ns)
    broken = _broken(vehicle, member, settings, now_ns)
    if broken is not None:
        return member.at(Stage.EXCLUDED, now_ns, broken)
    if vehicle.is_flying.value is False:
        return member.at(Stage.LANDED, now_ns, "it landed on its own or was landed by its pilot")
    return _stopping(member, vehicle, settings, now_ns)


def is_still_left(station: Station, member: ReturningVehicle) -> bool:
    """Return whether a vehicle excluded still flies, without any order since."""
    vehicle = station.fleet.vehicles.get(member.serial)
    if member.stage is not Stage.EXCLUDED or vehicle is None or vehicle.is_flying.value is False:
        return False
    newest = newest_motion(station, member.serial)
    return newest is None or newest.command.issued_at_ns <= member.since_ns


def _taken(station: Station, member: ReturningVehicle, now_ns: int) -> ReturningVehicle | None:
    """The vehicle released or excluded, if another holder or a newer order controls it."""
    if station.is_stopped(member.serial):
        return member.at(Stage.RELEASED, now_ns, "it is held by an all stop")
    authority = station.control(member.serial).authority
    if authority.holder is not member.role:
        words = f"it is controlled by {authority.holder.value} now ({authority.reason})"
        return member.at(Stage.RELEASED, now_ns, words)
    newest = newest_motion(station, member.serial)
    if newest is None or newest.command.id in (member.hold_id, member.mission_id):
        return None
    command = newest.command
    words = f"replaced by {command.words}"
    if not command.is_own:
        return member.at(Stage.RELEASED, now_ns, words)
    if isinstance(command.body, Hover) and member.stage not in UNDER_WAY:
        return None  # it hovers anyway
    return member.at(Stage.EXCLUDED, now_ns, words)


def _broken(
    vehicle: VehicleState, member: ReturningVehicle, settings: ReturnSettings, now_ns: int
) -> str | None:
    """Why a vehicle that waits is excluded: its connection was interrupted since the call."""
    if vehicle.link_id != member.link_id:
        return "its connection was interrupted since it was called; nothing resumes automatically"
    if not _has_telemetry(vehicle, settings.telemetry_within_s, now_ns):
        return f"no telemetry for {settings.telemetry_within_s:g} s"
    return None


def _stopping(
    member: ReturningVehicle, vehicle: VehicleState, settings: ReturnSettings, now_ns: int
) -> ReturningVehicle:
    if member.stage is not Stage.STOPPING:
        return member
    velocity = vehicle.velocity_ned.value
    is_standing = velocity is not None and velocity.speed_mps < STANDING_MPS
    is_new = (vehicle.core_received_at_ns or 0) > member.since_ns
    mode = vehicle.flight_mode
    is_stopped = (mode.received_at_ns or 0) > member.since_ns and mode.value not in (
        FlightMode.GPS_WAYPOINT,
        FlightMode.GO_HOME,
        FlightMode.JOYSTICK,
        FlightMode.AUTO_LANDING,
    )
    if is_standing and is_new and is_stopped and _has_telemetry(vehicle, FRESH_S, now_ns):
        return member.at(Stage.WAITING, now_ns)
    if now_ns - member.since_ns < seconds_to_ns(settings.stands_within_s):
        return member
    within_s = settings.stands_within_s
    return member.at(Stage.EXCLUDED, now_ns, f"it did not stop within {within_s:g} s of its hold")


def _under_way(
    station: Station,
    member: ReturningVehicle,
    vehicle: VehicleState,
    settings: ReturnSettings,
    now_ns: int,
) -> ReturningVehicle:
    record = station.orders.records.get(member.mission_id or 0)
    if vehicle.is_flying.value is False and (vehicle.core_received_at_ns or 0) > member.since_ns:
        return member.at(Stage.LANDED, now_ns)
    if record is not None and record.phase in _NOT_FLOWN:
        return member.at(Stage.EXCLUDED, now_ns, f"its {mission_end_text(station, record)}")
    if member.stage is not Stage.ORDERED:
        is_steered = record is not None and isinstance(record.command.body, FollowPath)
        if is_steered and vehicle.flight_mode.value is FlightMode.JOYSTICK:
            return replace(member, out_of_mission_since_ns=None)
        return _still_flying(member, vehicle, settings, now_ns)
    is_flown = record is not None and record.phase in _FLOWN
    if is_flown or _is_in_return_mode(vehicle, member):
        return member.at(Stage.FLYING, now_ns)
    return member


def _still_flying(
    member: ReturningVehicle, vehicle: VehicleState, settings: ReturnSettings, now_ns: int
) -> ReturningVehicle:
    """A flight out of its mission that does not land was ended by the pilot, app or aircraft."""
    mode = vehicle.flight_mode
    is_new = (mode.received_at_ns or 0) > member.since_ns
    if not is_new or mode.value is None or mode.value in _RETURN_MODES:
        return replace(member, out_of_mission_since_ns=None)
    since_ns = member.out_of_mission_since_ns
    if since_ns is None:
        return replace(member, out_of_mission_since_ns=now_ns)
    if now_ns - since_ns < seconds_to_ns(settings.hovers_after_s):
        return member
    words = mode.value.name.lower().replace("_", " ")
    return member.at(Stage.EXCLUDED, now_ns, f"its mission ended before it landed ({words})")


def _is_in_return_mode(vehicle: VehicleState, member: ReturningVehicle) -> bool:
    mode = vehicle.flight_mode
    is_new = (mode.received_at_ns or 0) > member.since_ns
    return is_new and mode.value in _RETURN_MODES


def _has_telemetry(vehicle: VehicleState, within_s: float, now_ns: int) -> bool:
    received_ns = vehicle.core_received_at_ns
    return received_ns is not None and now_ns - received_ns <= seconds_to_ns(within_s)
