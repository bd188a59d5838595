"""The newest fleet return as the API sends it."""

from recon.api import schema
from recon.model.units import ns_to_seconds
from recon.station.operations.fleet_return.conditions import in_turn
from recon.station.state.fleet_return_record import ReturningVehicle
from recon.station.state.station import Station


def fleet_return_view(station: Station, now_ns: int) -> schema.FleetReturnView | None:
    """Return the newest fleet return as the API says it, None before the first."""
    running = station.fleet_return
    if running is None:
        return None
    return schema.FleetReturnView(
        called_by=running.by,
        age_s=ns_to_seconds(now_ns - running.called_at_ns),
        is_over=running.is_over,
        vehicles=[_member(member, now_ns) for member in in_turn(running)],
    )


def _member(member: ReturningVehicle, now_ns: int) -> schema.ReturningView:
    flight = member.flight
    return schema.ReturningView(
        serial=member.serial,
        vehicle_name=member.name,
        stage=member.stage.value,
        since_age_s=ns_to_seconds(now_ns - member.since_ns),
        reason=member.reason or None,
        wave=None if flight is None else flight.wave,
        layer_height_m=None if flight is None else flight.layer_up_m,
        layer_height_above_takeoff_m=None
        if flight is None
        else flight.layer_up_m - flight.takeoff_up_m,
        pad=None if flight is None else flight.pad.name,
        hold_command_id=member.hold_id,
        mission_command_id=member.mission_id,
    )
