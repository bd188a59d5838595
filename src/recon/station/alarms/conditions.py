"""The conditions that hold now, derived from the station's state alone.

Theory of operation. A condition is a fact with a key ("battery:SERIAL"), a severity and a sentence.
`raise_alarms` runs every tick: it derives all conditions anew and gives them to the alarm book.

    absent --condition holds for after_s--> active --condition gone--> ended
    ended, not acknowledged --condition holds again--> the same alarm, active
    active, acknowledged --severity rises--> active, not acknowledged
    ended and acknowledged --> removed

Nothing here keeps a state of its own, so an alarm cannot outlive its cause or be lost with an
event; only the book remembers since when a condition holds and who acknowledged it. `after_s`
absorbs what is normal for a moment: an app that has not reported its serial yet, a landing that
waits for the pilot. After a restart the vehicles that are not back yet share one alarm.
"""

from collections.abc import Iterator
from math import ceil

from recon.fleet.settings import FleetSettings
from recon.fleet.state import LinkRecord, staleness
from recon.model.command import Phase
from recon.model.control import AuthorityHolder, Commanded
from recon.model.names import first_names
from recon.model.replacing import replace
from recon.model.units import ns_to_seconds
from recon.model.vehicle import FlightMode, Staleness, VehicleState
from recon.safety.failsafe import battery_critical, battery_low
from recon.station.alarms import (
    app_conditions,
    event_alarms,
    failsafe_conditions,
    flight_conditions,
)
from recon.station.imaging import frames
from recon.station.operations import OPERATIONS
from recon.station.state import alarm_book, orders
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.orders import OrderRecord, interrupted_mission
from recon.station.state.settings import StationSettings
from recon.station.state.station import Station
from recon.station.state.steps import Stepped
from recon.station.traffic import identity_grace, known_traffic

ZONE_ENDS_SOON_S = 60.0
"""Long enough to ask whether the person has left, and to draw the zone again."""

MAX_NAMES = 8
"""An alarm about many vehicles names this many and counts the rest."""


def raise_alarms(station: Station, now_ns: int) -> Stepped:
    """Bring the alarms up to date with the conditions that hold now."""
    kept = station.settings.alarms_kept
    book = alarm_book.update(station.alarms, conditions(station, now_ns), now_ns, kept)
    return replace(station, alarms=book), ()


def conditions(station: Station, now_ns: int) -> Iterator[Condition]:
    """Yield every condition that holds now, with what the failsafe matrix does about it."""
    present = _present(station, now_ns)
    if station.failsafe_state.occurrences:
        present = (failsafe_conditions.with_reaction(station, one, now_ns) for one in present)
    yield from present
    yield from failsafe_conditions.conditions(station, now_ns)


def _present(station: Station, now_ns: int) -> Iterator[Condition]:
    awaited = identity_grace.awaited(station, now_ns)
    yield from _awaited(awaited, station.settings)
    names = {vehicle.serial for vehicle in awaited}
    for vehicle in station.fleet.vehicles.values():
        yield from _identity(vehicle)
        if vehicle.serial not in names and not known_traffic.is_dismissed(station, vehicle):
            yield from _silence(vehicle, now_ns)
        yield from _no_telemetry(vehicle, station.settings.first_telemetry_s)
        yield from _battery(vehicle, station.settings)
        yield from _landing(vehicle, station.settings.landing_wait_s)
        yield from _failsafe(station, vehicle)
        yield from _flight(vehicle, now_ns, station.settings)
        yield from _resumed(station, vehicle)
    for link in station.fleet.unbound_links():
        yield from _not_taken(link, station.settings.fleet)
        yield from _unidentified(link, station.settings.serial_wait_s)
        if link.own_state.is_flying.value is not False:
            yield from _silence(link.own_state, now_ns)
        if link.claimed_serial is None:
            yield from _flight(link.own_state, now_ns, station.settings)
    for name, state in station.watchdog_state.lost.items():
        yield _lost_unidentified(name, state)
    for record in station.orders.tracked:
        yield from _waiting(record)
        yield from _of_order(record)
    yield from event_alarms.fault_conditions(station, now_ns)
    for operation in OPERATIONS:
        yield from operation.conditions(station)
    yield from _watchdogs(station)
    yield from frames.conditions(station)
    yield from _stop_latch(station)
    yield from _temporary_zones(station, now_ns)
    yield from app_conditions.conditions(station)
    yield from _audit(station)
    yield from _record(station)
    for limit, problem in station.link_limits.items():
        yield Condition(f"link_limit:{limit}", Severity.ERROR, "link_limit", "", problem)


