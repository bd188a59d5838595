"""The imaging drones that show the field now."""

from recon.model.failsafe_matrix import Activity
from recon.station.failsafe.activity import activity_of
from recon.station.state.station import Station


def imagers_at_work(station: Station) -> tuple[str, ...]:
    """Return the serials of those in the air and not returning home, in the site's order."""
    return tuple(
        serial
        for serial in station.imaging.imagers
        if is_in_the_air(station, serial) and not is_going_home(station, serial)
    )


def is_in_the_air(station: Station, serial: str) -> bool:
    """Return whether telemetry shows a vehicle in the air, or did so last."""
    vehicle = station.fleet.vehicles.get(serial)
    return vehicle is not None and vehicle.is_flying.value is True


def is_going_home(station: Station, serial: str) -> bool:
    """Return whether a vehicle returns, lands, or waits for its turn to, by whatever order."""
    vehicle = station.fleet.vehicles.get(serial)
    return vehicle is not None and activity_of(station, vehicle) is Activity.RETURNING
