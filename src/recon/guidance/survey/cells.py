"""The survey's cells on the ground, and the stretch of a row responsible for each."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, floor

import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.guidance.survey.lattice import RowLattice, Swath
from recon.guidance.survey.rows import Piece
from recon.model.arrays import BoolArray, FloatArray, IntArray
from recon.model.geo import GroundGrid, LocalFrame

NO_STRETCH = -1
"""Stretch of cells that no row is certain to photograph."""

ROUNDING_M = 0.01


@dataclass(frozen=True, slots=True)
class Stretch:
    """A part of a piece between two marks: the shortest part that is flown again."""

    piece: int
    start_m: float
    end_m: float


@dataclass(frozen=True, slots=True, eq=False)
class CoverageCells:
    """All arrays are (R, C) on `grid`; a cell counts as its centre.

    `stretch` is the index in `stretches` of the one responsible for a cell, or `NO_STRETCH`.
    """

    grid: GroundGrid
    is_inside: BoolArray
    along_m: FloatArray
    across_m: FloatArray
    stretch: IntArray
    stretches: tuple[Stretch, ...]

    @property
    def is_reached(self) -> BoolArray:
        """The cells of the region that are certain to be on a photo of the rows."""
        is_reached: BoolArray = self.stretch != NO_STRETCH
        return is_reached

    @property
    def cell_m2(self) -> float:
        """One cell's area."""
        return self.grid.cell_m**2

    def area_m2(self, chosen: BoolArray) -> float:
        """Return the area of the chosen cells."""
        return float(chosen.sum()) * self.cell_m2


def cells_over(
    area: shapely.Geometry,
    frame: LocalFrame,
    cell_m: float,
    lattice: RowLattice,
    pieces: Sequence[Piece],
    swath: Swath,
) -> CoverageCells:
    """Return the cells of a region in east-north metres of `frame`, at multiples of `cell_m`."""
    grid = _grid(area, frame, cell_m)
    east_m = grid.west_m + cell_m * (np.arange(grid.cols) + 0.5)
    north_m = grid.north_m - cell_m * (np.arange(grid.rows) + 0.5)
    east, north = np.meshgrid(east_m, north_m)
    shapely.prepare(area)
    is_inside = np.asarray(shapely.contains_xy(area, east, north), dtype=np.bool_)
    lying = lattice.along_across_m(np.stack([east.ravel(), north.ravel()], axis=1))
    along_m, across_m = (axis.reshape(grid.rows, grid.cols) for axis in lying.T)
    stretches = tuple(_stretches(pieces, lattice))
    stretch = np.full(is_inside.shape, NO_STRETCH, dtype=np.int64)
    inside = np.nonzero(is_inside)
    stretch[inside] = _stretch_of_cells(
        along_m[inside], lattice.row_of(across_m[inside]), pieces, stretches, swath
    )
    return CoverageCells(grid, is_inside, along_m, across_m, stretch, stretches)


def _grid(area: shapely.Geometry, frame: LocalFrame, cell_m: float) -> GroundGrid:
    west, south, east, north = area.bounds
    first_col, first_row = floor(west / cell_m), ceil(north / cell_m)
    cols, rows = ceil(east / cell_m) - first_col, first_row - floor(south / cell_m)
    return GroundGrid(frame, first_col * cell_m, first_row * cell_m, cell_m, rows, cols)


def _stretches(pieces: Sequence[Piece], lattice: RowLattice) -> Iterator[Stretch]:
    for index, piece in enumerate(pieces):
        marks_m = lattice.marks_between_m(piece.start_m, piece.end_m)
        ends_m = [piece.start_m, *marks_m, piece.end_m]
        for start_m, end_m in pairwise(ends_m):
            yield Stretch(index, start_m, end_m)


def _stretch_of_cells(
    along_m: FloatArray,
    row: IntArray,
    pieces: Sequence[Piece],
    stretches: Sequence[Stretch],
    swath: Swath,
) -> IntArray:
    """Return (N,): for each cell the stretch of its own row that photographs it, or NO_STRETCH."""
    answering = np.full(len(along_m), NO_STRETCH, dtype=np.int64)
    of_piece = np.array([stretch.piece for stretch in stretches], dtype=np.int64)
    starts_m = np.array([stretch.start_m for stretch in stretches])
    reach_m = swath.beyond_m + ROUNDING_M
    for index, piece in enumerate(pieces):
        seen = (row == piece.row) & (along_m >= piece.start_m - reach_m)
        seen &= along_m <= piece.end_m + reach_m
        first, last = np.searchsorted(of_piece, [index, index + 1])
        which = first + np.searchsorted(starts_m[first:last], along_m[seen], side="right") - 1
        answering[seen] = np.clip(which, first, last - 1)
    return answering