def _about(
    vehicle: VehicleState, rule: str, severity: Severity, text: str, after_s: float = 0.0
) -> Condition:
    key = f"{rule}:{vehicle.serial if vehicle.serial is not None else vehicle.link_id}"
    name = vehicle.display_name
    return Condition(
        key, severity, rule, name, f"{name}: {text}", vehicle.serial, vehicle.link_id, after_s
    )


def _identity(vehicle: VehicleState) -> Iterator[Condition]:
    if vehicle.in_conflict:
        links = ", ".join(str(link_id) for link_id in vehicle.rival_link_ids)
        text = (
            f"serial claimed by link {links} while link {vehicle.link_id} still sends telemetry: "
            "only hold, land and return are sent, on all these links. Close the wrong app"
        )
        yield _about(vehicle, "serial_conflict", Severity.ERROR, text)


def _silence(vehicle: VehicleState, now_ns: int) -> Iterator[Condition]:
    tier = staleness(vehicle, now_ns)
    if tier not in (Staleness.LOST, Staleness.SILENT) or vehicle.core_received_at_ns is None:
        return
    age_s = ns_to_seconds(now_ns - vehicle.core_received_at_ns)
    if vehicle.is_flying.value is False:
        text = f"no telemetry for {age_s:.0f} s; it was on the ground: check its companion app"
        yield _about(vehicle, "link_lost", Severity.WARNING, text)
    else:
        text = (
            f"no telemetry for {age_s:.0f} s; it was in flight: check its companion app and keep "
            "clear of its hazard area"
        )
        yield _about(vehicle, "link_lost", Severity.CRITICAL, text)


def _awaited(awaited: tuple[VehicleState, ...], settings: StationSettings) -> Iterator[Condition]:
    """One alarm for all; each vehicle that does not return gets its own later."""
    if not awaited:
        return
    names = first_names([vehicle.display_name for vehicle in awaited], MAX_NAMES)
    text = (
        f"the station was restarted and waits for telemetry of {names}, in flight before; "
        f"for {settings.restart.settle_s:g} s their hazard areas hold no other vehicle"
    )
    yield Condition("restart_waits", Severity.WARNING, "restart_waits", "", text)


def _no_telemetry(vehicle: VehicleState, after_s: float) -> Iterator[Condition]:
    if vehicle.core_received_at_ns is None and vehicle.link_id is not None:
        text = "serial reported, but no telemetry received: check its companion app"
        yield _about(vehicle, "no_telemetry", Severity.WARNING, text, after_s)


def _battery(vehicle: VehicleState, settings: StationSettings) -> Iterator[Condition]:
    """Report the aircraft's own warning and the level: either may be wrong or missing."""
    critical = battery_critical.words(vehicle, settings.serious_battery_fraction)
    low = battery_low.words(vehicle, settings.low_battery_fraction)
    if critical is not None:
        yield _about(vehicle, "battery", Severity.CRITICAL, critical)
    elif low is not None:
        yield _about(vehicle, "battery", Severity.WARNING, low)


