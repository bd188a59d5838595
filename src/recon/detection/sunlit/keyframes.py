"""Frames kept over the whole flight, and what is known of the land: the data of `solution`."""

from dataclasses import dataclass

import numpy as np

from recon.detection.sunlit.colour import CellColour
from recon.detection.sunlit.contrast import Contrast
from recon.detection.sunlit.levels import Level
from recon.model.shade import FloatMap, MaskMap
from recon.model.units import NS_PER_S, seconds_to_ns

MOST = 24
"""Keyframes: with more, memory and time grow, but the land is not known better."""
SPACING_S, FIRST_SPACING_S, FIRST_S = 10.0, 5.0, 30.0
"""Time between keyframes, in which shadows move by about the width of their edges; a shorter one in
the first half minute, so that there is an answer soon."""
OLDEST_S = 2_400.0
"""The sun moves ten degrees meanwhile."""
MOVED_AFTER_S, MOVED = 2.0, 0.4
"""Time between keyframes while the drone flies aside, and the change of the hot spot's shape, as a
share of its strength, from which it has moved (about 3 degrees)."""


@dataclass(frozen=True, slots=True, eq=False)
class Keyframe:
    """A frame on the coarse grid, and the level of sun in it, once known."""

    at_ns: int
    cells: CellColour
    drift: Level
    """The camera's changes since the first frame."""
    hot_spot: FloatMap | None
    """Its shape in this frame; None while the sun's direction is unknown."""
    level: Level | None = None


@dataclass(frozen=True, slots=True, eq=False)
class SunlitLand:
    """Light and colour (R, C) of the coarse cells in full sun, up to a constant of each frame."""

    light: FloatMap
    colour: FloatMap
    known: MaskMap
    contrast: Contrast


@dataclass(frozen=True, slots=True, eq=False)
class Earlier:
    """What an earlier flight has learned of the land."""

    land: SunlitLand
    sun_colour: float | None
    """The level of colour in full sun; None where this flight's white balance may be another."""


def with_keyframe(kept: tuple[Keyframe, ...], new: Keyframe) -> tuple[Keyframe, ...]:
    """Return the keyframes with a new one; the rest stays spread evenly over the flight."""
    oldest_ns = new.at_ns - seconds_to_ns(OLDEST_S)
    all_of = [each for each in kept if each.at_ns > oldest_ns] + [new]
    if len(all_of) > MOST:
        times = np.array([each.at_ns for each in all_of])
        # The one whose neighbours are nearest to each other; the first and last two stay.
        all_of.pop(1 + int(np.argmin(times[2:-1] - times[:-3])))
    return tuple(all_of)


def is_due(kept: tuple[Keyframe, ...], at_ns: int, shape: FloatMap | None) -> bool:
    """Return whether the next keyframe is due; later in a flight they are further apart.

    `shape` is the hot spot's in the frame: one that moves shows whether a flat view is in sun.
    """
    if not kept:
        return True
    since_ns = at_ns - kept[-1].at_ns
    if since_ns >= seconds_to_ns(MOVED_AFTER_S) and _has_moved(kept[-1].hot_spot, shape):
        return True
    span_s = (at_ns - kept[0].at_ns) / NS_PER_S
    spacing_s = FIRST_SPACING_S if span_s <= FIRST_S else max(SPACING_S, 0.5 * span_s / MOST)
    # Frames come a little early or late.
    return since_ns >= seconds_to_ns(spacing_s - 0.5)


def _has_moved(before: FloatMap | None, now: FloatMap | None) -> bool:
    if before is None or now is None:
        return False
    return float(np.abs(now - before).max()) > MOVED
