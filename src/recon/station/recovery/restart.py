"""A restart in flight: a fresh station takes over what the recovery snapshot holds.

Theory of operation. A snapshot of the last run is read before the first event. From it come

- order ids: they continue above every id used before, so that none is used twice;
- authority: a pilot keeps it; guidance passes it to the operator, for surveys end with the run;
- vehicles in flight: lost vehicles, with alarm and hazard area, until their telemetry returns or
  an operator dismisses them. A snapshot older than 90 minutes, or from the future, restores none;
- an all stop in force: it stays in force, however old the snapshot, until a person releases it;
- temporary zones: likewise, until a person ends them or their time is over;
- open orders: failed, with an alarm for each vehicle, because their outcome is unknown.

Nothing is sent. For `settle_s` the apps reconnect and one alarm lists the vehicles that are still
missing (`traffic/identity_grace.py`). When a restored vehicle reports again, `recheck` compares
position, height, altitude offset and battery with the snapshot: if they cannot belong to the same
flight, the restored takeoff point is dropped, because every height and every route home depends on
it. If no snapshot can be read, the start continues without one and raises an alarm.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import msgspec

from recon.fleet.airborne import flown
from recon.geo.distance import horizontal_distance_m
from recon.model.command import BODY_NAMES, Body, Command, Phase
from recon.model.control import ControlAuthority, StopLatch
from recon.model.geo import LatLon
from recon.model.trust import Trust
from recon.model.units import Stamped, ns_to_seconds
from recon.model.vehicle import VehicleProfile, VehicleState, VelocityNed
from recon.record.audit.audit import AuditEntry
from recon.station.control import authority, stop_latch, temporary_zones
from recon.station.recovery.snapshot import OrderSnapshot, RecoverySnapshot, restored_zone
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.orders import OrderBook, OrderRecord, PhaseChange
from recon.station.state.settings import RestartSettings
from recon.station.state.station import Station
from recon.station.state.vehicle_control import PositionSnapshot, VehicleSnapshot
from recon.station.traffic.known_traffic import MANY_LOST, with_lost

INTERRUPTED = "the station was restarted during this order; check what the vehicle is doing"
IDS_ROUNDED_TO = 1_000
OWN_IDS_SKIPPED = 100_000
IDS_PER_LOST_RUN = 1_000_000_000
"""Without a readable snapshot, ids start at this times the number of runs in the audit's folder: no
run uses so many."""

_BODIES = {name: kind for kind, name in BODY_NAMES.items()}


@dataclass(frozen=True, slots=True)
class LastRun:
    """What the last run left: its snapshot, None without any, and sentences about files that could
    not be used. `runs_before` is the number of the last run in the audit's folder."""

    snapshot: RecoverySnapshot | None = None
    troubles: tuple[str, ...] = ()
    runs_before: int = 0

    @property
    def first_ids(self) -> tuple[int, int]:
        """The first id for orders (positive), and for the station's own commands (negative).

        The snapshot may be a second old: order ids continue at the next round thousand.
        """
        if self.snapshot is None:
            used = self.runs_before * IDS_PER_LOST_RUN
            return used + 1, -used - 1
        last, own = self.snapshot.last_order_id, self.snapshot.next_own_id
        rounds = (last + IDS_ROUNDED_TO - 1) // IDS_ROUNDED_TO + 1 if last else 0
        return rounds * IDS_ROUNDED_TO + 1, own if own == -1 else own - OWN_IDS_SKIPPED


def restored(station: Station, last_run: LastRun, now_ns: int) -> Station:
    """Return a fresh station with what the last run left."""
    station = replace(station, next_own_id=last_run.first_ids[1])
    station = _with_troubles(station, last_run.troubles, now_ns)
    snapshot = last_run.snapshot
    if snapshot is None:
        return station
    settings = station.settings.restart
    station = stop_latch.restore(station, _stop_latch(snapshot))
    zones = tuple(restored_zone(saved) for saved in snapshot.temporary_zones)
    station = temporary_zones.restore(station, zones, snapshot.next_zone_id, now_ns)
    station = _with_interrupted(station, snapshot, now_ns)
    gone_s = ns_to_seconds(now_ns - snapshot.taken_at_ns)
    if not 0.0 <= gone_s <= settings.forgotten_after_s:
        return station
    flights = _may_still_fly(snapshot.vehicles, now_ns, settings)
    vehicles = {
        serial: _vehicle(flight, serial, station.fleet.profiles.get(serial))
        for serial, flight in flights.items()
    }
    fleet = replace(station.fleet, vehicles={**station.fleet.vehicles, **vehicles})
    # A vehicle without a named holder is the operator's.
    operator = ControlAuthority()
    holders = dict.fromkeys(flights, (operator.holder, "")) | {
        serial: (held.holder, held.holder_name) for serial, held in snapshot.authorities.items()
    }
    for serial, holder in holders.items():
        station = authority.restore(station, serial, *holder, now_ns)
    for serial, flight in flights.items():
        station = station.with_control(serial, restored=flight)
    return replace(
        station,
        fleet=fleet,
        restored_at_ns=now_ns,
        watchdog_state=replace(station.watchdog_state, lost=_lost(snapshot, now_ns, settings)),
    )


