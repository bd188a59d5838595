"""How well a level of sun explains a frame: its cells against the curve from sun to shade.

All cells of a frame count, each for sun, for shade or for a place between, so that a frame with
little clear sun is not read by its edges. A frame that is all alike is explained equally well by
sun and by shade: there the level before, moved by the camera's drift, decides, or nothing does.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from recon.detection.sunlit.contrast import (
    COLOUR_NOISE,
    ENDS_WEIGHT,
    LIGHT_NOISE,
    TRANSMITTANCES,
    Contrast,
    curve,
)
from recon.detection.sunlit.levels import Level, Values

FloatArray = npt.NDArray[np.float64]
FloatGrid = npt.NDArray[np.float32]

STEPS = 0.06, 0.045
"""Of the bins in light and colour: less than the noise of a cell."""
LOWEST = -2.2, -1.0
"""Light and colour of the first bin, relative to the level expected."""
BINS = 59, 56
REACH = 21, 20
"""Bins to either side of the level expected in which the level is looked for."""
OUTLIERS = 2e-3
"""Share of cells that are anything: vehicles, errors of place."""
WORTH = 20.0
"""A frame's cells are worth so many independent ones: neighbours are wrong together."""
LEAP = 1e-6
"""How likely a level far from what is expected is, against that one: only a seventh of the cells
that nothing else explains makes it likely."""
ALIKE = 0.3, 0.5
"""Shares of the contrast within which two levels are the same one."""
CONTRAST_STEPS = 0.1, 0.06
USUAL_SPREAD = 0.2, 0.15
"""Of contrasts between flights: cameras, haze and suns differ."""


@dataclass(frozen=True, slots=True)
class Belief:
    """A level of sun, and its standard deviations in light and colour."""

    level: Level
    light_spread: float
    colour_spread: float

    def later(self, change: Level, spread: tuple[float, float]) -> "Belief":
        """Return the belief after a change of light and colour known with these errors."""
        return Belief(
            Level(self.level.light + change.light, self.level.colour + change.colour),
            float(np.hypot(self.light_spread, spread[0])),
            float(np.hypot(self.colour_spread, spread[1])),
        )


def most_likely(
    light: Values, colour: Values, contrast: Contrast, before: Belief
) -> tuple[Belief, float]:
    """Return the level of sun of cells (N,), and the share of belief in any other level."""
    lights, colours = (
        step * np.arange(-reach, reach + 1) for step, reach in zip(STEPS, REACH, strict=True)
    )
    off = np.add.outer(
        (lights / max(before.light_spread, STEPS[0])) ** 2,
        (colours / max(before.colour_spread, STEPS[1])) ** 2,
    )
    fit = WORTH * _fit(light, colour, contrast, before.level)
    weight = _weights(fit + np.log(np.exp(-0.5 * off) + LEAP))
    row, col = np.unravel_index(int(np.argmax(weight)), weight.shape)
    near = np.logical_and.outer(
        np.abs(lights - lights[row]) < ALIKE[0] * contrast.light,
        np.abs(colours - colours[col]) < ALIKE[1] * contrast.colour,
    )
    share = float(weight[near].sum())
    local = np.where(near, weight, 0.0) / share
    light_off, light_spread = _mean_and_spread(lights, local.sum(axis=1))
    colour_off, colour_spread = _mean_and_spread(colours, local.sum(axis=0))
    there = Level(before.level.light + light_off, before.level.colour + colour_off)
    return Belief(there, light_spread, colour_spread), 1.0 - share


def best_contrast(shown: FloatGrid, usual: Contrast) -> Contrast:
    """Return the contrast that explains counts of cells (BINS) relative to their levels best."""
    lights, colours = _contrasts()
    off = np.add.outer(
        ((lights - usual.light) / USUAL_SPREAD[0]) ** 2,
        ((colours - usual.colour) / USUAL_SPREAD[1]) ** 2,
    )
    fit = WORTH * np.tensordot(_all_log_likelihoods(), shown, axes=2)
    weight = _weights(fit - 0.5 * off)
    return Contrast(float(weight.sum(axis=1) @ lights), float(weight.sum(axis=0) @ colours))


