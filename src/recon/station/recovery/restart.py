"""A start after the station ended in mid-flight: what was known is known again, nothing is ordered.

Restored from the last run's audit: the numbers of orders go on, so none is used twice; who led
each vehicle (a pilot stays, what guidance led is the operator's); vehicles that flew, as lost ones,
until they are heard or somebody says where they are; orders that were under way, as failed. A
vehicle's takeoff point is believed again only when its own telemetry shows the same flight.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from recon.geo.distance import horizontal_distance_m
from recon.model.authority import AuthorityHolder, ControlAuthority
from recon.model.command import Command, Phase
from recon.model.geo import LatLon
from recon.model.stamped import Stamped
from recon.model.units import ns_to_seconds
from recon.model.vehicle import VehicleProfile, VehicleState, VelocityNed
from recon.record.audit import AuditEntry
from recon.station.audit.unidentified_snapshots import restored_entries
from recon.station.audit.vehicle_snapshots import RESTORED_KIND, sighting_entry
from recon.station.recovery.last_run import LastRun, OpenOrder
from recon.station.state import alarm_book
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.orders import OrderBook, OrderRecord, PhaseChange
from recon.station.state.recovery_settings import RestartSettings
from recon.station.state.station import Station
from recon.station.state.vehicle_snapshot import Place, VehicleSnapshot
from recon.station.traffic.known_traffic import MANY_LOST, with_lost

INTERRUPTED = "the station was restarted; look what the vehicle does"
IDS_ROUNDED_TO = 1_000
OWN_IDS_SKIPPED = 100_000


def first_ids(last: LastRun) -> tuple[int, int]:
    """Return the first number for orders, and for the station's own, that no run has used.

    The last entries before a power failure may be missing: so the next round thousand.
    """
    rounds = (last.last_id + IDS_ROUNDED_TO - 1) // IDS_ROUNDED_TO + 1 if last.last_id else 0
    own = last.least_own_id - OWN_IDS_SKIPPED if last.least_own_id else 0
    return rounds * IDS_ROUNDED_TO + 1, own - 1


def restored(station: Station, last: LastRun, now_ns: int) -> Station:
    """Return a fresh station with what the last run knew."""
    settings = station.settings.restart
    station = replace(station, next_own_id=first_ids(last)[1])
    if last.last_at_ns is None:
        return station
    gone_s = ns_to_seconds(now_ns - last.last_at_ns)
    if not 0.0 <= gone_s <= settings.forgotten_after_s:
        return _with_interrupted(station, last, now_ns)
    flights = _may_still_fly(last.sightings, now_ns, settings)
    seen = {
        serial: _vehicle(s, serial, station.fleet.profiles.get(serial))
        for serial, s in flights.items()
    }
    fleet = replace(station.fleet, vehicles={**station.fleet.vehicles, **seen})
    # Who flew before was led by somebody: the operator, unless the audit names another.
    known = dict.fromkeys(flights, (AuthorityHolder.OPERATOR, "")) | dict(last.authorities)
    authorities = {serial: _authority(*authority, now_ns) for serial, authority in known.items()}
    station = replace(
        station,
        fleet=fleet,
        authorities={**station.authorities, **authorities},
        restored_flights=flights,
        restored_at_ns=now_ns,
        watchdog_state=replace(station.watchdog_state, lost=_lost(last, now_ns, settings)),
    )
    return _with_interrupted(station, last, now_ns)


def restart_entries(station: Station) -> Iterator[AuditEntry]:
    """Yield what a restored station tells the audit, so that the next start knows it too."""
    for serial, vehicle in station.fleet.vehicles.items():
        if serial in station.restored_flights:
            text = "flew when the last run saw it last; lost until it is heard"
            yield sighting_entry(RESTORED_KIND, text, station, vehicle)
    yield from restored_entries(station)
    for serial, authority in station.authorities.items():
        name = _name(station, serial)
        who = {
            "holder": authority.holder.value,
            "holder_name": authority.holder_name,
            "reason": authority.reason,
        }
        text = f"{name}: is led by the {authority.holder.value}: {authority.reason}"
        yield AuditEntry("authority.taken", text, "station", serial, name, who)
    for record in station.orders.records.values():
        command = record.command
        text = f"{record.vehicle_name}: {command.name.replace('_', ' ')}: failed ({record.note})"
        details: dict[str, str | int] = {
            "id": command.id,
            "phase": record.phase.value,
            "note": record.note,
        }
        yield AuditEntry(
            "order.failed", text, "station", command.serial, record.vehicle_name, details
        )


def recheck(station: Station, serial: str | None, now_ns: int) -> Station:
    """Return the station once a restored vehicle has been heard: its home is believed or not."""
    settings, serial = station.settings.restart, serial or ""
    sighting = station.restored_flights.get(serial)
    vehicle = station.fleet.vehicles.get(serial)
    if sighting is None or vehicle is None or vehicle.core_received_at_ns == sighting.heard_ns:
        return station
    left = {key: s for key, s in station.restored_flights.items() if key != serial}
    station = replace(station, restored_flights=left)
    doubt = another_flight(sighting, vehicle, now_ns, settings)
    if doubt is None:
        return station
    # A home that belongs to another flight would put every height and every way home wrong.
    doubted = replace(vehicle, takeoff_point=None, altitude_offset_at_takeoff_m=None)
    fleet = replace(station.fleet, vehicles={**station.fleet.vehicles, serial: doubted})
    station = replace(station, fleet=fleet)
    if sighting.home is None or vehicle.is_flying.value is not True:
        return station
    return _note(station, vehicle, f"its takeoff point is not known any more: {doubt}", now_ns)


def another_flight(
    sighting: VehicleSnapshot, vehicle: VehicleState, now_ns: int, settings: RestartSettings
) -> str | None:
    """Return why a vehicle may not be on the flight it was seen on; None when all agrees."""
    gone_s = ns_to_seconds(now_ns - sighting.heard_ns)
    if vehicle.is_flying.value is not True:
        return "it does not fly"
    return (
        _place_doubt(sighting, vehicle, gone_s, settings)
        or _height_doubt(sighting, vehicle, gone_s, settings)
        or _battery_doubt(sighting, vehicle, settings)
    )


def _place_doubt(
    sighting: VehicleSnapshot, vehicle: VehicleState, gone_s: float, settings: RestartSettings
) -> str | None:
    here = vehicle.position.value
    if sighting.place is None or here is None:
        return "its place is unknown"
    far_m = horizontal_distance_m(_lat_lon(sighting.place), here)
    if far_m > settings.place_error_m + gone_s * settings.fastest_mps:
        return f"it is {far_m:.0f} m from where it was seen {gone_s:.0f} s ago"
    return None


def _height_doubt(
    sighting: VehicleSnapshot, vehicle: VehicleState, gone_s: float, settings: RestartSettings
) -> str | None:
    """Height above takeoff moves on; altitude minus it belongs to the takeoff point, and stays."""
    height_m, offset_m = vehicle.height_above_takeoff_m.value, vehicle.altitude_offset_m.value
    then_m, offset_then_m = sighting.height_above_takeoff_m, sighting.altitude_offset_m
    if height_m is None or then_m is None or offset_m is None or offset_then_m is None:
        return "its height is unknown"
    if abs(height_m - then_m) > settings.height_error_m + gone_s * settings.fastest_climb_mps:
        return f"it is at {height_m:.0f} m and was at {then_m:.0f} m {gone_s:.0f} s ago"
    if abs(offset_m - offset_then_m) > settings.height_error_m:
        return "its heights have another takeoff point"
    return None


def _battery_doubt(
    sighting: VehicleSnapshot, vehicle: VehicleState, settings: RestartSettings
) -> str | None:
    now, then = vehicle.battery_fraction.value, sighting.battery_fraction
    if now is None or then is None:
        return "its battery is unknown"
    return "its battery was changed" if now > then + settings.battery_gain_fraction else None


def _may_still_fly(
    sightings: Mapping[str, VehicleSnapshot], now_ns: int, settings: RestartSettings
) -> dict[str, VehicleSnapshot]:
    return {
        key: sighting
        for key, sighting in sightings.items()
        if sighting.is_flying is not False
        and 0.0 <= ns_to_seconds(now_ns - sighting.heard_ns) <= settings.forgotten_after_s
    }


def _lost(last: LastRun, now_ns: int, settings: RestartSettings) -> Mapping[str, VehicleState]:
    """What flew without a serial, under new names: links are numbered anew."""
    lost: Mapping[str, VehicleState] = {}
    for key, sighting in _may_still_fly(last.unidentified, now_ns, settings).items():
        name = key if key == MANY_LOST else f"lost-{len(lost) + 1}"
        profile = VehicleProfile(serial="", name=f"unidentified {name}")
        lost = with_lost(lost, name, _vehicle(sighting, None, profile))
    return lost


def _vehicle(
    sighting: VehicleSnapshot, serial: str | None, profile: VehicleProfile | None
) -> VehicleState:
    at_ns = sighting.heard_ns
    return VehicleState(
        serial=serial,
        profile=profile,
        is_simulated=sighting.is_simulated,
        is_flying=Stamped(sighting.is_flying, at_ns),
        position=Stamped(_lat_lon_or_none(sighting.place), at_ns),
        height_above_takeoff_m=Stamped(sighting.height_above_takeoff_m, at_ns),
        velocity_ned=Stamped(_velocity(sighting), at_ns),
        battery_fraction=Stamped(sighting.battery_fraction, at_ns),
        altitude_offset_m=Stamped(sighting.altitude_offset_m, at_ns),
        altitude_offset_at_takeoff_m=sighting.altitude_offset_at_takeoff_m,
        takeoff_point=_lat_lon_or_none(sighting.home),
        core_received_at_ns=at_ns,
    )


def _velocity(sighting: VehicleSnapshot) -> VelocityNed | None:
    parts = (
        sighting.velocity_north_mps,
        sighting.velocity_east_mps,
        sighting.velocity_down_mps,
    )
    north, east, down = parts
    return None if north is None or east is None or down is None else VelocityNed(north, east, down)


def _authority(holder: AuthorityHolder, holder_name: str, now_ns: int) -> ControlAuthority:
    if holder is AuthorityHolder.GUIDANCE:
        reason = "the station's planning led it until the station was restarted"
        return ControlAuthority(AuthorityHolder.OPERATOR, "", now_ns, reason)
    reason = f"the {holder.value} led it when the station was restarted"
    return ControlAuthority(holder, holder_name, now_ns, reason)


def _with_interrupted(station: Station, last: LastRun, now_ns: int) -> Station:
    """Put the orders that were under way into the book, as failed, with an alarm each vehicle."""
    records: dict[int, OrderRecord] = dict(station.orders.records)
    book = station.alarms
    for order in last.orders.values():
        records[order.id] = _interrupted(order, now_ns)
        condition = _condition(order.serial, order.vehicle, INTERRUPTED)
        book = alarm_book.note(book, condition, now_ns, station.settings.alarms_kept)
    return replace(station, orders=OrderBook(records), alarms=book)


def _note(station: Station, vehicle: VehicleState, text: str, now_ns: int) -> Station:
    condition = _condition(vehicle.serial, vehicle.display_name, text)
    book = alarm_book.note(station.alarms, condition, now_ns, station.settings.alarms_kept)
    return replace(station, alarms=book)


def _condition(serial: str | None, name: str, text: str) -> Condition:
    return Condition(
        key=f"restarted:{serial}:{text[:20]}",
        severity=Severity.ERROR,
        rule="restarted",
        vehicle_name=name,
        text=f"{name}: {text}",
        serial=serial,
    )


def _interrupted(order: OpenOrder, now_ns: int) -> OrderRecord:
    command = Command(
        id=order.id,
        body=order.body,
        issued_by=order.by,
        issued_at_ns=order.given_at_ns,
        expires_at_ns=order.given_at_ns,
        serial=order.serial,
        # Links are numbered anew: an old number would name another connection.
        link_id=None,
        takeoff=order.takeoff,
    )
    was = PhaseChange(order.phase, order.given_at_ns, "in the run before")
    failed = PhaseChange(Phase.FAILED, now_ns, INTERRUPTED)
    return OrderRecord(command, order.vehicle, (was, failed))


def _name(station: Station, serial: str) -> str:
    known: Mapping[str, VehicleState] = station.fleet.vehicles
    vehicle, profile = known.get(serial), station.fleet.profiles.get(serial)
    named = vehicle or profile
    return serial if named is None else named.display_name


def _lat_lon(place: Place) -> LatLon:
    return LatLon(place.latitude_deg, place.longitude_deg)


def _lat_lon_or_none(place: Place | None) -> LatLon | None:
    return None if place is None else _lat_lon(place)
