"""Where the station steers a vehicle, as the API says it."""

from recon.api import schema
from recon.station.state.station import Station


def steering_view(station: Station, serial: str | None) -> schema.SteeringView | None:
    """Return where a vehicle's stream of sticks leads; None while it is not steered."""
    lease = station.control(serial).lease
    if lease is None:
        return None
    return schema.SteeringView(
        command_id=lease.command.id,
        latitude_deg=lease.goal.target.latitude_deg,
        longitude_deg=lease.goal.target.longitude_deg,
        height_above_takeoff_m=lease.goal.height_above_takeoff_m,
        speed_mps=lease.goal.speed_mps,
        has_arrived=lease.arrived_at_ns is not None,
        is_ending=lease.closing is not None,
    )
