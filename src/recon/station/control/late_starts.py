"""Missions that begin after a stop: the stop is given again.

Theory of operation. An app may take many seconds to upload and start a mission. A stop that comes
meanwhile is confirmed by an aircraft that still hovers, and the mission begins afterwards. The
flight table would read that as the pilot's mission, and the station would send nothing more.

    stop confirmed --telemetry shows a mission, and one was sent at most `takeoff_stop_s` ago that
    telemetry had never shown--> the same stop, as a new order of the station

The new stop is judged, repeated and confirmed like any other. Stops for vehicles that are about to
leave the ground are followed by `takeoff_stops`.
"""

from collections.abc import Iterator

from recon.fleet.flight_table import ModeKind, kind_of
from recon.model.command import EMERGENCY_BODIES, FlyMission, issued_by_station
from recon.model.control import Commanded
from recon.model.event import OperatorOrder
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.station.control.takeoff_stops import was_shown
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station

_STOPPED = (Commanded.HOLD, Commanded.LAND, Commanded.RETURN)


def stops_again(station: Station, serials: tuple[str, ...], now_ns: int) -> Iterator[OperatorOrder]:
    """Yield the stops to give again, without a number: their missions began after them."""
    for serial in serials:
        vehicle = station.fleet.vehicles.get(serial)
        if vehicle is None or station.control(serial).intent.commanded not in _STOPPED:
            continue
        stop = _confirmed_stop(station, serial)
        if stop is None or not _flies_mission(vehicle, stop):
            continue
        mission = _unshown_mission(station, stop, now_ns)
        if mission is not None:
            why = f"the mission of order {mission.command.id} began after the stop"
            yield OperatorOrder(0, stop.command.body, issued_by_station(why), serial)


def _confirmed_stop(station: Station, serial: str) -> OrderRecord | None:
    """Return the hold, landing or return behind a vehicle's intent, once telemetry has shown it."""
    record = station.orders.records.get(station.control(serial).intent.command_id or 0)
    if record is None or not isinstance(record.command.body, EMERGENCY_BODIES):
        return None
    return record if record.follows is None and was_shown(record) else None


def _flies_mission(vehicle: VehicleState, stop: OrderRecord) -> bool:
    """Whether telemetry newer than all that is known of a stop shows a mission flown."""
    mode = vehicle.flight_mode
    if vehicle.is_flying.value is not True or mode.value is None:
        return False
    if (mode.received_at_ns or 0) <= stop.history[-1].at_ns:
        return False
    return kind_of(mode.value, vehicle.gnss_signal_level.value) is ModeKind.WAYPOINT


def _unshown_mission(station: Station, stop: OrderRecord, now_ns: int) -> OrderRecord | None:
    """Return the newest mission before a stop, if it left lately and was never seen flown."""
    late_ns = now_ns - seconds_to_ns(station.settings.takeoff_stop_s)
    for record in reversed(tuple(station.orders.records.values())):
        command = record.command
        is_before = command.issued_at_ns <= stop.command.issued_at_ns
        if command.serial != stop.command.serial or not is_before:
            continue
        if isinstance(command.body, FlyMission) and record.sent is not None:
            is_recent = record.sent.sent_at_ns >= late_ns
            return record if is_recent and not was_shown(record) else None
    return None