def _stop_latch(snapshot: RecoverySnapshot) -> StopLatch | None:
    saved = snapshot.stop_latch
    return None if saved is None else StopLatch(saved.by, saved.at_ns, frozenset(saved.released))


def restart_entries(station: Station) -> Iterator[AuditEntry]:
    """Yield the audit entries of what a restart restored."""
    for serial, control in station.controls.items():
        if control.restored is None:
            continue
        text = f"{_name(station, serial)}: in flight in the last run; lost until telemetry returns"
        yield AuditEntry("vehicle.restored", text, "station", serial, _name(station, serial))
    for key, vehicle in station.watchdog_state.lost.items():
        text = f"{vehicle.display_name}: in flight in the last run, without a serial; lost"
        yield AuditEntry("vehicle.restored", text, details={"name": key})
    for serial, control in station.controls.items():
        if not control.is_taken:
            continue
        name, held = _name(station, serial), control.authority
        details: dict[str, str | int] = {
            "holder": held.holder.value,
            "holder_name": held.holder_name,
            "reason": held.reason,
        }
        text = f"{name}: authority: {held.holder.value}: {held.reason}"
        yield AuditEntry("authority.taken", text, "station", serial, name, details)
    for zone in station.temporary_zones.in_force.values():
        yield temporary_zones.entry("restored", zone, "station")
    for record in station.orders.records.values():
        command, name = record.command, record.vehicle_name
        text = f"{name}: {command.name.replace('_', ' ')}: failed ({record.note})"
        details = {"id": command.id, "phase": record.phase.value, "note": record.note}
        yield AuditEntry("order.failed", text, "station", command.serial, name, details)


def recheck(station: Station, serial: str | None, now_ns: int) -> Station:
    """Return the station after telemetry of a restored vehicle: keep its takeoff point or not."""
    settings, serial = station.settings.restart, serial or ""
    last = station.control(serial).restored
    vehicle = station.fleet.vehicles.get(serial)
    if last is None or vehicle is None or vehicle.core_received_at_ns == last.received_at_ns:
        return station
    station = station.with_control(serial, restored=None)
    mismatch = flight_mismatch(last, vehicle, now_ns, settings)
    if mismatch is None:
        return station
    # The takeoff point of another flight would make every height and every route home wrong.
    unknown = replace(vehicle, takeoff_point=None, altitude_offset_at_takeoff_m=None)
    fleet = replace(station.fleet, vehicles={**station.fleet.vehicles, serial: unknown})
    station = replace(station, fleet=fleet)
    if last.takeoff_point is None or vehicle.is_flying.value is not True:
        return station
    text = f"takeoff point unknown after the restart: {mismatch}; confirm the home point with the "
    return _with_alarm(station, vehicle.serial, vehicle.display_name, text + "pilot", now_ns)


def flight_mismatch(
    last: VehicleSnapshot, vehicle: VehicleState, now_ns: int, settings: RestartSettings
) -> str | None:
    """Return why a vehicle may be on another flight than before the restart; None if it is not."""
    gone_s = ns_to_seconds(now_ns - last.received_at_ns)
    if vehicle.is_flying.value is not True:
        return "not in flight"
    return (
        _position_mismatch(last, vehicle, gone_s, settings)
        or _height_mismatch(last, vehicle, gone_s, settings)
        or _battery_mismatch(last, vehicle, settings)
    )


def _position_mismatch(
    last: VehicleSnapshot, vehicle: VehicleState, gone_s: float, settings: RestartSettings
) -> str | None:
    here = vehicle.position.value
    if last.position is None or here is None:
        return "position unknown"
    moved_m = horizontal_distance_m(_lat_lon(last.position), here)
    limit_m = settings.place_error_m + gone_s * settings.fastest_mps
    if moved_m > limit_m:
        return f"moved {moved_m:.0f} m in {gone_s:.0f} s, at most {limit_m:.0f} m are possible"
    return None


def _height_mismatch(
    last: VehicleSnapshot, vehicle: VehicleState, gone_s: float, settings: RestartSettings
) -> str | None:
    """The height changes in flight; altitude minus height depends on the takeoff point alone."""
    height_m, offset_m = vehicle.height_above_takeoff_m.value, vehicle.altitude_offset_m.value
    last_m, last_offset_m = last.height_above_takeoff_m, last.altitude_offset_m
    if height_m is None or last_m is None or offset_m is None or last_offset_m is None:
        return "height unknown"
    limit_m = settings.height_error_m + gone_s * settings.fastest_climb_mps
    if abs(height_m - last_m) > limit_m:
        return f"height changed from {last_m:.0f} m to {height_m:.0f} m in {gone_s:.0f} s"
    if abs(offset_m - last_offset_m) > settings.height_error_m:
        return "heights refer to another takeoff point"
    return None


