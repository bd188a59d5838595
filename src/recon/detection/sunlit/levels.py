"""The level of full sun in a frame: of light (exposure) and of colour (white balance)."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Values: TypeAlias = npt.NDArray[np.float32]

LIGHT_BIN, COLOUR_BIN = 0.03, 0.02
SMOOTHING = np.array([1.0, 2.0, 3.0, 2.0, 1.0])
LEAST_CELLS = 50


@dataclass(frozen=True, slots=True)
class Level:
    """Full sun in a frame: natural logs, relative to the land's own light and colour."""

    light: float
    colour: float

    def __add__(self, change: "Level") -> "Level":
        return Level(self.light + change.light, self.colour + change.colour)

    def __sub__(self, other: "Level") -> "Level":
        return Level(self.light - other.light, self.colour - other.colour)


UNCHANGED = Level(0.0, 0.0)


def level_of(light: Values, colour: Values) -> Level:
    """Return the modes of both: what most cells (N,) have."""
    return Level(_mode(light, LIGHT_BIN), _mode(colour, COLOUR_BIN))


def _mode(values: Values, width: float) -> float:
    """Return the most frequent value: the mean around the peak of a smoothed histogram."""
    lowest = float(values.min())
    counts = np.bincount(((values - lowest) / width).astype(np.intp))
    peak = int(np.argmax(np.convolve(counts, SMOOTHING, "same")))
    centre = lowest + (peak + 0.5) * width
    near = values[np.abs(values - centre) < 2.0 * width]
    return float(near.mean(dtype=np.float64)) if near.size else centre
