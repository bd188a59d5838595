"""What is wrong with a picture: black, torn, or exposed for another scene."""

from dataclasses import dataclass
from random import Random
from typing import Protocol

import numpy as np

from recon.model.imagery import RgbImage

EXPOSURE_GAINS = (0.35, 0.6, 1.7, 2.6)
"""Up to one and a half stops: what a bright cloud or a dark wood does to the exposure."""


class FrameFlaw(Protocol):
    """One thing that is wrong with one picture."""

    def applied(self, rgb: RgbImage) -> RgbImage:
        """Return the picture, (rows, cols, 3) uint8, with the flaw; the one given stays whole."""
        ...


@dataclass(frozen=True, slots=True)
class Black:
    """Nothing but black, as when the video stream starts anew."""

    def applied(self, rgb: RgbImage) -> RgbImage:
        """Return black."""
        return np.zeros_like(rgb)


@dataclass(frozen=True, slots=True)
class Torn:
    """From one row down the picture is shifted sideways: parts of two."""

    row_share: float
    shift_share: float

    def applied(self, rgb: RgbImage) -> RgbImage:
        """Return the torn picture."""
        row = int(self.row_share * rgb.shape[0])
        shift = max(1, int(self.shift_share * rgb.shape[1]))
        return np.concatenate([rgb[:row], np.roll(rgb[row:], shift, axis=1)])


@dataclass(frozen=True, slots=True)
class Exposed:
    """All of it brighter or darker; what is too bright is white."""

    gain: float

    def applied(self, rgb: RgbImage) -> RgbImage:
        """Return the picture at another exposure."""
        brighter: RgbImage = np.clip(np.rint(rgb * self.gain), 0.0, 255.0).astype(np.uint8)
        return brighter


def torn(random: Random) -> Torn:
    """Draw where a picture is torn."""
    return Torn(random.uniform(0.1, 0.9), random.uniform(0.1, 0.5))


def exposed(random: Random) -> Exposed:
    """Draw an exposure."""
    return Exposed(random.choice(EXPOSURE_GAINS))
