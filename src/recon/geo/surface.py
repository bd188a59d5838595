"""Terrain, bilinear between the middles of a grid's cells: heights, and extremes over areas.

Within a cell of the lattice of middles a bilinear surface has no top and no bottom of its own:
along a straight leg it is a parabola, and over an area its extremes lie on the area's outline or in
one of the lattice's nodes. So both are found exactly, without sampling.

Where the surface is not known (a node is NaN, or the place is not between the middles) a height is
NaN, the highest is +inf and the lowest -inf: comparisons with them give the safe answer.
"""

from functools import cached_property

import numpy as np
import numpy.typing as npt

from recon.geo.polygon import Box
from recon.model.arrays import BoolArray, FloatArray, IntArray
from recon.model.geo import GroundGrid

ROUNDING_M = 1e-6


class Surface:
    """Heights (rows, cols) in the middles of `grid`'s cells; build one for each model and keep it.

    Raises `ValueError` when there is not one height for each cell, or the grid is less than two
    cells wide or high: there is nothing between its middles then.
    """

    def __init__(self, grid: GroundGrid, heights_m: npt.ArrayLike) -> None:
        heights = np.array(heights_m, dtype=np.float64)
        if heights.shape != (grid.rows, grid.cols) or min(heights.shape) < 2:
            raise ValueError(
                f"expected ({grid.rows}, {grid.cols}) heights, at least 2 each way, got an array "
                f"of {heights.shape}"
            )
        self._grid = grid
        self._heights_m = heights
        half_m = 0.5 * grid.cell_m + ROUNDING_M
        self._least_m = np.array([grid.west_m, grid.north_m - grid.rows * grid.cell_m]) + half_m
        self._most_m = np.array([grid.west_m + grid.cols * grid.cell_m, grid.north_m]) - half_m
        self._bounds_m: tuple[list[float], list[float]] = (
            self._least_m.tolist(),
            self._most_m.tolist(),
        )

    def heights_m(self, points_m: npt.ArrayLike) -> FloatArray:
        """Return the heights (N,) at (N, 2) east-north points."""
        nodes = self._nodes(points_m)
        # Points outside get index 0 for the lookup, and NaN afterwards.
        known = self._covers(nodes)
        places = np.where(known[:, np.newaxis], nodes, 0.0)
        return np.where(known, self._bilinear(places, self._cells(places)), np.nan)

    def highest_within_m(self, triangles_m: npt.ArrayLike) -> FloatArray:
        """Return the highest ground (N,) under (N, 3, 2) triangles; one may be as thin as a leg."""
        return self._top.within(self._triangle_nodes(triangles_m))

    def lowest_within_m(self, triangles_m: npt.ArrayLike) -> FloatArray:
        """Return the lowest ground (N,) under (N, 3, 2) triangles."""
        return -self._bottom.within(self._triangle_nodes(triangles_m))

    def is_below(self, triangles_m: npt.ArrayLike, heights_m: FloatArray) -> BoolArray:
        """Return under which of (N, 3, 2) triangles all ground is at most as high as (N,)."""
        if self._is_beyond_all(self._top, triangles_m, heights_m):
            return np.ones(len(heights_m), dtype=np.bool_)
        return self._top.is_below(self._triangle_nodes(triangles_m), heights_m)

    def is_above(self, triangles_m: npt.ArrayLike, heights_m: FloatArray) -> BoolArray:
        """Return under which of (N, 3, 2) triangles all ground is at least as high as (N,)."""
        if self._is_beyond_all(self._bottom, triangles_m, -heights_m):
            return np.ones(len(heights_m), dtype=np.bool_)
        return self._bottom.is_below(self._triangle_nodes(triangles_m), -heights_m)

    def covers(self, box: Box) -> bool:
        """Return whether a box lies on the surface."""
        (west_m, south_m), (east_m, north_m) = self._bounds_m
        return (
            box.west_m >= west_m
            and box.south_m >= south_m
            and box.east_m <= east_m
            and box.north_m <= north_m
        )

    @property
    def highest_of_all_m(self) -> float:
        """The highest ground of the whole surface; +inf with a gap in it."""
        return self._top.highest_of_all

    @property
    def lowest_of_all_m(self) -> float:
        """The lowest ground of the whole surface; -inf with a gap in it."""
        return -self._bottom.highest_of_all

    def _is_beyond_all(
        self, side: "_Highest", triangles_m: npt.ArrayLike, heights_m: FloatArray
    ) -> bool:
        """Return whether all heights exceed all ground, and all triangles lie on known ground.

        A fast test that is true for nearly all flights.
        """
        points = np.asarray(triangles_m, dtype=np.float64).reshape(-1, 2)
        if len(points) == 0 or not heights_m.min() >= side.highest_of_all:
            return False
        is_known = (points.min(axis=0) >= self._least_m) & (points.max(axis=0) <= self._most_m)
        return bool(is_known[0] and is_known[1])

    @cached_property
    def _top(self) -> "_Highest":
        return _Highest(self._heights_m)

    @cached_property
    def _bottom(self) -> "_Highest":
        return _Highest(-self._heights_m)

    def _nodes(self, points_m: npt.ArrayLike) -> FloatArray:
        """Return (row, col) on the lattice, (N, 2), of east-north metres."""
        points = np.asarray(points_m, dtype=np.float64).reshape(-1, 2)
        grid = self._grid
        rows = (grid.north_m - points[:, 1]) / grid.cell_m - 0.5
        cols = (points[:, 0] - grid.west_m) / grid.cell_m - 0.5
        return np.stack([rows, cols], axis=1)

    def _triangle_nodes(self, triangles_m: npt.ArrayLike) -> FloatArray:
        return self._nodes(triangles_m).reshape(-1, 3, 2)

    def _covers(self, nodes: FloatArray) -> BoolArray:
        return _are_on_lattice(nodes, self._heights_m.shape)

    def _cells(self, nodes: FloatArray) -> IntArray:
        return _cells(nodes, self._heights_m.shape)

    def _bilinear(self, nodes: FloatArray, cells: IntArray) -> FloatArray:
        return _bilinear(self._heights_m, nodes, cells)


