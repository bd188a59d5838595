"""Web Mercator tiles (XYZ), and which of them show the ground that a site needs.

World coordinates are (N, 2): 0 to 1 eastwards from 180 degrees west and southwards from 85 north. A
zoom level has 2^zoom tiles along each axis; tile (0, 0) is the north-western one.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import cos, pi, radians

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo import geo_from_enu, shape_of
from recon.model.airspace import Region
from recon.model.arrays import FloatArray, IntArray
from recon.model.geo import LocalFrame

DEEPEST_ZOOM = 24
"""Pixels of a centimetre."""
FARTHEST_LATITUDE_DEG = 85.0511
"""Where the square world ends."""
TILE_PX = 256
"""Tile size at which zoom levels are counted."""
EQUATOR_M = 2.0 * pi * 6_378_137.0
MARGIN_M = 100.0
"""Margin around a boundary: drones are seen, and return, along its outside."""
MOST_TILES = 250_000
"""Most tiles of a zoom level that is judged: 3 km at pixels of 3 cm."""


def world_from_globe(longitude_deg: npt.ArrayLike, latitude_deg: npt.ArrayLike) -> FloatArray:
    """Return world coordinates (N, 2) of N places."""
    longitude = np.asarray(longitude_deg, dtype=np.float64)
    limited = np.clip(latitude_deg, -FARTHEST_LATITUDE_DEG, FARTHEST_LATITUDE_DEG)
    south = 0.5 - np.arctanh(np.sin(np.radians(limited))) / (2.0 * pi)
    return np.column_stack([longitude / 360.0 + 0.5, south])


def globe_from_world(world: FloatArray) -> FloatArray:
    """Return (N, 2) longitude and latitude, degrees, of (N, 2) world coordinates."""
    latitude = np.degrees(np.arctan(np.sinh((0.5 - world[:, 1]) * 2.0 * pi)))
    return np.column_stack([(world[:, 0] - 0.5) * 360.0, latitude])


def metres_per_pixel(latitude_deg: float, zoom: int, tile_px: int = TILE_PX) -> float:
    """Return the ground that a pixel of a tile shows, metres."""
    return EQUATOR_M * cos(radians(latitude_deg)) / (tile_px * 2.0**zoom)


def tile_bounds_deg(zoom: int, col: int, row: int) -> tuple[float, float, float, float]:
    """Return west, south, east and north of a tile, degrees."""
    corners = np.array([[col, row + 1], [col + 1, row]]) / 2.0**zoom
    (west, south), (east, north) = globe_from_world(corners).tolist()
    return west, south, east, north


@dataclass(frozen=True, slots=True)
class MeetingTiles:
    """The tiles of a zoom level that meet an area, each (N,), and the share of it in each."""

    zoom: int
    cols: IntArray
    rows: IntArray
    shares: FloatArray


@dataclass(frozen=True)
class MapArea:
    """The ground that a base map should show: a ring of (longitude, latitude), degrees."""

    ring_deg: tuple[tuple[float, float], ...]

    @cached_property
    def _shape(self) -> "shapely.Polygon":
        longitude, latitude = np.array(self.ring_deg).T
        return shapely.Polygon(world_from_globe(longitude, latitude))

    @cached_property
    def bounds_deg(self) -> tuple[float, float, float, float]:
        """West, south, east and north of the area, degrees."""
        (west, south), (east, north) = np.min(self.ring_deg, axis=0), np.max(self.ring_deg, axis=0)
        return float(west), float(south), float(east), float(north)

    @cached_property
    def latitude_deg(self) -> float:
        """The latitude at which its pixels are measured: its middle."""
        _west, south, _east, north = self.bounds_deg
        return (south + north) / 2.0

    def points(self, about: int) -> FloatArray:
        """Return world coordinates (N, 2) of about that many places all over the area."""
        west, north, east, south = self._shape.bounds
        inside = self._shape.area / max((east - west) * (south - north), 1e-300)
        step = ((east - west) * (south - north) * inside / about) ** 0.5
        axes = (
            np.arange(west + step / 2.0, east, step),
            np.arange(north + step / 2.0, south, step),
        )
        places = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
        return np.vstack([self._corners, places[shapely.contains_xy(self._shape, places)]])

    @property
    def _corners(self) -> FloatArray:
        found: FloatArray = shapely.get_coordinates(self._shape)
        return found

    def most_tiles(self, zoom: int) -> int:
        """Return how many tiles the box around the area meets, without listing them."""
        west, south, east, north = np.floor(np.array(self._shape.bounds) * 2.0**zoom).astype(int)
        return int((east - west + 1) * (north - south + 1))

    def tiles(self, zoom: int) -> MeetingTiles | None:
        """Return the tiles that meet the area; None for more than `MOST_TILES` around it."""
        if self.most_tiles(zoom) > MOST_TILES:
            return None
        count = 2**zoom
        first_col, first_row, last_col, last_row = np.clip(
            np.floor(np.array(self._shape.bounds) * count).astype(np.int64), 0, count - 1
        )
        cols, rows = (
            axis.ravel()
            for axis in np.meshgrid(
                np.arange(first_col, last_col + 1), np.arange(first_row, last_row + 1)
            )
        )
        boxes = shapely.box(cols / count, rows / count, (cols + 1) / count, (rows + 1) / count)
        shapely.prepare(self._shape)
        meets = shapely.intersects(self._shape, boxes)
        within = shapely.contains(self._shape, boxes)
        shares = np.where(within, 1.0 / count**2, 0.0)
        edge = meets & ~within
        shares[edge] = shapely.area(shapely.intersection(boxes[edge], self._shape))
        return MeetingTiles(zoom, cols[meets], rows[meets], shares[meets] / self._shape.area)


def area_around(
    frame: LocalFrame, boundary: Region | None, reach_m: float, margin_m: float = MARGIN_M
) -> MapArea:
    """Return the boundary with a margin; without one, what is in reach of the origin."""
    inner = shapely.Point(0.0, 0.0).buffer(reach_m) if boundary is None else shape_of(boundary)
    outer = inner.buffer(margin_m).exterior
    corners = shapely.get_coordinates(outer.simplify(1.0))
    points = np.column_stack([corners, np.zeros(len(corners))])
    latitude, longitude, _ = geo_from_enu(frame, points)
    return MapArea(tuple(zip(longitude.tolist(), latitude.tolist(), strict=True)))


def zoom_for(latitude_deg: float, pixel_m: float) -> int:
    """Return the first zoom level whose pixels are no larger."""
    zooms: Iterator[int] = iter(range(DEEPEST_ZOOM + 1))
    return next((z for z in zooms if metres_per_pixel(latitude_deg, z) <= pixel_m), DEEPEST_ZOOM)
