"""Where full sun lies in a frame: its level of light (exposure) and of colour (white balance).

Most cells of a frame are alike once the land is taken out: the main level. Cells clearly brighter
and redder beside it make the main level shade; cells clearly darker and bluer make it sun. A frame
with neither is flat: its main level may be either, and only its neighbours in time can tell.
"""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from recon.detection.sunlit.contrast import Contrast

Values: TypeAlias = npt.NDArray[np.float32]

LIGHT_BIN, COLOUR_BIN = 0.03, 0.02
SMOOTHING = np.array([1.0, 2.0, 3.0, 2.0, 1.0])
MAIN_WIDTH = 0.12
"""Half width of the main level in light, within which its colour is read."""
CLEAR_LIGHT, CLEAR_COLOUR = 0.45, 0.4
"""Shares of the contrast by which a cell must differ from the main level to count."""
LEAST_SHARE = 0.02
"""Share of the cells that shows that there are both sun and shade."""
MEASURED_SHARE = 0.08
"""Share of the cells from which the second level can be measured."""
LEAST_CELLS = 50


@dataclass(frozen=True, slots=True)
class Level:
    """Full sun in a frame: natural logs, relative to the land's own light and colour."""

    light: float
    colour: float


@dataclass(frozen=True, slots=True)
class FrameLevels:
    """What one frame by itself shows."""

    main: Level
    sun: Level | None
    """None for a flat frame."""
    contrast: Contrast | None = None
    """Where both levels can be measured."""
    weight: float = 0.0
    """The share of the cells beside the main level that show which one it is."""


def mode(values: Values, width: float) -> float:
    """Return the most frequent value: the mean around the peak of a smoothed histogram."""
    lowest = float(values.min())
    counts = np.bincount(((values - lowest) / width).astype(np.intp))
    peak = int(np.argmax(np.convolve(counts, SMOOTHING, "same")))
    centre = lowest + (peak + 0.5) * width
    near = values[np.abs(values - centre) < 2.0 * width]
    return float(near.mean(dtype=np.float64)) if near.size else centre


def level_of(light: Values, colour: Values) -> Level:
    """Return the modes of both."""
    return Level(mode(light, LIGHT_BIN), mode(colour, COLOUR_BIN))


def read(light: Values, colour: Values, contrast: Contrast) -> FrameLevels:
    """Return what a frame's cells (N,), with the land taken out, say about the level of sun."""
    main_light = mode(light, LIGHT_BIN)
    near = np.abs(light - np.float32(main_light)) < MAIN_WIDTH
    main = Level(main_light, mode(colour[near], COLOUR_BIN))
    by_light, by_colour = CLEAR_LIGHT * contrast.light, CLEAR_COLOUR * contrast.colour
    brighter = (light > main.light + by_light) & (colour < main.colour - by_colour)
    darker = (light < main.light - by_light) & (colour > main.colour + by_colour)
    share_brighter, share_darker = float(brighter.mean()), float(darker.mean())
    if max(share_brighter, share_darker) < LEAST_SHARE:
        return FrameLevels(main, None)
    is_sun = share_darker >= share_brighter
    share, chosen = (share_darker, darker) if is_sun else (share_brighter, brighter)
    if share < MEASURED_SHARE:
        return FrameLevels(main, main if is_sun else above(main, contrast), None, share)
    other = level_of(light[chosen], colour[chosen])
    sun, shade = (main, other) if is_sun else (other, main)
    measured = Contrast(sun.light - shade.light, shade.colour - sun.colour)
    return FrameLevels(main, sun, measured, share)


def above(shade: Level, contrast: Contrast) -> Level:
    """Return the level of sun over a level of shade."""
    return Level(shade.light + contrast.light, shade.colour - contrast.colour)


def apart(one: Level, other: Level, contrast: Contrast) -> float:
    """Return how far two levels are apart: 1 for sun against shade, in light and in colour."""
    light = abs(one.light - other.light) / contrast.light
    return 0.5 * (light + abs(one.colour - other.colour) / contrast.colour)
