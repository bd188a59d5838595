"""Which cells are in view while a vehicle flies a straight way, from when to when."""

from dataclasses import dataclass

import numpy as np

from recon.guidance.survey.cells import BoolArray, FloatArray, IntArray, SurveyCells
from recon.guidance.survey.lattice import RowLattice
from recon.guidance.survey.swath import Swath
from recon.model.geo import GroundGrid

Place = tuple[float, float]
STANDING_M = 1e-6


@dataclass(frozen=True, slots=True)
class Window:
    """A part of a grid: rows and columns from the first to before the last."""

    first_row: int
    last_row: int
    first_col: int
    last_col: int

    @property
    def shape(self) -> tuple[int, int]:
        """How many rows and columns; none where it lies off the grid."""
        return self.last_row - self.first_row, self.last_col - self.first_col

    @property
    def index(self) -> tuple[slice, slice]:
        """To take the window out of an array on the grid."""
        return slice(self.first_row, self.last_row), slice(self.first_col, self.last_col)


@dataclass(frozen=True, slots=True, eq=False)
class Crossing:
    """Cells of a window that come into view: arrays of its shape.

    `enters_ns` and `leaves_ns` are within the way's own times; `was_in_view` and `stays_in_view`
    say that the cell is in view at its beginning and at its end.
    """

    window: Window
    is_in_view: BoolArray
    enters_ns: IntArray
    leaves_ns: IntArray
    was_in_view: BoolArray
    stays_in_view: BoolArray


def crossing(
    cells: SurveyCells,
    lattice: RowLattice,
    swath: Swath,
    way: tuple[Place, Place],
    times_ns: tuple[int, int],
) -> Crossing:
    """Return what is in view on a way in metres along and across; the footprint lies along."""
    window = _window(cells.grid, lattice, swath, way)
    (start_along, start_across), (end_along, end_across) = way
    first_a, last_a = _shares(
        cells.along_m[window.index], start_along, end_along, swath.half_along_m
    )
    first_b, last_b = _shares(
        cells.across_m[window.index], start_across, end_across, swath.half_across_m
    )
    first, last = np.maximum(first_a, first_b), np.minimum(last_a, last_b)
    is_in_view = (first <= last) & (first <= 1.0) & (last >= 0.0)
    start_ns, end_ns = times_ns

    def at_ns(share: FloatArray) -> IntArray:
        ns: IntArray = start_ns + np.round(np.clip(share, 0.0, 1.0) * (end_ns - start_ns)).astype(
            np.int64
        )
        return ns

    return Crossing(
        window,
        is_in_view,
        at_ns(first),
        at_ns(last),
        is_in_view & (first <= 0.0),
        is_in_view & (last >= 1.0),
    )


def _shares(
    cell_m: FloatArray, start_m: float, end_m: float, half_m: float
) -> tuple[FloatArray, FloatArray]:
    """From what share of the way to what share a cell is within `half_m`, on one axis."""
    way_m = end_m - start_m
    if abs(way_m) < STANDING_M:
        is_near = np.abs(cell_m - start_m) <= half_m
        return np.where(is_near, -np.inf, np.inf), np.where(is_near, np.inf, -np.inf)
    one = (cell_m - half_m - start_m) / way_m
    other = (cell_m + half_m - start_m) / way_m
    return np.minimum(one, other), np.maximum(one, other)


def _window(
    grid: GroundGrid, lattice: RowLattice, swath: Swath, way: tuple[Place, Place]
) -> Window:
    """The cells round all that the footprint passes over."""
    places = np.array(way)
    least, most = places.min(axis=0), places.max(axis=0)
    half = np.array([swath.half_along_m, swath.half_across_m])
    (west, south), (east, north) = least - half, most + half
    corners = lattice.east_north_m([(west, south), (west, north), (east, south), (east, north)])
    cols = (corners[:, 0] - grid.west_m) / grid.cell_m
    rows = (grid.north_m - corners[:, 1]) / grid.cell_m
    first_row, last_row = _clipped(rows, grid.rows)
    first_col, last_col = _clipped(cols, grid.cols)
    return Window(first_row, last_row, first_col, last_col)


def _clipped(at: FloatArray, count: int) -> tuple[int, int]:
    first = int(np.clip(np.floor(at.min()), 0, count))
    return first, max(first, int(np.clip(np.ceil(at.max()), 0, count)))