def _landing(vehicle: VehicleState, after_s: float) -> Iterator[Condition]:
    waits = vehicle.flight_mode.value is FlightMode.CONFIRM_LANDING
    if waits and vehicle.is_flying.value is True:
        text = "landing waits for confirmation: confirm it in the app or on the controller"
        yield _about(vehicle, "landing_waits", Severity.ERROR, text, after_s)


def _failsafe(station: Station, vehicle: VehicleState) -> Iterator[Condition]:
    """A flight mode that the station did not command, by the flight table."""
    follows = station.control(vehicle.serial).tracking
    if follows is not None and follows.failsafe is not None:
        yield _about(vehicle, "failsafe", Severity.ERROR, follows.failsafe)


def _flight(vehicle: VehicleState, now_ns: int, settings: StationSettings) -> Iterator[Condition]:
    for rule, severity, text, after_s in flight_conditions.conditions(vehicle, now_ns, settings):
        yield _about(vehicle, rule, severity, text, after_s)


def _resumed(station: Station, vehicle: VehicleState) -> Iterator[Condition]:
    """A mission of the station that still runs after its pilot took over and let go."""
    control = station.control(vehicle.serial)
    is_pilots = control.authority.holder is AuthorityHolder.PILOT
    if not is_pilots or vehicle.flight_mode.value is not FlightMode.GPS_WAYPOINT:
        return
    if vehicle.is_flying.value is not True or control.intent.commanded is not Commanded.NOTHING:
        return
    if interrupted_mission(station.orders, vehicle.serial or "") is not None:
        text = (
            "flies a mission again although its pilot took control: it resumed automatically; the "
            "station does not control it: hold it, or let its pilot stop it"
        )
        yield _about(vehicle, "mission_resumed", Severity.CRITICAL, text)


def _stop_latch(station: Station) -> Iterator[Condition]:
    latch = station.stop_latch
    if latch is None:
        return
    names = [v.display_name for v in station.fleet.vehicles.values() if latch.holds(v.serial)]
    which = first_names(names, MAX_NAMES) or "vehicles that connect later"
    text = (
        f"all stop by {latch.by} in force for {which}: only hold, land and return are sent until a "
        "person releases it"
    )
    yield Condition("all_stop", Severity.WARNING, "all_stop", "", text)


def _temporary_zones(station: Station, now_ns: int) -> Iterator[Condition]:
    """Yield each zone in force: other operators must see it, above all shortly before its end."""
    for zone in station.temporary_zones.in_force.values():
        severity, until = Severity.INFO, "until a person ends it"
        if zone.ends_at_ns is not None:
            left_s = ns_to_seconds(zone.ends_at_ns - now_ns)
            until = f"for the next {max(1, ceil(left_s / 60.0))} min"
            if left_s <= ZONE_ENDS_SOON_S:
                severity = Severity.WARNING
                until = "it ends within a minute: draw it again if it is still needed"
        text = f"temporary zone {zone.name} by {zone.by}: {zone.drawn.reason}; {until}"
        yield Condition(f"temporary_zone:{zone.id}", severity, "temporary_zone", "", text)


def _unidentified(link: LinkRecord, after_s: float) -> Iterator[Condition]:
    if link.reported_serial is None and link.own_state.is_flying.value is True:
        text = f"in flight without a serial ({link.remote_address}): check its companion app"
        yield _about(link.own_state, "unidentified", Severity.WARNING, text, after_s)


def _not_taken(link: LinkRecord, settings: FleetSettings) -> Iterator[Condition]:
    if link.rejected_serial is None:
        return
    text = (
        f"serial {link.rejected_serial} not accepted: {settings.vehicles_kept} lost vehicles may "
        f"be in flight, limit {settings.vehicles_kept}: dismiss the hazard areas of those you have "
        "located; until then only hold, land and return are sent on this link"
    )
    yield _about(link.own_state, "no_room", Severity.ERROR, text)


