"""What is wrong now, worked out from the station's state alone."""

from collections.abc import Iterator

from recon.fleet.settings import FleetSettings
from recon.fleet.state import LinkRecord, staleness
from recon.model.command import Phase
from recon.model.replacing import replace
from recon.model.units import ns_to_seconds
from recon.model.vehicle import BatteryWarning, FlightMode, Staleness, VehicleState
from recon.station.alarms import station_faults
from recon.station.imaging import frames
from recon.station.operations import OPERATIONS
from recon.station.state import alarm_book, orders
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.orders import OrderRecord
from recon.station.state.settings import StationSettings
from recon.station.state.station import Station
from recon.station.state.stepped import Stepped
from recon.station.traffic import identity_grace, known_traffic

NAMES_TOLD = 8
"""Of many vehicles an alarm names this many and counts the rest."""


def raise_alarms(station: Station, now_ns: int) -> Stepped:
    """Bring the alarms up to date with the conditions that hold now."""
    kept = station.settings.alarms_kept
    book = alarm_book.update(station.alarms, conditions(station, now_ns), now_ns, kept)
    return replace(station, alarms=book), ()


def conditions(station: Station, now_ns: int) -> Iterator[Condition]:
    """Yield every condition that holds now."""
    awaited = identity_grace.awaited(station, now_ns)
    yield from _awaited(awaited, station.settings)
    names = {vehicle.serial for vehicle in awaited}
    for vehicle in station.fleet.vehicles.values():
        yield from _identity(vehicle)
        if vehicle.serial not in names and not known_traffic.is_dismissed(station, vehicle):
            yield from _silence(vehicle, now_ns)
        yield from _never_heard(vehicle, station.settings.first_telemetry_s)
        yield from _battery(vehicle, station.settings)
        yield from _landing(vehicle, station.settings.landing_wait_s)
        yield from _by_itself(station, vehicle)
    for link in station.fleet.unbound_links():
        yield from _not_taken(link, station.settings.fleet)
        yield from _unidentified(link, station.settings.serial_wait_s)
        if link.own_state.is_flying.value is not False:
            yield from _silence(link.own_state, now_ns)
    for name, state in station.watchdog_state.lost.items():
        yield _lost_unidentified(name, state)
    for record in station.orders.tracked:
        yield from _waiting(record)
        yield from _of_order(record)
    yield from station_faults.conditions(station, now_ns)
    for operation in OPERATIONS:
        yield from operation.conditions(station)
    yield from _watch(station)
    yield from frames.conditions(station)
    yield from _audit(station)


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
            f"link {links} claims the same serial while link {vehicle.link_id} still speaks; "
            "only hold, land and return are sent, to all of them"
        )
        yield _about(vehicle, "serial_conflict", Severity.ERROR, text)


def _silence(vehicle: VehicleState, now_ns: int) -> Iterator[Condition]:
    tier = staleness(vehicle, now_ns)
    if tier not in (Staleness.LOST, Staleness.SILENT) or vehicle.core_received_at_ns is None:
        return
    age_s = ns_to_seconds(now_ns - vehicle.core_received_at_ns)
    if vehicle.is_flying.value is False:
        text = f"no telemetry for {age_s:.0f} s; it was on the ground"
        yield _about(vehicle, "link_lost", Severity.WARNING, text)
    else:
        text = f"no telemetry for {age_s:.0f} s; it may be anywhere near its last place"
        yield _about(vehicle, "link_lost", Severity.CRITICAL, text)


def _awaited(awaited: tuple[VehicleState, ...], settings: StationSettings) -> Iterator[Condition]:
    """One alarm for all: each gets its own if it does not come back."""
    if not awaited:
        return
    names = ", ".join(vehicle.display_name for vehicle in awaited[:NAMES_TOLD])
    others = len(awaited) - NAMES_TOLD
    more = f" and {others} more" if others > 0 else ""
    text = (
        f"the station was restarted and waits to hear {names}{more}, which flew when it ended; "
        f"for {settings.restart.settle_s:g} s nobody is held because of where they may be"
    )
    yield Condition("restart_waits", Severity.WARNING, "restart_waits", "", text)


def _never_heard(vehicle: VehicleState, after_s: float) -> Iterator[Condition]:
    if vehicle.core_received_at_ns is None and vehicle.link_id is not None:
        text = "its app has said its serial but never where it is or whether it flies"
        yield _about(vehicle, "no_telemetry", Severity.WARNING, text, after_s)


