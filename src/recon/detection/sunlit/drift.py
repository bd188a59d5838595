"""What exposure and white balance do from frame to frame, whatever is sun and shade.

Between two frames a few seconds apart most cells keep their light: the mode of the cells' changes
is the camera's. Errors add up, so this only bridges the time between frames that tell the level of
sun by themselves.
"""

from dataclasses import dataclass

import numpy as np

from recon.detection.sunlit.colour import CellColour
from recon.detection.sunlit.levels import COLOUR_BIN, LEAST_CELLS, LIGHT_BIN, Level, mode
from recon.model.units import seconds_to_ns

LONGEST_GAP_S = 20.0
"""Over a longer one most cells may have changed."""
SAME_COLOUR = 0.06
"""Cells whose colour changed by no more than this beside white balance stayed as they were."""


@dataclass(frozen=True, slots=True, eq=False)
class Drift:
    """The latest frame, and the sum of all changes of the camera up to it."""

    at_ns: int
    cells: CellColour
    total: Level


def followed(drift: Drift | None, cells: CellColour, at_ns: int) -> Drift:
    """Return the drift with one more frame; across a long gap it counts as none."""
    if drift is None:
        return Drift(at_ns, cells, Level(0.0, 0.0))
    both = drift.cells.seen & cells.seen
    is_near = at_ns - drift.at_ns <= seconds_to_ns(LONGEST_GAP_S)
    if not is_near or np.count_nonzero(both) < LEAST_CELLS:
        return Drift(at_ns, cells, drift.total)
    colours = (cells.colour - drift.cells.colour)[both]
    colour = mode(colours, COLOUR_BIN)
    stays = np.abs(colours - np.float32(colour)) < SAME_COLOUR
    light = mode((cells.light - drift.cells.light)[both][stays], LIGHT_BIN)
    total = drift.total
    return Drift(at_ns, cells, Level(total.light + light, total.colour + colour))


def since(start: Level, end: Level) -> Level:
    """Return the drift between two totals."""
    return Level(end.light - start.light, end.colour - start.colour)


def moved(level: Level, start: Level, end: Level) -> Level:
    """Return a level of sun, moved by the drift between two totals."""
    change = since(start, end)
    return Level(level.light + change.light, level.colour + change.colour)
