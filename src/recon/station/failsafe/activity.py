"""What a vehicle in flight is doing, as the failsafe matrix divides it: by intent and telemetry."""

from dataclasses import replace as exact_replace

from recon.model.control import Commanded, Intent
from recon.model.failsafe_matrix import Activity
from recon.model.replacing import replace
from recon.model.vehicle import FlightMode, VehicleState
from recon.safety.return_missions import leads_home
from recon.station.state.failsafe_state import RemainingMission
from recon.station.state.fleet_return_record import ENDED
from recon.station.state.station import Station

_COMING_DOWN_MODES = frozenset(
    {FlightMode.AUTO_LANDING, FlightMode.CONFIRM_LANDING, FlightMode.GO_HOME}
)
_ACTIVITIES = {
    Commanded.HOLD: Activity.HOLDING,
    Commanded.MISSION: Activity.MISSION,
    Commanded.STICK: Activity.STEERED,
    Commanded.RETURN: Activity.RETURNING,
    Commanded.LAND: Activity.RETURNING,
}


def activity_of(station: Station, vehicle: VehicleState) -> Activity:
    """Return what a vehicle in flight does; any mission in flight is one, commanded or not."""
    serial, mode = vehicle.serial or "", vehicle.flight_mode.value
    if mode in _COMING_DOWN_MODES or _is_called_home(station, serial):
        return Activity.RETURNING
    intent = station.control(serial).intent
    if intent.commanded is Commanded.NOTHING:
        return Activity.MISSION if mode is FlightMode.GPS_WAYPOINT else Activity.HOLDING
    known = station.failsafe_state.remaining.get(serial)
    if known is not None and known.leads_home and _is_of(known, intent):
        return Activity.RETURNING
    return _ACTIVITIES[intent.commanded]


def _is_called_home(station: Station, serial: str) -> bool:
    """Whether a fleet return brings it home, or has it wait for its turn."""
    if station.fleet_return is None:
        return False
    member = station.fleet_return.members.get(serial)
    return member is not None and member.stage not in ENDED


def _is_of(known: RemainingMission, intent: Intent) -> bool:
    return known.mission is intent.mission and known.passed == intent.passed


def with_remaining(station: Station, vehicle: VehicleState) -> Station:
    """Return the station that knows whether the rest of a vehicle's mission leads home."""
    serial = vehicle.serial or ""
    intent, state = station.control(serial).intent, station.failsafe_state
    known = state.remaining.get(serial)
    mission = intent.mission
    if mission is None or not mission.land_at_end:
        if known is None:
            return station
        remaining = {key: value for key, value in state.remaining.items() if key != serial}
    elif known is not None and _is_of(known, intent):
        return station
    else:
        rest = exact_replace(mission, waypoints=mission.waypoints[intent.passed :] or ())
        is_home = bool(rest.waypoints) and leads_home(rest, vehicle, station.airspace)
        remaining = {**state.remaining, serial: RemainingMission(mission, intent.passed, is_home)}
    return replace(station, failsafe_state=replace(state, remaining=remaining))