def _battery_mismatch(
    last: VehicleSnapshot, vehicle: VehicleState, settings: RestartSettings
) -> str | None:
    now, before = vehicle.battery_fraction.value, last.battery_fraction
    if now is None or before is None:
        return "battery unknown"
    return "battery replaced" if now > before + settings.battery_gain_fraction else None


def _may_still_fly(
    vehicles: Mapping[str, VehicleSnapshot], now_ns: int, settings: RestartSettings
) -> dict[str, VehicleSnapshot]:
    return {
        key: last
        for key, last in vehicles.items()
        if last.is_flying is not False
        and 0.0 <= ns_to_seconds(now_ns - last.received_at_ns) <= settings.forgotten_after_s
    }


def _lost(
    snapshot: RecoverySnapshot, now_ns: int, settings: RestartSettings
) -> Mapping[str, VehicleState]:
    """Return the vehicles without a serial under new names: link ids start again at 1."""
    lost: Mapping[str, VehicleState] = {}
    for key, last in _may_still_fly(snapshot.unidentified, now_ns, settings).items():
        name = key if key == MANY_LOST else f"lost-{len(lost) + 1}"
        profile = VehicleProfile(serial="", name=f"unidentified {name}")
        lost = with_lost(lost, name, _vehicle(last, None, profile))
    return lost


def _vehicle(
    last: VehicleSnapshot, serial: str | None, profile: VehicleProfile | None
) -> VehicleState:
    at_ns = last.received_at_ns
    return VehicleState(
        serial=serial,
        profile=profile,
        is_simulated=last.is_simulated,
        is_flying=Stamped(last.is_flying, at_ns),
        trust=Trust(evidence=flown(at_ns)),
        position=Stamped(_lat_lon_or_none(last.position), at_ns),
        height_above_takeoff_m=Stamped(last.height_above_takeoff_m, at_ns),
        velocity_ned=Stamped(_velocity(last), at_ns),
        battery_fraction=Stamped(last.battery_fraction, at_ns),
        altitude_offset_m=Stamped(last.altitude_offset_m, at_ns),
        altitude_offset_at_takeoff_m=last.altitude_offset_at_takeoff_m,
        takeoff_point=_lat_lon_or_none(last.takeoff_point),
        core_received_at_ns=at_ns,
    )


def _velocity(last: VehicleSnapshot) -> VelocityNed | None:
    north, east = last.velocity_north_mps, last.velocity_east_mps
    down = last.velocity_down_mps
    return None if north is None or east is None or down is None else VelocityNed(north, east, down)


def _with_interrupted(station: Station, snapshot: RecoverySnapshot, now_ns: int) -> Station:
    """Record the open orders of the last run as failed, with an alarm for each vehicle."""
    for order in snapshot.orders:
        record = _interrupted(order, now_ns)
        if record is None:
            continue
        records = {**station.orders.records, order.id: record}
        station = replace(station, orders=OrderBook(records))
        station = _with_alarm(station, order.serial, order.vehicle_name, INTERRUPTED, now_ns)
    return station


def _with_troubles(station: Station, troubles: tuple[str, ...], now_ns: int) -> Station:
    """Return the station with one alarm about snapshot files that could not be used."""
    if not troubles:
        return station
    text = (
        f"{'; '.join(troubles)}. Confirm with the pilots which vehicles are in the air before you "
        "give orders"
    )
    condition = Condition("recovery_snapshot", Severity.ERROR, "restarted", "", text)
    return station.with_alarm(condition, now_ns)


def _with_alarm(station: Station, serial: str | None, name: str, text: str, now_ns: int) -> Station:
    condition = Condition(
        key=f"restarted:{serial}:{text[:20]}",
        severity=Severity.ERROR,
        rule="restarted",
        vehicle_name=name,
        text=f"{name}: {text}",
        serial=serial,
    )
    return station.with_alarm(condition, now_ns)


def _interrupted(order: OrderSnapshot, now_ns: int) -> OrderRecord | None:
    """Return the order as failed; None when its body is not of the type it names."""
    try:
        body: Body = msgspec.convert(order.body, _BODIES[order.order])
    except (KeyError, msgspec.ValidationError):
        return None
    command = Command(
        id=order.id,
        body=body,
        issued_by=order.issued_by,
        issued_at_ns=order.issued_at_ns,
        expires_at_ns=order.issued_at_ns,
        serial=order.serial,
        # Link ids start again at 1: the old one would name another connection.
        link_id=None,
        takeoff=order.takeoff,
    )
    before = PhaseChange(order.phase, order.issued_at_ns, "in the last run")
    failed = PhaseChange(Phase.FAILED, now_ns, INTERRUPTED)
    return OrderRecord(command, order.vehicle_name, (before, failed))


def _name(station: Station, serial: str) -> str:
    known = station.fleet.vehicles.get(serial) or station.fleet.profiles.get(serial)
    return serial if known is None else known.display_name


def _lat_lon(point: PositionSnapshot) -> LatLon:
    return LatLon(point.latitude_deg, point.longitude_deg)


def _lat_lon_or_none(point: PositionSnapshot | None) -> LatLon | None:
    return None if point is None else _lat_lon(point)
