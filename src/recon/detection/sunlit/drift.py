"""What exposure and white balance do from frame to frame, whatever is sun and shade.

Between two frames a few seconds apart most cells keep their light: the mode of the cells' changes
is the camera's. Errors add up, so this only bridges the time between frames that tell the level of
sun by themselves.
"""

from dataclasses import dataclass
from math import expm1

import numpy as np

from recon.detection.sunlit.colour import CellColour
from recon.detection.sunlit.levels import COLOUR_BIN, LEAST_CELLS, LIGHT_BIN, Level, mode
from recon.model.units import NS_PER_S, seconds_to_ns

LONGEST_GAP_S = 20.0
"""Over a longer one most cells may have changed."""
SAME_COLOUR = 0.06
"""Cells whose colour changed by no more than this beside white balance stayed as they were."""
LOCK_S = 60.0
"""A camera that sets its exposure by itself does so within a minute under moving clouds; the errors
of so many frames stay below the limits."""
LOCKED_LIGHT, LOCKED_COLOUR = 0.15, 0.10
"""Changes within that time of a camera that is not locked."""
CLOUD_COLOUR = 0.25
"""Thin cloud dims the whole view too, but makes it bluer by at least 0.4 of that."""


@dataclass(frozen=True, slots=True, eq=False)
class Drift:
    """The latest frame, and the sum of all changes of the camera up to it."""

    at_ns: int
    cells: CellColour
    total: Level
    recent: tuple[tuple[int, Level], ...] = ()
    """Capture times and totals of the last minute, without the latest."""

    def lock_problem(self) -> str:
        """Return what shows that exposure or white balance is not locked; empty if nothing does."""
        for at_ns, total in self.recent:
            change, after_s = since(total, self.total), (self.at_ns - at_ns) / NS_PER_S
            light, colour = abs(change.light), abs(change.colour)
            if light > LOCKED_LIGHT and colour < CLOUD_COLOUR * light:
                return f"exposure changed by {expm1(light):.0%} within {after_s:.0f} s"
            if colour > LOCKED_COLOUR and light < LOCKED_LIGHT / 2.0:
                return f"white balance changed by {expm1(colour):.0%} within {after_s:.0f} s"
        return ""


def followed(drift: Drift | None, cells: CellColour, at_ns: int) -> Drift:
    """Return the drift with one more frame; across a long gap it counts as none."""
    if drift is None:
        return Drift(at_ns, cells, Level(0.0, 0.0))
    both = drift.cells.seen & cells.seen
    is_near = at_ns - drift.at_ns <= seconds_to_ns(LONGEST_GAP_S)
    if not is_near or np.count_nonzero(both) < LEAST_CELLS:
        # What the camera did meanwhile is unknown.
        return Drift(at_ns, cells, drift.total)
    colours = (cells.colour - drift.cells.colour)[both]
    colour = mode(colours, COLOUR_BIN)
    stays = np.abs(colours - np.float32(colour)) < SAME_COLOUR
    light = mode((cells.light - drift.cells.light)[both][stays], LIGHT_BIN)
    total = Level(drift.total.light + light, drift.total.colour + colour)
    oldest_ns = at_ns - seconds_to_ns(LOCK_S)
    recent = tuple(each for each in drift.recent if each[0] >= oldest_ns)
    return Drift(at_ns, cells, total, (*recent, (drift.at_ns, drift.total)))


def since(start: Level, end: Level) -> Level:
    """Return the drift between two totals."""
    return Level(end.light - start.light, end.colour - start.colour)


def moved(level: Level, start: Level, end: Level) -> Level:
    """Return a level of sun, moved by the drift between two totals."""
    change = since(start, end)
    return Level(level.light + change.light, level.colour + change.colour)