class _Highest:
    """Maxima of a lattice's bilinear surface; minima are those of the negated heights.

    A pyramid of maxima over 2 x 2 tiles bounds the search.
    """

    def __init__(self, heights: FloatArray) -> None:
        self._heights = heights
        self._pyramid = _pyramid(np.where(np.isnan(heights), np.inf, heights))
        self.highest_of_all = float(self._pyramid[-1][0, 0])

    def along(self, starts: FloatArray, ends: FloatArray) -> FloatArray:
        """Return the maximum (N,) along straight legs between (N, 2) rows and columns.

        A leg is cut where it crosses a line of the lattice; on each piece the surface is a
        parabola.
        """
        shape = self._heights.shape
        known = _are_on_lattice(starts, shape) & _are_on_lattice(ends, shape)
        highest = np.full(len(starts), np.inf)
        if known.any():
            highest[known] = self._along_known(starts[known], ends[known])
        return highest

    def _along_known(self, starts: FloatArray, ends: FloatArray) -> FloatArray:
        leg, share = _lattice_crossings(starts, ends)
        # Neighbouring crossings of one leg bound a piece inside one lattice cell.
        is_piece = leg[1:] == leg[:-1]
        leg, begin, end = leg[:-1][is_piece], share[:-1][is_piece], share[1:][is_piece]
        step = ends[leg] - starts[leg]
        places = [starts[leg] + t[:, np.newaxis] * step for t in (begin, (begin + end) / 2.0, end)]
        cells = _cells(places[1], self._heights.shape)
        first, middle, last = (_bilinear(self._heights, place, cells) for place in places)
        peaks = _parabola_top(first, middle, last)
        highest = np.full(len(starts), -np.inf)
        np.maximum.at(highest, leg, np.where(np.isnan(peaks), np.inf, peaks))
        return highest

    def within(self, triangles: FloatArray) -> FloatArray:
        """Return the maximum (N,) within (N, 3, 2) triangles of rows and columns."""
        count = len(triangles)
        sides = np.concatenate([triangles[:, index] for index in (0, 1, 2)])
        ends = np.concatenate([triangles[:, index] for index in (1, 2, 0)])
        highest: FloatArray = self.along(sides, ends).reshape(3, count).max(axis=0)
        self._raise_to_nodes_within(triangles, highest)
        return highest

    def is_below(self, triangles: FloatArray, heights: FloatArray) -> BoolArray:
        """Return whether the maximum within each triangle is at most `heights`, (N,).

        From the cheapest test to the exact one, each only for triangles left undecided.
        """
        below: BoolArray = self._are_known(triangles) & (heights >= self.highest_of_all)
        if not below.all():
            below = self._bounds(triangles) <= heights
        if not below.all():
            below[~below] = self.within(triangles[~below]) <= heights[~below]
        return below

    def _are_known(self, triangles: FloatArray) -> BoolArray:
        nodes = triangles.reshape(-1, 2)
        known = _are_on_lattice(nodes, self._heights.shape)
        return np.asarray(known.reshape(-1, 3).all(axis=1))

    def _bounds(self, triangles: FloatArray) -> FloatArray:
        """Return upper bounds (N,) of the ground within the triangles' boxes, from the pyramid."""
        low, high = triangles.min(axis=1), triangles.max(axis=1)
        known = self._are_known(triangles)
        first = np.floor(np.where(known[:, np.newaxis], low, 0.0)).astype(np.int64)
        last = np.ceil(np.where(known[:, np.newaxis], high, 0.0)).astype(np.int64)
        # At this level two by two tiles cover the box.
        levels = np.ceil(np.log2((last - first).max(axis=1, initial=0) + 1)).astype(np.int64)
        bounds = np.full(len(triangles), np.inf)
        for level in np.unique(levels[known]):
            here = known & (levels == level)
            top, left = (first[here] >> level).T
            bottom, right = (last[here] >> level).T
            tops = self._pyramid[level]
            bounds[here] = np.maximum.reduce(
                [tops[top, left], tops[top, right], tops[bottom, left], tops[bottom, right]]
            )
        return bounds

    def _raise_to_nodes_within(self, triangles: FloatArray, highest: FloatArray) -> None:
        """Raise `highest` to the highest node in each triangle, from coarse tiles to fine ones."""
        normals, offsets = _half_planes(triangles)
        # A triangle without area is a leg, and `along` has already covered it.
        which = np.flatnonzero((highest < np.inf) & _have_area(triangles))
        tiles = np.zeros((len(which), 2), dtype=np.int64)
        for level in range(len(self._pyramid) - 1, -1, -1):
            tops = self._pyramid[level]
            exists = (tiles < tops.shape).all(axis=1)
            which, tiles = which[exists], tiles[exists]
            top = tops[tiles[:, 0], tiles[:, 1]]
            least, most = _sides_of_tiles(tiles, level, normals[which], offsets[which])
            is_inside, meets = (least >= 0.0).all(axis=1), (most >= 0.0).all(axis=1)
            np.maximum.at(highest, which[is_inside], top[is_inside])
            # Branch and bound: descend only into tiles that may raise the maximum.
            goes_on = meets & ~is_inside & (top > highest[which])
            which = np.repeat(which[goes_on], 4)
            tiles = (2 * tiles[goes_on][:, np.newaxis] + _CHILDREN).reshape(-1, 2)


