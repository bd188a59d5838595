"""What each vehicle does on the station's word, kept true by telemetry.

The intent of a vehicle is what it was last sent. Waypoints are counted as they are passed. After a
landing, the pilot's takeover, a failsafe or an order that came to nothing, the station has told it
nothing.
"""

from recon.fleet.confirmation import STANDING_SPEED_MPS, SentContext
from recon.fleet.flight_table import AT_END_M, GOOD_GNSS_LEVEL, Instruction, ModeKind, Place
from recon.fleet.mission_progress import distance_to_m, waypoints_passed
from recon.geo.distance import horizontal_distance_m
from recon.model.command import Body, FlyMission, Hover, LandNow, ReturnHome, VirtualStick
from recon.model.intent import Commanded, Intent
from recon.model.replacing import replace
from recon.model.units import ns_to_seconds
from recon.model.vehicle import FlightMode, VehicleState
from recon.station.state.station import Station
from recon.station.state.tracking import Tracking

NOTHING = Intent()

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


def on_sent(
    station: Station, serial: str, command_id: int, body: Body, context: SentContext
) -> Station:
    """Return the station after an order to move or to stop left for a vehicle."""
    commanded = _COMMANDED.get(type(body))
    if commanded is None:
        return station
    intent = Intent(
        commanded,
        context.sent_at_ns,
        command_id,
        mission=body.mission if isinstance(body, FlyMission) else None,
        target_height_above_takeoff_m=(
            body.height_above_takeoff_m if isinstance(body, VirtualStick) else None
        ),
    )
    return _put(station, serial, intent, context.mode_when_sent)


def begun(station: Station, serial: str, command_id: int, body: Body, now_ns: int) -> Station:
    """Return the station after telemetry showed an order carried out: a mission flown, a landing.

    An order that came to nothing and is carried out late is what the vehicle does now.
    """
    if station.intents.get(serial, NOTHING).command_id != command_id:
        station = on_sent(station, serial, command_id, body, SentContext(now_ns, None, None))
    vehicle = station.fleet.vehicles.get(serial)
    following = following_of(station, serial)
    if vehicle is None or following.has_begun:
        return station
    mode = vehicle.flight_mode.value
    follows = replace(
        following,
        has_begun=True,
        mode_before=mode,
        link_id=vehicle.link_id,
        core_at_ns=vehicle.core_received_at_ns,
    )
    return with_following(station, serial, follows)


def holds_here(station: Station, serial: str, now_ns: int) -> Station:
    """Return the station with a vehicle told to hold where it is: its flight is over.

    The place it holds is known when it stands.
    """
    vehicle = station.fleet.vehicles[serial]
    intent = Intent(Commanded.HOLD, now_ns)
    station = _put(station, serial, intent, vehicle.flight_mode.value)
    follows = replace(following_of(station, serial), has_begun=True, link_id=vehicle.link_id)
    return with_following(station, serial, follows)


def stands(station: Station, serial: str) -> Station:
    """Return the station with the place known that a vehicle holds, once it stands there."""
    intent, vehicle = station.intents.get(serial, NOTHING), station.fleet.vehicles[serial]
    is_held = intent.commanded is Commanded.HOLD and following_of(station, serial).has_begun
    velocity = vehicle.velocity_ned.value
    if not is_held or intent.target is not None or velocity is None:
        return station
    if velocity.speed_mps >= STANDING_SPEED_MPS:
        return station
    held = replace(intent, target=vehicle.position.value)
    return replace(station, intents={**station.intents, serial: held})


def follow_anew(station: Station, serial: str) -> Station:
    """Return the station with a vehicle followed by the intent that a stream of sticks gave it."""
    vehicle = station.fleet.vehicles[serial]
    return _put(station, serial, station.intents[serial], vehicle.flight_mode.value)


def let_go(station: Station, serial: str, now_ns: int, *, failsafe: str | None = None) -> Station:
    """Return the station with a vehicle told nothing; `failsafe`: what it does by itself."""
    vehicle = station.fleet.vehicles.get(serial)
    mode = None if vehicle is None else vehicle.flight_mode.value
    kept = {key: intent for key, intent in station.intents.items() if key != serial}
    follows = Tracking(told_at_ns=now_ns, mode_before=mode, failsafe=failsafe)
    return with_following(replace(station, intents=kept), serial, follows)


def told(intent: Intent, following: Tracking) -> Instruction:
    """Return the flight table's row for what a vehicle was told."""
    if not following.has_begun:
        return _SENT[intent.commanded]
    mission = intent.mission
    if mission is not None and mission.land_at_end:
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


def count_passed(station: Station, serial: str) -> Station:
    """Return the station with the waypoints counted that a vehicle has passed by now."""
    intent, following = station.intents.get(serial, NOTHING), following_of(station, serial)
    vehicle = station.fleet.vehicles[serial]
    core_at_ns, position = vehicle.core_received_at_ns, vehicle.position.value
    if intent.mission is None or not following.has_begun or position is None:
        return station
    if core_at_ns is None or core_at_ns == following.core_at_ns:
        return station
    since_ns = following.core_at_ns if following.core_at_ns is not None else intent.since_ns
    height_m, since_s = vehicle.height_above_takeoff_m.value, ns_to_seconds(core_at_ns - since_ns)
    passed = waypoints_passed(intent.mission, intent.passed, position, height_m, since_s)
    station = with_following(station, serial, replace(following, core_at_ns=core_at_ns))
    if passed == intent.passed:
        return station
    return replace(station, intents={**station.intents, serial: replace(intent, passed=passed)})


def following_of(station: Station, serial: str) -> Tracking:
    """Return how a vehicle is followed."""
    return station.trackings.get(serial, _UNFOLLOWED)


_UNFOLLOWED = Tracking()


def with_following(station: Station, serial: str, following: Tracking) -> Station:
    """Return the station with a vehicle followed so."""
    return replace(station, trackings={**station.trackings, serial: following})


def _put(station: Station, serial: str, intent: Intent, mode: FlightMode | None) -> Station:
    follows = Tracking(told_at_ns=intent.since_ns, command_id=intent.command_id, mode_before=mode)
    station = replace(station, intents={**station.intents, serial: intent})
    return with_following(station, serial, follows)


def _is_at_end(intent: Intent, vehicle: VehicleState, is_level: bool) -> bool | None:
    position = vehicle.position.value
    if intent.mission is not None:
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
            return True  # a place that wanders says nothing of the vehicle
        return horizontal_distance_m(intent.target, position) <= AT_END_M
    return True