def _battery(vehicle: VehicleState, settings: StationSettings) -> Iterator[Condition]:
    """The aircraft's own warning and the level both count: either may be wrong or missing."""
    warning = vehicle.battery_warning.value
    level = vehicle.battery_fraction.value
    left = 1.0 if level is None or vehicle.is_flying.value is False else level
    if warning is BatteryWarning.SERIOUS:
        text = "the aircraft warns of a seriously low battery"
        yield _about(vehicle, "battery", Severity.CRITICAL, text)
    elif left <= settings.serious_battery_fraction:
        yield _about(vehicle, "battery", Severity.CRITICAL, f"its battery is at {left:.0%}")
    elif warning is BatteryWarning.LOW:
        text = "the aircraft warns of a low battery"
        yield _about(vehicle, "battery", Severity.WARNING, text)
    elif left <= settings.low_battery_fraction:
        yield _about(vehicle, "battery", Severity.WARNING, f"its battery is at {left:.0%}")


def _landing(vehicle: VehicleState, after_s: float) -> Iterator[Condition]:
    waits = vehicle.flight_mode.value is FlightMode.CONFIRM_LANDING
    if waits and vehicle.is_flying.value is True:
        text = "its landing waits for confirmation in the app or by the pilot"
        yield _about(vehicle, "landing_waits", Severity.ERROR, text, after_s)


def _by_itself(station: Station, vehicle: VehicleState) -> Iterator[Condition]:
    """What the aircraft does that nobody here ordered, by the flight table."""
    follows = station.control(vehicle.serial).tracking
    if follows is not None and follows.failsafe is not None:
        yield _about(vehicle, "failsafe", Severity.ERROR, follows.failsafe)


def _unidentified(link: LinkRecord, after_s: float) -> Iterator[Condition]:
    if link.claimed_serial is None and link.own_state.is_flying.value is True:
        text = f"a vehicle without a serial is flying ({link.remote_address})"
        yield _about(link.own_state, "unidentified", Severity.WARNING, text, after_s)


def _not_taken(link: LinkRecord, settings: FleetSettings) -> Iterator[Condition]:
    if link.rejected_serial is None:
        return
    text = (
        f"its app says it is {link.rejected_serial}, but {settings.vehicles_kept} vehicles that "
        "may fly are not heard, and no other is taken in: dismiss those whose place you know; "
        "until then it can only be told to hold, land or return"
    )
    yield _about(link.own_state, "no_room", Severity.ERROR, text)


def _lost_unidentified(name: str, state: VehicleState) -> Condition:
    """It ends with a person's word alone: nobody would know the vehicle if it were heard again."""
    if name == known_traffic.MANY_LOST:
        text = (
            f"more than {known_traffic.LOST_KEPT} vehicles without a serial were lost in flight; "
            f"no motion is allowed until all of them are located and {name} is dismissed"
        )
    else:
        text = (
            "a vehicle without a serial was flying when it was last heard; it may be anywhere near "
            f"its last place: dismiss {name} when you have seen where it is"
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
    if not record.waits_to_be_heard or record.phase is not Phase.QUEUED:
        return
    name = record.vehicle_name
    yield Condition(
        key=f"stop_waits:{record.command.id}",
        severity=Severity.CRITICAL,
        rule="stop_waits",
        vehicle_name=name,
        text=f"{name}: a stop waits until the vehicle is heard again",
        serial=record.command.serial,
        link_id=record.command.link_id,
    )


def _of_order(record: OrderRecord) -> Iterator[Condition]:
    """An order that a person must look after, until telemetry shows it or a newer one comes."""
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


def _watch(station: Station) -> Iterator[Condition]:
    """What the watchdogs found, and whether their findings may hold vehicles."""
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
        text = "vehicles in conflict are not held, only alarmed about: holding is switched off"
        by = f" by {station.watchdog_state.switched_by}"
        key = rule = "separation_hold_off"
        yield Condition(key, Severity.WARNING, rule, "", f"{text}{by}")


def _audit(station: Station) -> Iterator[Condition]:
    if station.audit_problem is not None:
        yield Condition(
            key="audit",
            severity=Severity.ERROR,
            rule="audit",
            vehicle_name="",
            text=f"{station.audit_problem}; flying goes on, the record of it has a gap",
        )
