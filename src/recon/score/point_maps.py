"""Maps of the light between sensors on the ground.

Between the places a map is linear over the triangles of a Delaunay triangulation, and unknown
beyond them and beside sensors without a value.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import ceil

import numpy as np

from recon.geo import cell_centres_m, cells_of
from recon.light.points import LightPoints
from recon.model.arrays import IntArray
from recon.model.errors import RecordError
from recon.model.geo import GroundGrid
from recon.model.shade import FloatMap, ShadeMap
from recon.score.verification import NOWHERE

LEAST_CELL_M = 4.0
SHARPEST_SHARE = 0.15
"""Of the usual distance between two sensors: how fine a map is at a sensor itself."""
MOST_CELLS_ACROSS = 96
"""Maps of more cells cost time and show nothing more: places are some tenths of them apart."""


@dataclass(frozen=True)
class PointMaps:
    """Maps of the light between the places of sensors."""

    points: LightPoints

    @cached_property
    def grid(self) -> GroundGrid:
        """The grid around all places."""
        east_m, north_m = self.points.east_m, self.points.north_m
        wide_m, high_m = float(np.ptp(east_m)), float(np.ptp(north_m))
        cell_m = LEAST_CELL_M * max(1, ceil(max(wide_m, high_m) / MOST_CELLS_ACROSS / LEAST_CELL_M))
        rows, cols = (ceil(each / cell_m) + 1 for each in (high_m, wide_m))
        west_m, top_m = float(east_m.min()) - cell_m / 2.0, float(north_m.max()) + cell_m / 2.0
        return GroundGrid(self.points.frame or NOWHERE, west_m, top_m, cell_m, rows, cols)

    @cached_property
    def direct(self) -> FloatMap:
        """(T, N): the sensors' share of the direct beam."""
        return self.points.direct

    @cached_property
    def cells(self) -> tuple[IntArray, IntArray]:
        """Row and column of the cell that each sensor is in."""
        return cells_of(self.grid, self.points.east_m, self.points.north_m)

    def each(self, chosen: Sequence[int] | None = None) -> Iterator[ShadeMap]:
        """Yield the map of each time, or of the chosen ones; raises `RecordError` for places on
        one line."""
        corners, weights = self._triangles
        direct = self.direct
        for number in range(len(direct)) if chosen is None else chosen:
            values = (direct[number][corners] * weights).sum(axis=2).astype(np.float32)
            valid = np.isfinite(values)
            known = valid.astype(np.float32)
            far_m = np.where(valid, self._far_m, np.float32(np.nan))
            at_ns = int(self.points.times_ns[number])
            yield ShadeMap(self.grid, at_ns, (), values, valid, known, far_m)

    @cached_property
    def _far_m(self) -> FloatMap:
        """(R, C): how fine the map is, as a picture's ground size of a pixel: the distance to the
        nearest sensor, and at a sensor itself a part of the usual distance between two."""
        from scipy.spatial import cKDTree

        places = np.column_stack([self.points.east_m, self.points.north_m])
        centres = np.stack(np.meshgrid(*cell_centres_m(self.grid)), axis=-1)
        far_m, _number = cKDTree(places).query(centres)
        usual_m = np.sqrt(np.ptp(places, axis=0).prod() / len(places))
        found: FloatMap = np.hypot(far_m, SHARPEST_SHARE * usual_m).astype(np.float32)
        return found

    @cached_property
    def _triangles(self) -> tuple[IntArray, FloatMap]:
        """(R, C, 3): the sensors around each cell, and their weights; NaN outside all triangles."""
        from scipy.spatial import Delaunay, QhullError

        places = np.column_stack([self.points.east_m, self.points.north_m])
        try:
            found = Delaunay(places)
        except (QhullError, ValueError) as problem:
            raise RecordError(
                f"expected 3 places or more that are not on one line, got {len(places)}"
            ) from problem
        grid = self.grid
        east_m, north_m = cell_centres_m(grid)
        centres = np.stack(np.meshgrid(east_m, north_m), axis=-1)
        triangle = found.find_simplex(centres)
        turned, third = found.transform[triangle, :2], found.transform[triangle, 2]
        two = np.einsum("...ij,...j->...i", turned, centres - third)
        weights = np.concatenate([two, 1.0 - two.sum(axis=-1, keepdims=True)], axis=-1)
        weights[triangle < 0] = np.nan
        return found.simplices[triangle].astype(np.int64), weights.astype(np.float32)
