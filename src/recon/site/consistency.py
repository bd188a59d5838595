"""Consistency of a folder's files with each other: pads, fences, zone and go-home heights.

A zone whose heights are below the ground would keep nothing out. Most often its datum is wrong: a
ceiling of 30 m above the ellipsoid, over ground at 275 m, is below every flight.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from recon.geo import Polygon, cell_centres_m, enu_from_points
from recon.model.airspace import FlightLimits, HeightDatum, Zone, ZoneKind
from recon.model.arrays import FloatArray
from recon.model.errors import SiteError
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.vehicle import VehicleProfile
from recon.site.elevation import LARGEST_GAP_M, ground_heights_m
from recon.site.geojson import FARTHEST_M
from recon.site.site import Site

_LAYERS = {ZoneKind.KEEP_OUT: "keep_out", ZoneKind.HEIGHT: "height_zones"}


def refuse_high_go_home_heights(
    place: str, profiles: Mapping[str, VehicleProfile], limits: FlightLimits
) -> None:
    """Raise `SiteError` for a go-home height above the site's limit."""
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
    """Raise `SiteError` for a pad that a vehicle cannot take off from or land on.

    That is: far away, outside the boundary, in a keep-out zone from the ground up, or closer to
    the edge of either than the margin.
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
    """Raise `SiteError` for a pad whose altitude differs from the elevation model's ground.

    Pads where the model has no height pass.
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
    """Whether a zone includes the ground."""
    lowest_m = 0.0 if zone.datum is HeightDatum.GROUND else ground_m
    begins_at_ground = zone.floor_m is None or zone.floor_m <= lowest_m
    return zone.kind is ZoneKind.KEEP_OUT and begins_at_ground


def _placed_pads(site_file: Path, site: Site) -> Iterator[tuple[str, GeoPoint]]:
    """Yield every pad once, each with its file and its feature or key."""
    layered = site.layers.landing_pads
    owners = {pad.serial for pad in layered}
    for number, pad in enumerate(layered, start=1):
        file = site_file.parent / site.layers.files["landing_pads"]
        yield f"{file}: feature {number} ({pad.name!a})", pad.place
    for number, profile in enumerate(site.profiles.values(), start=1):
        if profile.pad is not None and profile.serial not in owners:
            yield f"{site_file}: vehicles (entry {number}).pad", profile.pad


def _east_north_m(place: str, pad: GeoPoint, frame: LocalFrame) -> FloatArray:
    """Return the pad's east and north (1, 2); raises `SiteError` for one far from the origin."""
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


def refuse_sunken_zones(site_file: Path, site: Site) -> None:
    """Raise `SiteError` for a zone with a height that has no effect somewhere in the zone.

    That is a ceiling not above all the ground beneath, or a height zone's floor below some of it.
    The ground is the elevation model's, else the site's ground altitude.
    """
    for zone in site.layers.zones:
        highest_m = highest_ground_m(site, zone)
        for key, height_m in _effective_heights(zone):
            if height_m < highest_m or (key == "ceiling_m" and height_m == highest_m):
                file = site_file.parent / site.layers.files[_LAYERS[zone.kind]]
                raise SiteError(
                    f"{file}: zone {zone.name!a}: " + _sunken(zone, key, height_m, highest_m)
                )


def highest_ground_m(site: Site, zone: Zone) -> float:
    """Return the highest ground beneath a zone, in the datum of the zone's heights.

    Ground without a height in the elevation model is excluded: flights over it are refused.
    """
    assert site.frame is not None
    if zone.datum is not HeightDatum.WGS84:
        return 0.0
    if site.elevation is not None:
        heights_m = ground_heights_m(site.elevation, _places_m(site, zone))
        known_m = heights_m[np.isfinite(heights_m)]
        if len(known_m):
            return float(known_m.max())
    return site.frame.origin.ellipsoid_height_m


def _effective_heights(zone: Zone) -> Iterator[tuple[str, float]]:
    """Yield the heights that must be above ground to have an effect."""
    if zone.ceiling_m is not None:
        yield "ceiling_m", zone.ceiling_m
    if zone.floor_m is not None and zone.kind is ZoneKind.HEIGHT:
        yield "floor_m", zone.floor_m


def _places_m(site: Site, zone: Zone) -> FloatArray:
    """Return the zone's corners and the middles of the model's cells in it, (N, 2)."""
    assert site.elevation is not None
    grid, outline_m = site.elevation.grid, zone.region.outline_m
    easts, norths = cell_centres_m(grid)
    (west_m, south_m), (east_m, north_m) = outline_m.min(axis=0), outline_m.max(axis=0)
    easts = easts[(easts >= west_m) & (easts <= east_m)]
    norths = norths[(norths >= south_m) & (norths <= north_m)]
    middles_m = np.stack(np.meshgrid(easts, norths), axis=-1).reshape(-1, 2)
    inside_m = middles_m[Polygon(zone.region).contains(middles_m)]
    return np.concatenate([outline_m, inside_m])


def _sunken(zone: Zone, key: str, height_m: float, highest_m: float) -> str:
    if zone.datum is HeightDatum.WGS84:
        return (
            f"expected {key} above the ground beneath, which is up to {highest_m:g} m above the "
            f"WGS84 ellipsoid, got {height_m:g} m from the same; set datum to 'ground' if the "
            "height is above ground, or set a greater height"
        )
    least = "at least 0 m" if key == "floor_m" else "more than 0 m"
    return (
        f"expected {key} to be {least} above ground, got {height_m:g} m; set a greater height or "
        "remove it"
    )
