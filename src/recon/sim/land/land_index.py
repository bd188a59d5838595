"""What of the land lies in a part of it, without looking at each thing."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Generic, TypeVar

import numpy as np

from recon.sim.land.farmland import Box, Building, Farmland, FloatArray, Plot, Pond, Tree

LONGEST_SHADOW_M = 75.0
"""Of the tallest tree or barn under the lowest sun that shadows are drawn for."""

Thing = TypeVar("Thing")


@dataclass(frozen=True, slots=True, eq=False)
class Placed(Generic[Thing]):
    """Things, and the boxes (N, 4) that they may be seen in, as west, south, east, north."""

    things: Sequence[Thing]
    boxes_m: FloatArray

    def within(self, box: Box) -> list[Thing]:
        """Return what touches a box, in the land's order."""
        west, south, east, north = box
        boxes = self.boxes_m
        touches = (boxes[:, 0] < east) & (boxes[:, 2] > west)
        touches &= (boxes[:, 1] < north) & (boxes[:, 3] > south)
        return [self.things[number] for number in np.flatnonzero(touches).tolist()]


@dataclass(frozen=True, slots=True, eq=False)
class LandIndex:
    """The land's things by place; trees and buildings with their shadows."""

    plots: Placed[Plot]
    tracks: Placed[Box]
    yards: Placed[Box]
    buildings: Placed[Building]
    ponds: Placed[Pond]
    trees: Placed[Tree]


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


def _placed(things: Sequence[Thing], boxes: Sequence[Box], wider_m: float = 0.0) -> Placed[Thing]:
    around = np.array(boxes, dtype=np.float64).reshape(-1, 4)
    return Placed(things, around + wider_m * np.array([-1.0, -1.0, 1.0, 1.0]))
