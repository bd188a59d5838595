"""Cells of ground grids: where their centres are, and which cell of another grid is there."""

from functools import lru_cache
from math import floor

import numpy as np
import numpy.typing as npt

from recon.model.arrays import FloatArray
from recon.model.geo import GroundGrid

IndexArray = npt.NDArray[np.intp]
MaskArray = npt.NDArray[np.bool_]
FloatMap = npt.NDArray[np.float32]


def cell_centres_m(grid: GroundGrid) -> tuple[FloatArray, FloatArray]:
    """Return easts (cols,) and norths (rows,) of the centres of a grid's cells."""
    east_m = grid.west_m + (np.arange(grid.cols, dtype=np.float64) + 0.5) * grid.cell_m
    north_m = grid.north_m - (np.arange(grid.rows, dtype=np.float64) + 0.5) * grid.cell_m
    return east_m, north_m


def cell_at(grid: GroundGrid, east_m: float, north_m: float) -> tuple[int, int]:
    """Return row and column of a place; beyond the grid too."""
    return floor((grid.north_m - north_m) / grid.cell_m), floor(
        (east_m - grid.west_m) / grid.cell_m
    )


def cells_of(
    grid: GroundGrid, east_m: FloatArray, north_m: FloatArray
) -> tuple[IndexArray, IndexArray]:
    """Return rows and columns, each of the shape of its places; some may be off the grid."""
    rows = np.floor((grid.north_m - north_m) / grid.cell_m).astype(np.intp)
    return rows, np.floor((east_m - grid.west_m) / grid.cell_m).astype(np.intp)


def read_at(values: FloatMap, cells: tuple[IndexArray, IndexArray]) -> FloatMap:
    """Return a map's values (N,) in cells; NaN off it."""
    rows, cols = cells
    is_on = (rows >= 0) & (rows < values.shape[0]) & (cols >= 0) & (cols < values.shape[1])
    return np.where(is_on, values[rows * is_on, cols * is_on], np.nan).astype(np.float32)


@lru_cache(maxsize=32)
def nearest_cells(
    source: GroundGrid, target: GroundGrid, off_m: tuple[float, float] = (0.0, 0.0)
) -> tuple[IndexArray, IndexArray, MaskArray]:
    """Return the source's row and column (R, 1), (1, C) of each target cell, and where it has one.

    Read `off_m` east and north of the target's cells. Rows and columns are clipped to the source.
    Both grids are in one local frame.
    """
    east_m, north_m = cell_centres_m(target)
    rows, cols = cells_of(source, east_m + off_m[0], north_m + off_m[1])
    inside = np.logical_and.outer(
        (rows >= 0) & (rows < source.rows), (cols >= 0) & (cols < source.cols)
    )
    clipped = np.clip(rows, 0, source.rows - 1), np.clip(cols, 0, source.cols - 1)
    return clipped[0][:, np.newaxis], clipped[1][np.newaxis, :], inside
