"""The newest order that moves or stops a vehicle, and what has ended a mission."""

from recon.link.outbox import Lane, lane_of
from recon.model.command import Phase
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station
from recon.station.steering import neutral_setpoint


def newest_motion(station: Station, serial: str, *, own: bool = True) -> OrderRecord | None:
    """Return the newest accepted order to move or stop of a vehicle.

    The station's own neutral setpoint does not count; without `own` no order of its own does.
    """
    for record in reversed(tuple(station.orders.records.values())):
        command = record.command
        if command.serial != serial or record.phase is Phase.REFUSED_BY_STATION:
            continue
        if command.is_own and not own:
            continue
        if lane_of(command) is not Lane.CAMERA and command.issued_by != neutral_setpoint.ISSUER:
            return record
    return None


def mission_end_text(station: Station, record: OrderRecord) -> str:
    """Return how a mission ended that was not flown to its end, and why."""
    if record.phase is not Phase.SUPERSEDED:
        return f"mission {record.phase.value.replace('_', ' ')}: {record.note}"
    newest = newest_motion(station, record.command.serial or "")
    is_replaced = newest is not None and newest.command.id != record.command.id
    return f"mission stopped: {newest.command.words if newest and is_replaced else record.note}"