def _lost_unidentified(name: str, state: VehicleState) -> Condition:
    """Ends only when an operator dismisses it: without a serial no telemetry can be matched."""
    if name == known_traffic.MANY_LOST:
        text = (
            f"more than {known_traffic.LOST_KEPT} vehicles without a serial were lost in flight; "
            f"no motion is allowed until all of them are located and {name} is dismissed"
        )
    else:
        text = (
            "telemetry lost in flight, and no serial known; it may be anywhere near its last "
            f"position: locate it, then dismiss {name}"
        )
    return Condition(
        key=f"unidentified_lost:{name}",
        severity=Severity.CRITICAL,
        rule="unidentified_lost",
        vehicle_name=state.display_name,
        text=f"{state.display_name}: {text}",
        link_id=state.link_id,
    )


def _waiting(record: OrderRecord) -> Iterator[Condition]:
    what = _waiting_for(record)
    if what is None:
        return
    name = record.vehicle_name
    yield Condition(
        key=f"stop_waits:{record.command.id}",
        severity=Severity.CRITICAL,
        rule="stop_waits",
        vehicle_name=name,
        text=f"{name}: {what}; use the controller",
        serial=record.command.serial,
        link_id=record.command.link_id,
    )


def _waiting_for(record: OrderRecord) -> str | None:
    """What a stop waits for that is not confirmed, and what the station does meanwhile."""
    is_sent = record.phase in (Phase.SENT, Phase.ACKNOWLEDGED)
    if record.phase is not Phase.QUEUED and not is_sent:
        return None
    if record.follows is not None:
        what = "not confirmed" if is_sent else "not sent yet, it is on the ground"
        return (
            f"stop {what}: it is sent as soon as it is in the air, until telemetry shows it holding"
        )
    if not record.waits_for_telemetry:
        return None
    if is_sent:
        return "stop sent without telemetry, not confirmed: it is sent again when telemetry returns"
    return "stop not sent, no telemetry: it is sent when telemetry returns"


def _of_order(record: OrderRecord) -> Iterator[Condition]:
    """An order that needs attention until telemetry confirms it or a newer order replaces it."""
    if record.alarm is None:
        return
    command = record.command
    is_critical = record.alarm in (orders.UNCONFIRMED, orders.LANDING_STOPPED)
    yield Condition(
        key=f"{record.alarm}:{command.id}",
        severity=Severity.CRITICAL if is_critical else Severity.ERROR,
        rule=record.alarm,
        vehicle_name=record.vehicle_name,
        text=f"{record.vehicle_name}: {command.name.replace('_', ' ')}: {record.note}",
        serial=command.serial,
        link_id=command.link_id,
    )


def _watchdogs(station: Station) -> Iterator[Condition]:
    """The findings of the watchdogs, and whether they may hold vehicles."""
    for kept in station.watchdog_state.findings.values():
        found = kept.finding
        yield Condition(
            key=found.key,
            severity=found.severity,
            rule=found.rule,
            vehicle_name=found.vehicle_name,
            text=found.text,
            serial=found.serial,
            link_id=found.link_id,
            after_s=found.after_s,
        )
    if not station.watchdog_state.is_hold_on:
        by = station.watchdog_state.switched_by
        text = f"separation holds switched off by {by}: vehicles in conflict raise alarms only"
        key = rule = "separation_hold_off"
        yield Condition(key, Severity.WARNING, rule, "", text)


def _audit(station: Station) -> Iterator[Condition]:
    if station.audit_problem is not None:
        yield Condition(
            key="audit",
            severity=Severity.ERROR,
            rule="audit",
            vehicle_name="",
            text=(
                f"{station.audit_problem}. Flying continues, but entries may be lost and a restart "
                "may restore an old state: free disk space or restore the folder"
            ),
        )


def _record(station: Station) -> Iterator[Condition]:
    if station.record_problem is not None:
        text = f"{station.record_problem}. Flying continues: free disk space or restore the folder"
        yield Condition("record", Severity.WARNING, "record", "", text)
