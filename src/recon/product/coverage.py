"""The ground of a survey in cells: which photos show each in sun, and what is to be flown again."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import ceil, floor
from typing import Any

import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]
from scipy.sparse import csr_array

from recon.geo import cell_centres_m
from recon.model.arrays import BoolArray, FloatArray, IntArray
from recon.model.geo import GroundGrid, LocalFrame
from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.product.flight import FlownSurvey
from recon.product.footprint import PhotoView
from recon.product.sun_at import Sunshine

CELL_M = 4.0
"""Cell size, as in surveys: finer than shadows' edges are known."""
MOST_CELLS = 4_000_000
ENOUGH_VIEWS = 3
"""A mosaic needs a place on three photos at least."""
LEAST_CONFIDENCE = 0.05
"""Confidence below which a shade map knows next to nothing: a photo does not count as in sun."""
JOIN_M = 12.0
"""Places to fly again nearer than this are flown as one."""
SMALLEST_M2 = 60.0
"""Smallest missing area worth a flight: more than four cells at a region's edge."""
SIMPLER_M = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """Cells of a region: `inside` (R, C), and the centres of those inside, (N, 2)."""

    grid: GroundGrid
    inside: BoolArray
    centres_m: FloatArray
    area: shapely.Geometry


def region_of(surveys: Iterable[FlownSurvey]) -> shapely.Geometry | None:
    """Return the union of surveys' regions in east-north metres; None without any."""
    areas = [shapely.Polygon(each.outline_m, each.holes_m).buffer(0.0) for each in surveys]
    area = shapely.union_all(areas)
    return None if area.is_empty else area


def region_of_views(views: Sequence[PhotoView]) -> shapely.Geometry:
    """Return the ground that photos show."""
    return shapely.union_all([shapely.Polygon(view.corners_m).buffer(0.0) for view in views])


def ground_of(area: shapely.Geometry, frame: LocalFrame) -> Ground:
    """Return the cells of an area; coarser ones where it is very large."""
    west, south, east, north = area.bounds
    cell_m = CELL_M
    while (east - west) * (north - south) / cell_m**2 > MOST_CELLS:
        cell_m *= 2.0
    first_col, first_row = floor(west / cell_m), ceil(north / cell_m)
    cols = max(1, ceil(east / cell_m) - first_col)
    rows = max(1, first_row - floor(south / cell_m))
    grid = GroundGrid(frame, first_col * cell_m, first_row * cell_m, cell_m, rows, cols)
    east_m, north_m = np.meshgrid(*cell_centres_m(grid))
    shapely.prepare(area)
    inside = np.asarray(shapely.contains_xy(area, east_m, north_m), dtype=np.bool_)
    return Ground(grid, inside, np.column_stack([east_m[inside], north_m[inside]]), area)


def cells_on(view: PhotoView, ground: Ground) -> IntArray:
    """Return the indices of the cells whose centres a photo shows."""
    try:
        inverse = np.linalg.inv(view.homography)
    except np.linalg.LinAlgError:
        return np.zeros(0, dtype=np.int64)
    found = np.column_stack([ground.centres_m, np.ones(len(ground.centres_m))]) @ inverse.T
    # Ground behind the camera would be projected too: there the third coordinate is negative.
    is_ahead = found[:, 2] > 0.0
    pixels = found[:, :2] / np.where(is_ahead, found[:, 2], 1.0)[:, np.newaxis]
    is_on = is_ahead & (pixels >= -0.5).all(axis=1)
    is_on &= (pixels[:, 0] <= view.cols - 0.5) & (pixels[:, 1] <= view.rows - 0.5)
    return np.flatnonzero(is_on)


def light_of_cells(
    cells: IntArray, ground: Ground, sun: Sunshine, grid: GroundGrid
) -> tuple[BoolArray, BoolArray]:
    """Return which of some cells are in sun, and of which nothing is known, by the cell of the
    sun's grid at their centres."""
    places = ground.centres_m[cells]
    rows = np.floor((grid.north_m - places[:, 1]) / grid.cell_m).astype(np.int64)
    cols = np.floor((places[:, 0] - grid.west_m) / grid.cell_m).astype(np.int64)
    is_on = (rows >= 0) & (rows < grid.rows) & (cols >= 0) & (cols < grid.cols)
    at = np.where(is_on, rows, 0), np.where(is_on, cols, 0)
    is_known = is_on & (sun.confidence[at] >= LEAST_CONFIDENCE)
    return is_known & (sun.transmittance[at] >= SUNLIT_TRANSMITTANCE), ~is_known


def incidence(shown: Sequence[IntArray], cells: int) -> Any:
    """Return (P, C): 1 where a photo shows a cell."""
    ends = np.cumsum([0, *(len(each) for each in shown)])
    columns = np.concatenate(shown) if shown else np.zeros(0, dtype=np.int64)
    ones = np.ones(len(columns), dtype=np.int32)
    return csr_array((ones, columns, ends), shape=(len(shown), cells))


def to_fly_again(ground: Ground, shown: IntArray, sunlit: IntArray) -> list[shapely.Polygon]:
    """Return the polygons to fly again, in east-north metres, the largest first.

    `shown` and `sunlit` (N,) count the photos of each cell inside, all and those in sun. A cell at
    the region's edge that few photos show anyway needs no more.
    """
    is_missing = (shown == 0) | (sunlit < np.minimum(ENOUGH_VIEWS, shown))
    half_m = ground.grid.cell_m / 2.0
    east, north = ground.centres_m[is_missing].T
    boxes = shapely.box(east - half_m, north - half_m, east + half_m, north + half_m)
    if len(boxes) == 0:
        return []
    joined = shapely.union_all(boxes).buffer(JOIN_M / 2.0).buffer(-JOIN_M / 2.0)
    inside = joined.intersection(ground.area).simplify(SIMPLER_M)
    parts = [each for each in shapely.get_parts(inside) if each.geom_type == "Polygon"]
    large = [each for each in parts if each.area >= SMALLEST_M2]
    return sorted(large, key=lambda each: -each.area)
