"""Whether zones' heights are above the ground: one that is not says nothing, whatever flies there.

Most often the datum is the wrong one: a ceiling of 30 m above the ellipsoid, over ground at 275 m,
would be a keep-out zone that every flight is above of.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from recon.geo import Polygon
from recon.model.zone import HeightDatum, Zone, ZoneKind
from recon.site.elevation import ground_heights_m
from recon.site.errors import SiteError
from recon.site.geojson import FloatArray
from recon.site.site import Site

_LAYERS = {ZoneKind.KEEP_OUT: "keep_out", ZoneKind.HEIGHT: "height_zones"}


def refuse_sunken_zones(site_file: Path, site: Site) -> None:
    """Raise `SiteError` for a zone with a height that does nothing somewhere over the zone.

    So it is for a ceiling that is not above all the ground beneath, and for a height zone's floor
    that is below some of it. The ground is the elevation model's, else the site's ground altitude.
    """
    for zone in site.layers.zones:
        highest_m = highest_ground_m(site, zone)
        for key, height_m in _heights_that_bind(zone):
            if height_m < highest_m or (key == "ceiling_m" and height_m == highest_m):
                file = site_file.parent / site.layers.files[_LAYERS[zone.kind]]
                raise SiteError(
                    f"{file}: zone {zone.name!a}: " + _sunken(zone, key, height_m, highest_m)
                )


def highest_ground_m(site: Site, zone: Zone) -> float:
    """Return the highest ground beneath a zone, in the datum that the zone's heights count from.

    Ground that the elevation model does not tell is not asked: flights over it are refused.
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


def _heights_that_bind(zone: Zone) -> Iterator[tuple[str, float]]:
    """Return the heights that keep something out only when they are above ground."""
    if zone.ceiling_m is not None:
        yield "ceiling_m", zone.ceiling_m
    if zone.floor_m is not None and zone.kind is ZoneKind.HEIGHT:
        yield "floor_m", zone.floor_m


def _places_m(site: Site, zone: Zone) -> FloatArray:
    """Return the zone's corners and the middles of the model's cells in it, (N, 2)."""
    assert site.elevation is not None
    grid, outline_m = site.elevation.grid, zone.region.outline_m
    norths = grid.north_m - (np.arange(grid.rows) + 0.5) * grid.cell_m
    easts = grid.west_m + (np.arange(grid.cols) + 0.5) * grid.cell_m
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
            f"WGS84 ellipsoid, got {height_m:g} m from the same; set datum to 'ground' if it "
            "counts from there, or a greater height"
        )
    least = "at least 0 m" if key == "floor_m" else "more than 0 m"
    return (
        f"expected {key} to be {least} above ground, got {height_m:g} m; set a greater height, or "
        "leave it out"
    )