_CHILDREN = np.array([[0, 0], [0, 1], [1, 0], [1, 1]])


def _are_on_lattice(nodes: FloatArray, shape: tuple[int, ...]) -> BoolArray:
    is_between = (nodes >= 0.0) & (nodes <= np.array(shape) - 1.0)
    return np.asarray(is_between.all(axis=1))


def _cells(nodes: FloatArray, shape: tuple[int, ...]) -> IntArray:
    """Return the upper-left node (N, 2) of the lattice cell of each point."""
    return np.clip(np.floor(nodes).astype(np.int64), 0, np.array(shape) - 2)


def _bilinear(heights: FloatArray, nodes: FloatArray, cells: IntArray) -> FloatArray:
    row, col = cells.T
    down, right = (nodes - cells).T
    upper = heights[row, col] * (1.0 - right) + heights[row, col + 1] * right
    lower = heights[row + 1, col] * (1.0 - right) + heights[row + 1, col + 1] * right
    between: FloatArray = upper * (1.0 - down) + lower * down
    return between


def _lattice_crossings(starts: FloatArray, ends: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return (leg, share of its length), sorted, of starts, lattice crossings and ends of legs."""
    count = len(starts)
    legs = [np.arange(count), np.arange(count)]
    shares = [np.zeros(count), np.ones(count)]
    for axis in (0, 1):
        start, end = starts[:, axis], ends[:, axis]
        first = np.floor(np.minimum(start, end)).astype(np.int64) + 1
        crossings = np.maximum(np.ceil(np.maximum(start, end)).astype(np.int64) - first, 0)
        leg = np.repeat(np.arange(count), crossings)
        number = np.arange(len(leg)) - np.repeat(np.cumsum(crossings) - crossings, crossings)
        legs.append(leg)
        shares.append((first[leg] + number - start[leg]) / (end - start)[leg])
    leg, share = np.concatenate(legs), np.concatenate(shares)
    order = np.lexsort((share, leg))
    return leg[order], share[order]


def _parabola_top(first: FloatArray, middle: FloatArray, last: FloatArray) -> FloatArray:
    """Return the maximum of parabolas given at both ends and the middle; NaN for NaN."""
    slope, bend = last - first, 2.0 * (first + last - 2.0 * middle)
    has_top = np.abs(slope) < -bend
    rise = np.divide(slope**2, -4.0 * bend, out=np.zeros_like(slope), where=has_top)
    top = np.where(has_top, middle + rise, np.maximum(first, last))
    known: FloatArray = top + 0.0 * middle
    return known


def _have_area(triangles: FloatArray) -> BoolArray:
    return np.asarray(_turns(triangles) != 0.0)


def _turns(triangles: FloatArray) -> FloatArray:
    """Return twice the signed areas (N,) of the triangles."""
    first, second = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 1]
    turns: FloatArray = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return turns


def _half_planes(triangles: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Inward normals (N, 3, 2) and offsets (N, 3): inside where normal . place + offset >= 0."""
    edges = np.roll(triangles, -1, axis=1) - triangles
    normals = np.stack([-edges[..., 1], edges[..., 0]], axis=-1)
    normals = np.where(_turns(triangles)[:, np.newaxis, np.newaxis] < 0.0, -normals, normals)
    return normals, -(normals * triangles).sum(axis=-1)


def _sides_of_tiles(
    tiles: IntArray, level: int, normals: FloatArray, offsets: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return minimum and maximum of each half-plane's function over each tile, (N, 3) each."""
    low = (tiles << level).astype(np.float64)[:, np.newaxis]
    high = low + ((1 << level) - 1)
    at_low, at_high = normals * low, normals * high
    least: FloatArray = np.minimum(at_low, at_high).sum(axis=-1) + offsets
    most: FloatArray = np.maximum(at_low, at_high).sum(axis=-1) + offsets
    return least, most


def _pyramid(heights: FloatArray) -> list[FloatArray]:
    """Return the levels: the nodes, then maxima over 2 x 2 of the level below, up to one tile."""
    levels = [heights]
    while max(levels[-1].shape) > 1:
        below = levels[-1]
        padded = np.pad(below, [(0, size % 2) for size in below.shape], constant_values=-np.inf)
        rows, cols = padded.shape
        levels.append(padded.reshape(rows // 2, 2, cols // 2, 2).max(axis=(1, 3)))
    return levels