def counted(light: Values, colour: Values) -> FloatGrid:
    """Return the shares of cells (BINS) by light and colour relative to a level."""
    rows, cols = (
        np.clip((values - np.float32(low)) / np.float32(step), 0, bins - 1).astype(np.intp)
        for values, low, step, bins in zip((light, colour), LOWEST, STEPS, BINS, strict=True)
    )
    counts = np.bincount(rows * BINS[1] + cols, minlength=BINS[0] * BINS[1])
    return (counts.reshape(BINS) / max(1, light.size)).astype(np.float32)


def _fit(light: Values, colour: Values, contrast: Contrast, around: Level) -> FloatArray:
    """Return the mean log likelihood of the cells for each level in reach of one."""
    shown = counted(light - np.float32(around.light), colour - np.float32(around.colour))
    # Rounded: few tables are ever made.
    rounded = (0.04 * round(part / 0.04) for part in (contrast.light, contrast.colour))
    found = cv2.matchTemplate(_log_likelihood(*rounded), shown, cv2.TM_CCORR)
    # A cell's place on the curve moves down as the level goes up.
    return np.asarray(found[::-1, ::-1], dtype=np.float64)


def _weights(score: FloatArray) -> FloatArray:
    weight = np.exp(score - score.max())
    normalised: FloatArray = weight / weight.sum()
    return normalised


def _mean_and_spread(values: npt.NDArray[Any], weight: npt.NDArray[Any]) -> tuple[float, float]:
    mean = float(weight @ values)
    return mean, float(np.sqrt(weight @ (values - mean) ** 2))


def _contrasts() -> tuple[FloatArray, FloatArray]:
    """Return the contrasts that are compared, in light and in colour."""
    light, colour = (
        np.arange(least, most + 0.01, step)
        for least, most, step in zip(Contrast.LEAST, Contrast.MOST, CONTRAST_STEPS, strict=True)
    )
    return light, colour


@lru_cache(maxsize=1)
def _all_log_likelihoods() -> FloatGrid:
    """Return (contrasts in light, in colour, BINS), at the level itself."""
    lights, colours = _contrasts()
    middle = tuple(slice(reach, -reach) for reach in REACH)
    return np.array([[_log_likelihood(x, y)[middle] for y in colours] for x in lights])


@lru_cache(maxsize=256)
def _log_likelihood(light: float, colour: float) -> FloatGrid:
    """Return (BINS + 2 REACH): the log of how often a cell has this light and colour."""
    axes = [
        low + step * (np.arange(-reach, bins + reach) + 0.5)
        for low, step, bins, reach in zip(LOWEST, STEPS, BINS, REACH, strict=True)
    ]
    by_light, by_colour = curve(Contrast(light, colour))
    weight = np.ones(len(TRANSMITTANCES))
    weight[[0, -1]] = ENDS_WEIGHT

    def seen(values: npt.NDArray[Any], means: FloatArray, noise: float) -> FloatArray:
        density: FloatArray = np.exp(-0.5 * (np.subtract.outer(values, means) / noise) ** 2)
        return density

    # Steps of transmittance are closer near sun: shade gets as much, or flat frames favour sun.
    ends = [0, -1]
    near_light = seen(by_light[ends], by_light, LIGHT_NOISE)
    near_colour = seen(by_colour[ends], by_colour, COLOUR_NOISE)
    shade, sun = (near_light * near_colour) @ weight
    weight[0] += sun - shade
    in_light = seen(axes[0], by_light, LIGHT_NOISE)
    in_colour = seen(axes[1], by_colour, COLOUR_NOISE)
    density = (in_light * (weight / weight.sum())) @ in_colour.T
    found: FloatGrid = np.log(density + OUTLIERS).astype(np.float32)
    return found
