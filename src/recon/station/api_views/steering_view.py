"""Where the station steers a vehicle, as the API says it."""

from recon.api import schema
from recon.station.state.station import Station


def steering_view(station: Station, serial: str | None) -> schema.SteeringView | None:
    """Return where a vehicle's stream of sticks leads; None while it is not steered."""
    stream = station.control(serial).stream
    if stream is None:
        return None
    return schema.SteeringView(
        command_id=stream.command.id,
        latitude_deg=stream.goal.target.latitude_deg,
        longitude_deg=stream.goal.target.longitude_deg,
        height_above_takeoff_m=stream.goal.height_above_takeoff_m,
        speed_mps=stream.goal.speed_mps,
        has_arrived=stream.arrived_at_ns is not None,
        is_ending=stream.closing is not None,
    )
