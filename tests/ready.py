"""What a site and a vehicle are like when nothing on the checklist speaks against a flight."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from recon.geo import enu_from_point
from recon.model.airspace import Airspace, Region
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.vehicle import AltitudeReference, Failsafe, VehicleProfile
from recon.site import Site
from recon.site.site import Layers

HALF_SIDE_M = 3_000.0


def ready_profile(
    serial: str, home: GeoPoint | None = None, number: int = 0, **changes: object
) -> VehicleProfile:
    """A vehicle ready to fly, with its pad at home; each number goes home in a layer of its own."""
    profile = VehicleProfile(
        serial,
        waypoint_altitude=AltitudeReference.TAKEOFF,
        pad=home,
        endurance_s=1_500.0,
        go_home_height_m=40.0 + 8.0 * number,
        failsafe=Failsafe.GO_HOME,
        camera_interval_s=2.0,
    )
    return replace(profile, **changes)  # type: ignore[arg-type]


def ready_airspace(origin: GeoPoint, **changes: object) -> Airspace:
    """A square fence of 6 km around a place, and nothing in it."""
    frame = LocalFrame(origin)
    middle_m = enu_from_point(frame, origin)[:2]
    corners = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    boundary = Region(middle_m + HALF_SIDE_M * corners)
    return replace(Airspace(frame=frame, boundary=boundary), **changes)  # type: ignore[arg-type]


def ready_site(origin: GeoPoint, profiles: Iterable[VehicleProfile]) -> Site:
    """A site with these vehicles inside the fence of `ready_airspace`."""
    airspace = ready_airspace(origin)
    return Site(
        name="test",
        frame=airspace.frame,
        profiles={profile.serial: profile for profile in profiles},
        layers=Layers(boundary=airspace.boundary),
    )
