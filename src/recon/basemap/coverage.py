"""Which share of a site a map shows at each zoom level."""

from dataclasses import dataclass

from recon.basemap.map_file import MapFile
from recon.basemap.web_mercator import MapArea, metres_per_pixel

FULL = 0.9995
"""Share of the area that counts as all: a sliver less is rounding."""


@dataclass(frozen=True, slots=True)
class ZoomCoverage:
    """The share of an area, 0 to 1, that a map shows at a zoom level, and its pixels there."""

    zoom: int
    share: float
    """1 for all of it."""
    metres_per_pixel: float


def coverage(opened: MapFile, area: MapArea) -> tuple[ZoomCoverage, ...]:
    """Return the coverage of each zoom level of a map, the coarsest first.

    Levels with more tiles over the area than are counted are excluded.
    """
    found = []
    for zoom in range(opened.info.min_zoom, opened.info.max_zoom + 1):
        share = opened.share(area, zoom)
        if share is None:
            break
        pixel_m = metres_per_pixel(area.latitude_deg, zoom, opened.info.tile_px)
        found.append(ZoomCoverage(zoom, 1.0 if share >= FULL else share, pixel_m))
    return tuple(found)


def finest_covered(levels: tuple[ZoomCoverage, ...]) -> ZoomCoverage | None:
    """Return the finest level that shows all of the area, else the finest of those with most."""
    if not levels:
        return None
    most = max(level.share for level in levels)
    least = most if most == 1.0 else most - 0.005
    return [level for level in levels if level.share >= least][-1]
