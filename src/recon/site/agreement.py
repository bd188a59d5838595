"""Whether what the folder's files say fits together: pads, fences, heights."""

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from recon.geo import Polygon, enu_from_points
from recon.model.airspace import FlightLimits
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.vehicle import VehicleProfile
from recon.model.zone import HeightDatum, Zone, ZoneKind
from recon.site.elevation import LARGEST_GAP_M, ground_heights_m
from recon.site.errors import SiteError
from recon.site.geojson import FARTHEST_M, FloatArray
from recon.site.site import Site


def refuse_high_ways_home(
    place: str, profiles: Mapping[str, VehicleProfile], limits: FlightLimits
) -> None:
    """Raise `SiteError` for an aircraft whose way home is higher than the site allows."""
    ceiling_m = limits.max_height_above_ground_m
    for number, profile in enumerate(profiles.values(), start=1):
        height_m = profile.go_home_height_m
        if height_m is not None and height_m > ceiling_m:
            raise SiteError(
                f"{place}: vehicles (entry {number}).go_home_height_m: expected at most "
                f"limits.max_height_above_ground_m, {ceiling_m:g} m, got {height_m:g} m; set a "
                "lower one in the aircraft too"
            )


def refuse_misplaced_pads(site_file: Path, site: Site) -> None:
    """Raise `SiteError` for a pad that no vehicle could leave or come home to.

    So it is when the pad is far away, outside the boundary, in a keep-out zone that begins at the
    ground, or closer to the edge of either than the margin.
    """
    assert site.frame is not None
    margin_m = site.limits.boundary_margin_m
    boundary = None if site.layers.boundary is None else Polygon(site.layers.boundary)
    ground_m = site.frame.origin.ellipsoid_height_m
    keep_out = [
        (zone, Polygon(zone.region)) for zone in site.layers.zones if _is_on_ground(zone, ground_m)
    ]
    for place, pad in _placed_pads(site_file, site):
        point_m = _east_north_m(place, pad, site.frame)
        if boundary is not None:
            inside_m = float(boundary.distance_to_edge_m(point_m)[0])
            if inside_m < margin_m:
                raise SiteError(
                    f"{place}: expected a place inside the boundary in "
                    f"{site.layers.files['boundary']}, {margin_m:g} m from its edge at least, got "
                    f"one {_how_far(inside_m)}"
                )
        for zone, polygon in keep_out:
            inside_m = float(polygon.distance_to_edge_m(point_m)[0])
            if inside_m > -margin_m:
                raise SiteError(
                    f"{place}: expected a place {margin_m:g} m outside the keep-out zone "
                    f"{zone.name!a} at least, got one {_how_far(inside_m)}"
                )


def refuse_sunken_pads(site_file: Path, site: Site) -> None:
    """Raise `SiteError` for a pad whose altitude is not that of the elevation model's ground.

    Where the model tells no height nothing is said.
    """
    assert site.frame is not None
    assert site.elevation is not None
    for place, pad in _placed_pads(site_file, site):
        point_m = _east_north_m(place, pad, site.frame)
        gap_m = pad.ellipsoid_height_m - float(ground_heights_m(site.elevation, point_m)[0])
        if abs(gap_m) > LARGEST_GAP_M:
            raise SiteError(
                f"{place}: expected an altitude within {LARGEST_GAP_M:g} m of the elevation "
                f"model's ground, got one {gap_m:+.1f} m from it; altitudes count from the WGS84 "
                "ellipsoid, not from sea level"
            )


def _is_on_ground(zone: Zone, ground_m: float) -> bool:
    """Whether a zone keeps vehicles from standing there; one that begins higher does not."""
    lowest_m = 0.0 if zone.datum is HeightDatum.GROUND else ground_m
    begins_at_ground = zone.floor_m is None or zone.floor_m <= lowest_m
    return zone.kind is ZoneKind.KEEP_OUT and begins_at_ground


def _placed_pads(site_file: Path, site: Site) -> Iterator[tuple[str, GeoPoint]]:
    """Return every pad once, each with the file and the feature or key that tells it."""
    layered = site.layers.landing_pads
    owners = {pad.serial for pad in layered}
    for number, pad in enumerate(layered, start=1):
        file = site_file.parent / site.layers.files["landing_pads"]
        yield f"{file}: feature {number} ({pad.name!a})", pad.place
    for number, profile in enumerate(site.profiles.values(), start=1):
        if profile.pad is not None and profile.serial not in owners:
            yield f"{site_file}: vehicles (entry {number}).pad", profile.pad


def _east_north_m(place: str, pad: GeoPoint, frame: LocalFrame) -> FloatArray:
    """Return the pad's east and north (1, 2); raises `SiteError` for one of another place."""
    point_m = enu_from_points(frame, [pad])
    distance_m = float(np.linalg.norm(point_m))
    if distance_m > FARTHEST_M:
        raise SiteError(
            f"{place}: expected a place within {FARTHEST_M / 1_000.0:g} km of the site's origin, "
            f"got one {distance_m / 1_000.0:.0f} km away; are latitude and longitude right?"
        )
    return point_m[:, :2]


def _how_far(inside_m: float) -> str:
    return f"{abs(inside_m):.1f} m {'inside' if inside_m >= 0.0 else 'outside'}"
