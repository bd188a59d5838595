"""What the emergency return will do first: said with the order, for the ICD cannot set it."""

from recon.model.command import Body, ReturnHome
from recon.model.vehicle import VehicleState


def said_of(body: Body, vehicle: VehicleState | None) -> str:
    """Return the note of a return home; "" for any other order."""
    if not isinstance(body, ReturnHome):
        return ""
    profile = None if vehicle is None else vehicle.profile
    height_m = None if profile is None else profile.go_home_height_m
    if height_m is None:
        return (
            "it first climbs to the aircraft's own go-home height, which nobody has told the "
            "station, unless it is higher already"
        )
    return (
        f"it first climbs to the aircraft's own go-home height, {height_m:g} m above its takeoff "
        "point by the site's file, unless it is higher already"
    )
