"""Which cells are in view while a vehicle flies a straight path, from when to when."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, cos, floor, radians, sin

import numpy as np

from recon.geo import nearest_cells
from recon.guidance.survey.cells import CoverageCells
from recon.guidance.survey.lattice import AlongAcross, RowLattice, Swath
from recon.model.arrays import BoolArray, FloatArray, IntArray
from recon.model.geo import GroundGrid
from recon.model.shade import ShadeMap
from recon.model.units import seconds_to_ns

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
        """Return the index that takes the window out of an array on the grid."""
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
    cells: CoverageCells,
    lattice: RowLattice,
    swath: Swath,
    path: tuple[AlongAcross, AlongAcross],
    times_ns: tuple[int, int],
) -> Crossing:
    """Return what is in view on a path in metres along and across; the footprint lies along."""
    window = _window(cells.grid, lattice, swath, path)
    (start_along, start_across), (end_along, end_across) = path
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
        within = np.minimum(np.maximum(share, 0.0), 1.0)
        ns: IntArray = start_ns + np.rint(within * (end_ns - start_ns)).astype(np.int64)
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
    """Return from which to which share of the way a cell is within `half_m`, on one axis."""
    path_m = end_m - start_m
    if abs(path_m) < STANDING_M:
        is_near = np.abs(cell_m - start_m) <= half_m
        return np.where(is_near, -np.inf, np.inf), np.where(is_near, np.inf, -np.inf)
    one = (cell_m - half_m - start_m) / path_m
    other = (cell_m + half_m - start_m) / path_m
    return np.minimum(one, other), np.maximum(one, other)


def _window(
    grid: GroundGrid, lattice: RowLattice, swath: Swath, path: tuple[AlongAcross, AlongAcross]
) -> Window:
    """The cells round all that the footprint passes over."""
    (one_along, one_across), (other_along, other_across) = path
    middle_m = ((one_along + other_along) / 2.0, (one_across + other_across) / 2.0)
    half_along_m = abs(other_along - one_along) / 2.0 + swath.half_along_m
    half_across_m = abs(other_across - one_across) / 2.0 + swath.half_across_m
    # The box round a turned rectangle reaches as far as its half axes do together.
    bearing = radians(lattice.bearing_deg)
    sine, cosine = abs(sin(bearing)), abs(cos(bearing))
    half_east_m = half_along_m * sine + half_across_m * cosine
    half_north_m = half_along_m * cosine + half_across_m * sine
    ((east_m, north_m),) = lattice.east_north_m([middle_m]).tolist()
    first_row, last_row = _clipped(grid.north_m - north_m, half_north_m, grid.cell_m, grid.rows)
    first_col, last_col = _clipped(east_m - grid.west_m, half_east_m, grid.cell_m, grid.cols)
    return Window(first_row, last_row, first_col, last_col)


def _clipped(middle_m: float, half_m: float, cell_m: float, count: int) -> tuple[int, int]:
    """Return from which to which cell a span reaches, on one axis of a grid."""
    first = min(max(floor((middle_m - half_m) / cell_m), 0), count)
    last = min(max(ceil((middle_m + half_m) / cell_m), first), count)
    return first, last


def nearest_map(maps: Sequence[ShadeMap], at_ns: int, age_s: float) -> ShadeMap | None:
    """Return the map nearest in time to a moment, None when all are farther off than `age_s`."""
    nearest = min(maps, key=lambda shade: abs(shade.captured_at_ns - at_ns), default=None)
    if nearest is None or abs(nearest.captured_at_ns - at_ns) > seconds_to_ns(age_s):
        return None
    return nearest


def sunlit_cells(
    shade: ShadeMap | None, grid: GroundGrid, window: Window, least_transmittance: float
) -> tuple[BoolArray, BoolArray]:
    """Return which cells of a window of `grid` were certainly sunlit, and which have a value.

    Each cell is looked up at its centre.
    """
    if shade is None or shade.grid.frame != grid.frame:
        nothing = np.zeros(window.shape, dtype=np.bool_)
        return nothing, nothing
    rows, cols, is_on = nearest_cells(shade.grid, grid)
    part = slice(window.first_row, window.last_row), slice(window.first_col, window.last_col)
    at = rows[part[0]], cols[:, part[1]]
    is_known: BoolArray = shade.valid[at] & is_on[part]
    with np.errstate(invalid="ignore"):
        return is_known & (shade.transmittance[at] >= least_transmittance), is_known
