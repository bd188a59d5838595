"""A square of the land's pixels, and where things lie in it.

Pixels of a size `cell_m` are numbered over the whole land: column j covers east from j to j + 1
cells, row i covers north from -i - 1 to -i cells, so the origin is a corner of four.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from recon.sim.land.farmland import Box, FloatArray, Tree
from recon.sim.land.land_index import LandIndex

MARGIN_PX = 6
"""Blurred edges look this far beyond a part's own pixels."""
FRACTION_BITS = 4
"""OpenCV draws at sixteenths of a pixel."""
SMALLEST_CROWN_PX = 0.6
"""Smaller crowns are not drawn: coarse pixels are the mean of what is in them."""


@dataclass(frozen=True, slots=True)
class Part:
    """A square of the land's pixels: its first row and column, and its size."""

    row: int
    col: int
    size: int
    cell_m: float

    def with_margin(self) -> "Part":
        """Return the part with what lies around it."""
        return Part(
            self.row - MARGIN_PX, self.col - MARGIN_PX, self.size + 2 * MARGIN_PX, self.cell_m
        )

    @property
    def box_m(self) -> Box:
        """West, south, east, north."""
        west, north = self.col * self.cell_m, -self.row * self.cell_m
        return west, north - self.size * self.cell_m, west + self.size * self.cell_m, north


def seen_trees(index: LandIndex, part: Part) -> list[Tree]:
    """Return the trees large enough for a pixel that stand in a part or shade it."""
    trees = index.trees.within(part.box_m)
    return [tree for tree in trees if tree.radius_m > SMALLEST_CROWN_PX * part.cell_m]


def slices(part: Part, box: Box) -> tuple[slice, slice]:
    """Return the part's rows and columns that a box covers."""
    west, south, east, north = (round(edge / part.cell_m) for edge in box)
    row, col, size = part.row, part.col, part.size
    rows = slice(min(size, max(0, -north - row)), min(size, max(0, -south - row)))
    return rows, slice(min(size, max(0, west - col)), min(size, max(0, east - col)))


def fixed_point(part: Part, points_m: FloatArray) -> npt.NDArray[np.int32]:
    """Return (N, 2) column and row in sixteenths of the part's pixels."""
    cols = points_m[:, 0] / part.cell_m - 0.5 - part.col
    rows = -points_m[:, 1] / part.cell_m - 0.5 - part.row
    points: npt.NDArray[np.int32] = np.rint(
        np.stack([cols, rows], axis=1) * 2**FRACTION_BITS
    ).astype(np.int32)
    return points


def is_near(points: npt.NDArray[np.int32], part: Part, reach_px: int = 2) -> bool:
    """Return whether points (N, 2) in sixteenths of pixels may reach into a part."""
    low, high = points.min(axis=0) / 2**FRACTION_BITS, points.max(axis=0) / 2**FRACTION_BITS
    return bool((low < part.size + reach_px).all() and (high > -reach_px).all())
