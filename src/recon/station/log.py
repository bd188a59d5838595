"""What the station did, one line an event, for the person at the terminal and the log file."""

import structlog

from recon.model.event import Event, LinkClosed, LinkOpened
from recon.station.state import Station

_log = structlog.get_logger("recon")


def log_step(before: Station, after: Station, event: Event) -> None:
    """Write what a step changed that a person wants to read later."""
    match event:
        case LinkOpened(link_id, remote_address):
            _log.info("app connected", link=link_id, address=remote_address)
        case LinkClosed(link_id, reason):
            _log.info("app gone", link=link_id, reason=reason)
    if after.fleet.vehicles is not before.fleet.vehicles:
        _log_identities(before, after)
    if after.orders is not before.orders:
        _log_orders(before, after)
    if after.alarms is not before.alarms:
        _log_alarms(before, after)


def _log_identities(before: Station, after: Station) -> None:
    for serial, vehicle in after.fleet.vehicles.items():
        old = before.fleet.vehicles.get(serial)
        if old is None or old.link_id != vehicle.link_id:
            _log.info(
                "vehicle on link",
                vehicle=vehicle.display_name,
                serial=serial,
                link=vehicle.link_id,
                simulated=vehicle.is_simulated,
            )


def _log_orders(before: Station, after: Station) -> None:
    for key, record in after.orders.records.items():
        old = before.orders.records.get(key)
        if old is record or (old is not None and old.history is record.history):
            continue
        _log.info(
            "order",
            id=key,
            kind=record.command.name,
            vehicle=record.vehicle_name,
            phase=record.phase.value,
            note=record.note,
            by=record.command.issued_by,
            altitudes=record.altitudes,
        )


def _log_alarms(before: Station, after: Station) -> None:
    for key, alarm in after.alarms.alarms.items():
        if key not in before.alarms.alarms:
            _log.warning(
                "alarm", severity=alarm.condition.severity.value, text=alarm.condition.text
            )
