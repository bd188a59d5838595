"""Alarms that begin with an event: an app's message, a fault, a time the station did not run.

They stay until an operator acknowledges them. A fault's alarm is critical while the fault recurs.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from recon.model.event import (
    ClockGap,
    CommandAnswered,
    GuardActed,
    LoginRefused,
    StationFaulted,
    UsersChanged,
)
from recon.model.replacing import replace
from recon.model.report import MessageReport, MessageSeverity
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.station import Fault, Station
from recon.station.state.steps import Stepped

_SEVERITIES = {
    MessageSeverity.WARNING: Severity.WARNING,
    MessageSeverity.ERROR: Severity.ERROR,
}


def on_message(
    station: Station, vehicle: VehicleState, report: MessageReport, now_ns: int
) -> Stepped:
    """Note a warning or an error, unless its app has too many that are not acknowledged."""
    severity = _SEVERITIES.get(report.severity)
    source = vehicle.serial if vehicle.serial is not None else f"link {vehicle.link_id}"
    if severity is None or _unacknowledged(station, source) >= station.settings.app_messages_kept:
        return station, ()
    condition = Condition(
        key=f"app:{source}:{report.text}",
        severity=severity,
        rule="app_message",
        vehicle_name=vehicle.display_name,
        text=f"{vehicle.display_name}: message from its app: {report.text}",
        serial=vehicle.serial,
        link_id=vehicle.link_id,
    )
    return station.with_alarm(condition, now_ns), ()


def _unacknowledged(station: Station, source: str) -> int:
    alarms = station.alarms.alarms.values()
    return sum(alarm.condition.key.startswith(f"app:{source}:") for alarm in alarms)


STATION_NAME = "Station"
FAULT_TO_DO = "hold or land doubtful vehicles with their controllers, then restart the station"


@dataclass(frozen=True, slots=True)
class FaultSettings:
    """Limits for the alarms of faults."""

    lasts_s: float = 10.0
    """A fault that has not recurred for this long has ended."""

    kept: int = 32
    """Different faults shown at once."""


FAULT_SETTINGS = FaultSettings()


def note_fault(station: Station, event: StationFaulted, now_ns: int) -> Station:
    """Return the station with a fault recorded."""
    first = station.faults.get(event.where)
    since_ns = now_ns if first is None else first.since_ns
    recent = {fault.where: fault for fault in _present(station, now_ns)}
    recent.pop(event.where, None)
    kept = dict(list(recent.items())[-(FAULT_SETTINGS.kept - 1) :])
    fault = Fault(event.where, event.what, since_ns, now_ns)
    return replace(station, faults={**kept, event.where: fault})


def note_gap(station: Station, event: ClockGap, now_ns: int) -> Station:
    """Return the station with an alarm that it did not run for a while."""
    text = (
        f"{STATION_NAME} was suspended for {event.seconds:.0f} s and knows nothing of that time: "
        "check every vehicle before you give orders, and keep the computer awake"
    )
    key = f"station_suspended:{now_ns}"
    condition = Condition(key, Severity.ERROR, "station_suspended", STATION_NAME, text)
    return station.with_alarm(condition, now_ns)


def note_guard(station: Station, event: GuardActed, now_ns: int) -> Station:
    """Return the station with an alarm for what its guard did."""
    names = ", ".join(event.names) or "no vehicle"
    who = "" if event.by is None else f" by {event.by}"
    refused = f", and could not hold {', '.join(event.refused)}" if event.refused else ""
    text = (
        f"The guard held {names}{refused}: {event.why}{who}. Check every vehicle before you give "
        "orders"
    )
    condition = Condition(f"guard:{now_ns}", Severity.ERROR, "guard", STATION_NAME, text)
    return station.with_alarm(condition, now_ns)


def note_slow_answer(station: Station, event: CommandAnswered, now_ns: int) -> Station:
    """Return the station with an alarm for an order that was acknowledged late.

    The protocol carries no time of measurement, so only an answer shows how slow a link is.
    """
    record = station.orders.records.get(event.command_id)
    if record is None or record.sent is None or record.times_sent != 1 or event.positive is None:
        return station
    took_s = ns_to_seconds(now_ns - record.sent.sent_at_ns)
    vehicle = station.fleet.vehicle_of_link(event.link_id)
    is_slow = took_s > station.settings.flight_alarms.slow_answer_s
    if not is_slow or vehicle is None or vehicle.is_flying.value is False:
        return station
    name = vehicle.display_name
    text = (
        f"{name}: its app answered an order after {took_s:.1f} s, so its telemetry may be as old: "
        "keep wide distances, bring its controller nearer, end its video"
    )
    key = f"latency:{vehicle.serial or event.link_id}"
    condition = Condition(key, Severity.WARNING, "latency", name, text, vehicle.serial)
    return station.with_alarm(condition, now_ns)


def note_refused_login(station: Station, event: LoginRefused, now_ns: int) -> Station:
    """Return the station with an alarm for repeated wrong tokens from one address."""
    if not event.is_repeated:
        return station
    text = (
        f"{event.failures} wrong tokens from {event.address} within a minute: an old link on a "
        "tablet, or a stranger in the network; `recon user list` shows the users"
    )
    return _noted(station, f"login_refused:{event.address}", "login_refused", text, now_ns)


def note_users(station: Station, event: UsersChanged, now_ns: int) -> Station:
    """Return the station with an alarm when the users file cannot be used."""
    if event.problem is None:
        return station
    text = f"users stay as they were: {event.problem}"
    return _noted(station, "users_file", "users_file", text, now_ns)


def _noted(station: Station, key: str, rule: str, text: str, now_ns: int) -> Station:
    condition = Condition(key, Severity.WARNING, rule, STATION_NAME, text)
    return station.with_alarm(condition, now_ns)


def fault_conditions(station: Station, now_ns: int) -> Iterator[Condition]:
    """Yield an alarm for each recent fault."""
    for fault in _present(station, now_ns):
        text = f"{STATION_NAME}: fault in its own code, {fault.where}: {fault.what}; {FAULT_TO_DO}"
        key = f"station_fault:{fault.where}"
        yield Condition(key, Severity.CRITICAL, "station_fault", STATION_NAME, text)


def _present(station: Station, now_ns: int) -> Iterator[Fault]:
    lasts_ns = seconds_to_ns(FAULT_SETTINGS.lasts_s)
    return (fault for fault in station.faults.values() if now_ns - fault.at_ns <= lasts_ns)
