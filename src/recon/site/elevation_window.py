"""The part of elevation tiles that lies over a site, as one small GeoTIFF.

The result has the pixels of the tile at the site's origin. The nearest pixel of the other tiles is
taken, so that heights are those of the source; tiles of one grid fit without a seam.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from recon.geo import Polygon, geo_from_enu
from recon.geo.datum import horizontal
from recon.model.arrays import BoolArray, FloatArray, IntArray
from recon.model.errors import SiteError
from recon.model.geo import LocalFrame
from recon.site.elevation import flown_area_m
from recon.site.height_file import MOST_PIXELS, HeightFile
from recon.site.site import Site
from recon.site.terrain_source import TerrainSource, tag_of

AROUND_M = 150.0
"""Around the ground that flights reach: the model's grid is two cells of 30 m wider, and is
interpolated between pixels."""
TOGETHER = 200_000
"""Pixels placed at once."""
NO_DATA = -9999.0
FARTHEST_PIXEL = 1e9


@dataclass(frozen=True, slots=True, eq=False)
class ElevationWindow:
    """Heights (R, C) as the source has them, float32, NaN where it has none."""

    base: HeightFile
    first: tuple[int, int]
    """Row and column of the base's pixel that is the window's first."""
    heights_m: FloatArray
    boundary_share: float | None
    """The share of the boundary with heights, 0 to 1; None without a boundary."""
    reach_share: float
    """The same of the ground that flights may reach."""

    def geotiff(self, source: TerrainSource) -> bytes:
        """Return the window as a file, with its source."""
        import rasterio
        from rasterio.io import MemoryFile
        from rasterio.transform import Affine

        row, col = self.first
        rows, cols = self.heights_m.shape
        profile = {
            "driver": "GTiff",
            "dtype": "float32",
            "count": 1,
            "height": rows,
            "width": cols,
            "crs": rasterio.CRS.from_wkt(horizontal(self.base.crs).to_wkt()),
            "transform": self.base.dataset.transform @ Affine.translation(col, row),
            "nodata": NO_DATA,
            "compress": "deflate",
        }
        with MemoryFile() as memory:
            with memory.open(**profile) as dataset:
                dataset.write(np.nan_to_num(self.heights_m, nan=NO_DATA), 1)
                dataset.update_tags(**tag_of(source))
            return bytes(memory.read())


def needed_bounds_deg(site: Site) -> tuple[float, float, float, float]:
    """Return west, south, east and north of the ground that a site's elevation model covers.

    East of the 180th degree longitudes go on, so that west is less than east.
    """
    assert site.frame is not None, "a folder's site has an origin"
    latitude, longitude, _ = geo_from_enu(site.frame, _rim_m(site))
    origin_deg = site.frame.origin.longitude_deg
    longitude = origin_deg + (longitude - origin_deg + 180.0) % 360.0 - 180.0
    edges = longitude.min(), latitude.min(), longitude.max(), latitude.max()
    west, south, east, north = (float(each) for each in edges)
    return west, south, east, north


def elevation_window(site: Site, tiles: Sequence[HeightFile]) -> ElevationWindow:
    """Return the heights of open tiles over a site. Raises `SiteError`."""
    assert site.frame is not None, "a folder's site has an origin"
    base = _tile_at_origin(site.frame, tiles)
    pixels = base.pixels(site.frame, _rim_m(site)[:, :2])
    if not (np.abs(pixels) < FARTHEST_PIXEL).all():
        raise SiteError(
            f"{base.place}: expected a projection that knows all of the site's ground, got another "
            "one; export it in EPSG:4326"
        )
    first, end = np.floor(pixels.min(axis=0)).astype(int), np.ceil(pixels.max(axis=0)).astype(int)
    rows, cols = (end - first + 1).tolist()
    if rows * cols > MOST_PIXELS:
        raise SiteError(
            f"{base.place}: expected at most {MOST_PIXELS} pixels around the site, got {cols} x "
            f"{rows}; set a smaller limits.max_distance_from_home_m"
        )
    heights_m = np.full((rows, cols), np.nan, dtype=np.float32)
    counts = np.zeros((2, 2), dtype=np.int64)
    step = max(1, TOGETHER // cols)
    for top in range(0, rows, step):
        part = heights_m[top : top + step]
        places_m = _places_m(base, site.frame, (first[0] + top, first[1]), part.shape)
        for tile in (base, *(each for each in tiles if each is not base)):
            _fill(part, tile, site.frame, places_m)
        counts += _known_of(site, places_m, np.isfinite(part.ravel()))
    boundary_share = float(counts[0, 0] / counts[0, 1]) if counts[0, 1] else None
    reach_share = float(counts[1, 0] / max(1, counts[1, 1]))
    corner = int(first[0]), int(first[1])
    return ElevationWindow(base, corner, heights_m, boundary_share, reach_share)


def _rim_m(site: Site) -> FloatArray:
    """Return (N, 3) points along the edge of the ground whose heights are wanted."""
    south_west, north_east = flown_area_m(site.airspace)
    (west, south), (east, north) = south_west - AROUND_M, north_east + AROUND_M
    along = np.linspace(0.0, 1.0, 9)
    easts, norths = west + along * (east - west), south + along * (north - south)
    sides = [(easts, south), (easts, north), (west, norths), (east, norths)]
    rim = [np.column_stack(np.broadcast_arrays(*side, 0.0)) for side in sides]
    return np.concatenate(rim)


def _tile_at_origin(frame: LocalFrame, tiles: Sequence[HeightFile]) -> HeightFile:
    for tile in tiles:
        if _inside(tile, tile.pixels(frame, np.zeros((1, 2))))[0]:
            return tile
    names = ", ".join(tile.place for tile in tiles) or "no tile"
    raise SiteError(f"expected heights at the site's origin, got none there in {names}")


def _inside(tile: HeightFile, pixels: FloatArray) -> BoolArray:
    """Return which (N, 2) rows and columns are nearest to a pixel of a tile, (N,)."""
    # An unknown place is NaN, and compares as outside.
    last = np.array([tile.dataset.height, tile.dataset.width]) - 0.5
    return np.asarray(((pixels >= -0.5) & (pixels < last)).all(axis=1), dtype=np.bool_)


def _places_m(
    base: HeightFile, frame: LocalFrame, first: tuple[int, int], shape: tuple[int, ...]
) -> FloatArray:
    """Return the east and north metres (N, 2) of pixels of the base, row by row."""
    rows, cols = np.mgrid[0 : shape[0], 0 : shape[1]]
    x, y = base.dataset.transform @ (
        cols.ravel() + first[1] + 0.5,
        rows.ravel() + first[0] + 0.5,
    )
    points = np.column_stack([x, y, np.full(x.size, frame.origin.ellipsoid_height_m)])
    return base.enu_m(frame, points)[:, :2]


def _fill(part: FloatArray, tile: HeightFile, frame: LocalFrame, places_m: FloatArray) -> None:
    """Write a tile's heights where a part (r, c) of the window has none."""
    pixels = tile.pixels(frame, places_m)
    wanted = _inside(tile, pixels) & np.isnan(part.ravel())
    if not wanted.any():
        return
    nearest = np.rint(pixels[wanted]).astype(int)
    nearest = nearest.clip(0, [tile.dataset.height - 1, tile.dataset.width - 1])
    first, last = nearest.min(axis=0), nearest.max(axis=0)
    rows, cols = (last - first + 1).tolist()
    heights_m = tile.heights_m((int(first[0]), int(first[1])), (rows, cols))
    part.ravel()[wanted] = heights_m[tuple((nearest - first).T)]


def _known_of(site: Site, places_m: FloatArray, known: BoolArray) -> IntArray:
    """Return pixels with heights, and all pixels, in the boundary and within reach, (2, 2)."""
    south_west, north_east = flown_area_m(site.airspace)
    within = ((places_m >= south_west) & (places_m <= north_east)).all(axis=1)
    boundary = site.layers.boundary
    inside = np.zeros_like(within) if boundary is None else Polygon(boundary).contains(places_m)
    areas = (inside, within)
    return np.array([[int((area & known).sum()), int(area.sum())] for area in areas])
