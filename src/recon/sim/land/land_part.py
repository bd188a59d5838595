"""A square of the land's pixels, and an index of the objects in it.

Pixels of a size `cell_m` are numbered over the whole land: column j covers east from j to j + 1
cells, row i covers north from -i - 1 to -i cells, so the origin is a corner of four.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Generic, TypeVar

import numpy as np
import numpy.typing as npt

from recon.model.arrays import FloatArray
from recon.sim.land.farmland import Box, Building, Farmland, Plot, Pond, Tree

LONGEST_SHADOW_M = 75.0
"""Longest shadow of a tree or barn at `LOWEST_SHADOW_SUN_DEG`."""

Item = TypeVar("Item")


@dataclass(frozen=True, slots=True, eq=False)
class PlacedItems(Generic[Item]):
    """Objects, and the boxes (N, 4) they may be visible in: west, south, east, north."""

    items: Sequence[Item]
    boxes_m: FloatArray

    def within(self, box: Box) -> list[Item]:
        """Return the objects that touch a box, in drawing order."""
        west, south, east, north = box
        boxes = self.boxes_m
        touches = (boxes[:, 0] < east) & (boxes[:, 2] > west)
        touches &= (boxes[:, 1] < north) & (boxes[:, 3] > south)
        return [self.items[number] for number in np.flatnonzero(touches).tolist()]


@dataclass(frozen=True, slots=True, eq=False)
class LandIndex:
    """The land's objects by place; boxes of trees and buildings include their shadows."""

    plots: PlacedItems[Plot]
    tracks: PlacedItems[Box]
    yards: PlacedItems[Box]
    buildings: PlacedItems[Building]
    ponds: PlacedItems[Pond]
    trees: PlacedItems[Tree]


@lru_cache(maxsize=2)
def index_of(land: Farmland) -> LandIndex:
    """Return a land's index."""
    far = LONGEST_SHADOW_M
    return LandIndex(
        _placed(land.plots, [p.box_m for p in land.plots]),
        _placed(land.tracks, land.tracks),
        _placed(land.yards, land.yards),
        _placed(land.buildings, [b.box_m for b in land.buildings], far),
        _placed(land.ponds, [p.box_m for p in land.ponds]),
        _placed(land.trees, [(t.east_m, t.north_m, t.east_m, t.north_m) for t in land.trees], far),
    )


def _placed(items: Sequence[Item], boxes: Sequence[Box], wider_m: float = 0.0) -> PlacedItems[Item]:
    around = np.array(boxes, dtype=np.float64).reshape(-1, 4)
    return PlacedItems(items, around + wider_m * np.array([-1.0, -1.0, 1.0, 1.0]))


MARGIN_PX = 6
"""Reach of blurred edges beyond a part's own pixels."""
FRACTION_BITS = 4
"""OpenCV draws at sixteenths of a pixel."""
SMALLEST_CROWN_PX = 0.6
"""Smallest crown drawn: smaller ones would exceed their share of a coarse pixel."""


@dataclass(frozen=True, slots=True)
class LandPart:
    """A square of the land's pixels: its first row and column, and its size."""

    row: int
    col: int
    size: int
    cell_m: float

    def with_margin(self) -> "LandPart":
        """Return the part widened by `MARGIN_PX` on each side."""
        return LandPart(
            self.row - MARGIN_PX, self.col - MARGIN_PX, self.size + 2 * MARGIN_PX, self.cell_m
        )

    @property
    def box_m(self) -> Box:
        """West, south, east, north."""
        west, north = self.col * self.cell_m, -self.row * self.cell_m
        return west, north - self.size * self.cell_m, west + self.size * self.cell_m, north


def visible_trees(index: LandIndex, part: LandPart) -> list[Tree]:
    """Return the trees large enough to draw that stand in a part or may shade it."""
    trees = index.trees.within(part.box_m)
    return [tree for tree in trees if tree.radius_m > SMALLEST_CROWN_PX * part.cell_m]


def slices(part: LandPart, box: Box) -> tuple[slice, slice]:
    """Return the part's rows and columns that a box covers."""
    west, south, east, north = (round(edge / part.cell_m) for edge in box)
    row, col, size = part.row, part.col, part.size
    rows = slice(min(size, max(0, -north - row)), min(size, max(0, -south - row)))
    return rows, slice(min(size, max(0, west - col)), min(size, max(0, east - col)))


def fixed_point(part: LandPart, points_m: FloatArray) -> npt.NDArray[np.int32]:
    """Return (N, 2) column and row in sixteenths of the part's pixels."""
    cols = points_m[:, 0] / part.cell_m - 0.5 - part.col
    rows = -points_m[:, 1] / part.cell_m - 0.5 - part.row
    points: npt.NDArray[np.int32] = np.rint(
        np.stack([cols, rows], axis=1) * 2**FRACTION_BITS
    ).astype(np.int32)
    return points


def is_near(points: npt.NDArray[np.int32], part: LandPart, reach_px: int = 2) -> bool:
    """Return whether points (N, 2) in sixteenths of pixels may reach into a part."""
    low, high = points.min(axis=0) / 2**FRACTION_BITS, points.max(axis=0) / 2**FRACTION_BITS
    return bool((low < part.size + reach_px).all() and (high > -reach_px).all())
