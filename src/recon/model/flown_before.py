"""What an earlier survey of a region left for the next one: its rows, and the cells it imaged."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from recon.model.arrays import BoolArray
from recon.model.geo import GroundGrid

StateArray = npt.NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class KeptLattice:
    """The rows of an earlier survey, in metres along and across them from the frame's origin.

    Row k runs at `first_row_m + k * spacing_m` across; rows are cut at whole numbers of photo
    distances from `first_mark_m` along. The bearing is clockwise from north.
    """

    bearing_deg: float
    first_row_m: float
    spacing_m: float
    rows: int
    first_mark_m: float


@dataclass(frozen=True, slots=True, eq=False)
class FlownCells:
    """Cells that need not be flown again: `state` (R, C) holds `CellState`s on `grid`.

    `is_light_known` (R, C): the light of a cell was known when it was imaged. Only what was imaged
    from `since_s` on counts, in seconds since 1970.
    """

    grid: GroundGrid
    state: StateArray
    is_light_known: BoolArray
    since_s: int
    is_simulated: bool
    """Whether simulated drones imaged them: then no real drone may rely on it."""
