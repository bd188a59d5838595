"""Where it was sunny at a moment that has been, by the shade maps of that time."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from recon.guidance.survey.cells import BoolArray, IntArray
from recon.guidance.survey.crossing import Window
from recon.model.geo import GroundGrid
from recon.model.shade import SUNLIT_TRANSMITTANCE, ShadeMap
from recon.model.units import seconds_to_ns

OFF = -1
"""In place of a row or column of a map that does not reach there."""


def nearest_map(maps: Sequence[ShadeMap], at_ns: int, age_s: float) -> ShadeMap | None:
    """Return the map nearest in time to a moment, None when all are farther off than `age_s`."""
    nearest = min(maps, key=lambda shade: abs(shade.captured_at_ns - at_ns), default=None)
    if nearest is None or abs(nearest.captured_at_ns - at_ns) > seconds_to_ns(age_s):
        return None
    return nearest


def sunlit_cells(
    shade: ShadeMap | None, grid: GroundGrid, window: Window
) -> tuple[BoolArray, BoolArray]:
    """Return which cells of a window of `grid` were sunlit, and of which anything is known.

    Each cell is looked up at its centre.
    """
    if shade is None or shade.grid.frame != grid.frame:
        nothing = np.zeros(window.shape, dtype=np.bool_)
        return nothing, nothing
    row, col = _on_map(grid, shade.grid)
    row, col = row[window.first_row : window.last_row], col[window.first_col : window.last_col]
    at = row[:, np.newaxis], col[np.newaxis, :]
    is_known: BoolArray = shade.valid[at] & (at[0] != OFF) & (at[1] != OFF)
    with np.errstate(invalid="ignore"):
        return is_known & (shade.transmittance[at] >= SUNLIT_TRANSMITTANCE), is_known


@lru_cache(maxsize=8)
def _on_map(grid: GroundGrid, other: GroundGrid) -> tuple[IntArray, IntArray]:
    """Return in which row of another grid each of a grid's rows lies, and so the columns."""
    north_m = grid.north_m - (np.arange(grid.rows) + 0.5) * grid.cell_m
    east_m = grid.west_m + (np.arange(grid.cols) + 0.5) * grid.cell_m
    row = np.floor((other.north_m - north_m) / other.cell_m).astype(np.int64)
    col = np.floor((east_m - other.west_m) / other.cell_m).astype(np.int64)
    row[(row < 0) | (row >= other.rows)] = OFF
    col[(col < 0) | (col >= other.cols)] = OFF
    return row, col
