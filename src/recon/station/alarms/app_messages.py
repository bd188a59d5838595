"""Warnings and errors that a companion app sends: alarms until an operator acknowledges them."""

from recon.model.replacing import replace
from recon.model.report import MessageReport, MessageSeverity
from recon.model.vehicle import VehicleState
from recon.station.state import alarm_book
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.station import Station
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
    book = alarm_book.note(station.alarms, condition, now_ns, station.settings.alarms_kept)
    return replace(station, alarms=book), ()


def _unacknowledged(station: Station, source: str) -> int:
    alarms = station.alarms.alarms.values()
    return sum(alarm.condition.key.startswith(f"app:{source}:") for alarm in alarms)
