"""Alarms about a failsafe's route home that leads through a temporary zone.

The gate judges the route home when an order is given. A zone that is drawn later may lie on the way
home of a vehicle that only hovers, or flies clear of the zone: nothing holds it, and on the loss of
its link it would fly through. Only temporary zones are asked about: the site's own are judged with
every order.
"""

from collections.abc import Iterator

import numpy as np

from recon.geo import Footprints
from recon.model.arrays import FloatArray
from recon.model.geo import LocalFrame
from recon.model.severity import Severity
from recon.model.vehicle import VehicleState
from recon.safety.airspace import PreparedAirspace, PreparedZone
from recon.safety.datum import home, places_m, takeoff_up_m
from recon.safety.heights import stays_above, zone_datum
from recon.safety.watchdogs.reach import last_known_place
from recon.safety.watchdogs.traffic_picture import Finding, TrafficPicture

RULE = "route_home_zone"


def route_home_zones(picture: TrafficPicture) -> Iterator[Finding]:
    """Find vehicles in the air whose straight route home meets a temporary zone."""
    airspace, frame = picture.airspace, picture.airspace.airspace.frame
    if frame is None:
        return
    if not airspace.temporary_zones:
        return
    known = [(one, way) for one in picture.flying if (way := _path_m(one.state, frame)) is not None]
    if not known:
        return
    # All ways at once: most are far from most zones.
    paths_m = np.stack([way for _, way in known])
    ways, margin_m = Footprints(paths_m), airspace.airspace.limits.boundary_margin_m
    for zone in airspace.temporary_zones:
        for index in np.flatnonzero(~zone.polygon.is_clear_of(ways, margin_m)):
            watched = known[index][0]
            if _is_above(zone, watched.state, paths_m[index], airspace):
                continue
            name = zone.zone.name
            text = (
                f"its route home leads through the keep-out zone {name!r}: without its link it "
                "would fly through it; lead it to the other side, or land it"
            )
            yield watched.finding(RULE, Severity.WARNING, text, about=f":{name}", after_s=1.0)


def _path_m(vehicle: VehicleState, frame: LocalFrame) -> FloatArray | None:
    """Return the path from here to its home, (3, 2) in the frame; None while home is unknown."""
    here, there = last_known_place(vehicle), home(vehicle)
    return None if there is None else places_m(frame, [here, here, there])


def _is_above(
    zone: PreparedZone, vehicle: VehicleState, path_m: FloatArray, airspace: PreparedAirspace
) -> bool:
    """Whether it is known to fly home above the zone, and lands beside it."""
    ceiling_m, low_m = zone.zone.ceiling_m, _level_up_m(vehicle, airspace)
    if ceiling_m is None or low_m is None:
        return False
    end = Footprints([path_m[2]] * 3)
    if not zone.polygon.is_clear_of(end, airspace.airspace.limits.boundary_margin_m)[0]:
        return False
    datum = zone_datum(zone.zone)
    return bool(stays_above(airspace, path_m[np.newaxis], np.array([low_m]), ceiling_m, datum)[0])


def _level_up_m(vehicle: VehicleState, airspace: PreparedAirspace) -> float | None:
    """The height of its level flight home, up_m of the frame; None if unknown."""
    profile, takeoff_m = vehicle.profile, takeoff_up_m(airspace, vehicle)
    go_home_m = None if profile is None else profile.go_home_height_m
    height_m = vehicle.height_above_takeoff_m.value
    if takeoff_m is None or go_home_m is None or height_m is None:
        return None
    return takeoff_m + max(go_home_m, height_m)
