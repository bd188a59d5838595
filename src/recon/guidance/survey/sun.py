"""Where it was sunny at a moment that has been, by the shade maps of that time."""

from collections.abc import Sequence

import numpy as np

from recon.guidance.survey.cells import BoolArray
from recon.guidance.survey.crossing import Window
from recon.model.geo import GroundGrid
from recon.model.shade import ShadeMap
from recon.model.units import seconds_to_ns


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
    rows = np.arange(window.first_row, window.last_row)
    cols = np.arange(window.first_col, window.last_col)
    north_m = grid.north_m - (rows + 0.5) * grid.cell_m
    east_m = grid.west_m + (cols + 0.5) * grid.cell_m
    row = np.floor((shade.grid.north_m - north_m) / shade.grid.cell_m).astype(np.int64)
    col = np.floor((east_m - shade.grid.west_m) / shade.grid.cell_m).astype(np.int64)
    on_map = np.outer((row >= 0) & (row < shade.grid.rows), (col >= 0) & (col < shade.grid.cols))
    at = np.ix_(np.clip(row, 0, shade.grid.rows - 1), np.clip(col, 0, shade.grid.cols - 1))
    is_known: BoolArray = on_map & shade.valid[at]
    return is_known & shade.is_sunlit[at], is_known
