"""How well a level of sun explains a frame: its cells against the curve from sun to shade.

All cells of a frame count, each for sun, for shade or for a place between, so that a frame with
little clear sun is not read by its edges. Cells brighter than full sun, or darker than full shade,
speak against a level; so does the wrong slope, for thin cloud dims sunlit land without much colour,
and near full shade colour changes as much as light. A frame that is all alike is explained equally
well by sun and by shade.
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from recon.detection.sunlit.contrast import (
    COLOUR_NOISE,
    LIGHT_NOISE,
    Contrast,
    curve,
)
from recon.detection.sunlit.levels import Values
from recon.model.arrays import FloatArray

FloatGrid = npt.NDArray[np.float32]
Spectra = npt.NDArray[np.complex64]

STEPS = 0.06, 0.045
"""Width of the bins in light and colour: about the noise of a cell."""
LOWEST = -2.2, -1.0
"""Light and colour of the first bin, relative to the level expected."""
BINS = 59, 56
LIGHT_BINS = (LOWEST[0] + STEPS[0] * (np.arange(BINS[0]) + 0.5)).astype(np.float32)
"""Light in the middle of each bin."""
REACH = 21, 20
"""Bins to either side of the level expected in which the level is looked for."""
OUTLIERS = 2e-3
"""Share of cells that are anything: vehicles, errors of place."""
WORTH = 12.0
"""Number of independent cells that a frame's are worth: errors of neighbours are alike."""
USUAL_LENGTH = 22.0
"""Length of the curve in standard deviations of noise: on a longer one cells are as frequent."""
ENDS_SHARE = 0.12
"""Share of full sun and of full shade each, in addition to all between. With less the ends are
drawn outward, where they are frequent; with more, inward to what is most frequent."""


def counted(light: Values, colour: Values) -> FloatGrid:
    """Return the shares of cells (BINS) by light and colour relative to a level."""
    rows, cols = (
        np.clip((values - np.float32(low)) / np.float32(step), 0, bins - 1).astype(np.intp)
        for values, low, step, bins in zip((light, colour), LOWEST, STEPS, BINS, strict=True)
    )
    counts = np.bincount(rows * BINS[1] + cols, minlength=BINS[0] * BINS[1])
    return (counts.reshape(BINS) / max(1, light.size)).astype(np.float32)


def spectra_of(shown: Sequence[FloatGrid]) -> Spectra:
    """Return what `fits` takes of frames' counts, relative to the level in the middle."""
    from scipy.fft import rfft2

    found: Spectra = np.conj(rfft2(np.stack(shown), PADDED))
    return found


def fits(spectra: Spectra, contrast: Contrast, ends_share: float = ENDS_SHARE) -> FloatGrid:
    """Return (K, 2 REACH + 1): the mean log likelihood of each frame's cells for each level."""
    from scipy.fft import irfft2

    # Rounded: few tables are ever made.
    light, colour = (0.04 * round(part / 0.04) for part in (contrast.light, contrast.colour))
    found = irfft2(spectra * _spectrum(light, colour, ends_share), PADDED)
    # A cell's place on the curve moves down as the level goes up.
    return np.ascontiguousarray(found[:, 2 * REACH[0] :: -1, 2 * REACH[1] :: -1])


PADDED = 108, 96
"""Sizes of at least `BINS` and twice the `REACH` with small prime factors, which transform fast."""


@lru_cache(maxsize=256)
def _spectrum(light: float, colour: float, ends_share: float) -> Spectra:
    from scipy.fft import rfft2

    found: Spectra = rfft2(_log_likelihood(light, colour, ends_share), PADDED)
    return found


def _log_likelihood(light: float, colour: float, ends_share: float) -> FloatGrid:
    """Return (BINS + 2 REACH): the log of how often a cell has this light and colour."""
    axes = [
        low + step * (np.arange(-reach, bins + reach) + 0.5)
        for low, step, bins, reach in zip(LOWEST, STEPS, BINS, REACH, strict=True)
    ]
    by_light, by_colour = curve(Contrast(light, colour))
    # As frequent per noise along the curve: a flat view is explained equally well anywhere on it.
    steps = np.hypot(np.diff(by_light) / LIGHT_NOISE, np.diff(by_colour) / COLOUR_NOISE)
    weight = 0.5 * (np.append(steps, 0.0) + np.append(0.0, steps)) / USUAL_LENGTH
    weight[[0, -1]] += ends_share

    def seen(values: npt.NDArray[Any], means: FloatArray, noise: float) -> FloatArray:
        density: FloatArray = np.exp(-0.5 * (np.subtract.outer(values, means) / noise) ** 2)
        return density

    in_light = seen(axes[0], by_light, LIGHT_NOISE)
    in_colour = seen(axes[1], by_colour, COLOUR_NOISE)
    density = (in_light * weight) @ in_colour.T
    found: FloatGrid = np.log(density + OUTLIERS).astype(np.float32)
    return found
