"""How likely each level of sun is, from frame to frame: a hidden Markov model on a grid.

The state is the level of full sun in a frame, in light (exposure) and colour (white balance). From
one frame to the next it changes as the drift measures, with its error; a frame's cells then show
how well each level explains them. A flat view is explained equally well by several levels: they all
stay, until an edge, or the hot spot, decides. Each level has the score of the best course of all
levels through it, in both directions of time (max-product; L. Rabiner, A tutorial on hidden Markov
models, Proc. IEEE 77, 1989). Sums over courses would favour what may change freely: thin cloud.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from recon.detection.sunlit.contrast import Contrast
from recon.detection.sunlit.levels import Level, Values
from recon.detection.sunlit.likelihood import (
    REACH,
    STEPS,
    WORTH,
    FloatGrid,
    counted,
    fits,
    spectra_of,
)

Spread = tuple[float, float]
"""Standard deviations in light and in colour."""

LIGHTS, COLOURS = (
    (step * np.arange(-reach, reach + 1)).astype(np.float32)
    for step, reach in zip(STEPS, REACH, strict=True)
)
"""Levels relative to the middle of the grid."""
LEAP = -14.0
"""Log score of any change of the camera in one step: a pilot touches the exposure."""
ALIKE = 0.3, 0.5
"""Shares of the contrast within which two levels are the same one."""
WORTH_S = 10.0
"""Frames that follow each other sooner show nearly the same: they count less."""
TOLERATED, LITTLE_COUNTS = 0.2, 0.04
"""Difference of mean log likelihoods that shows nearly nothing, and the share of it that counts."""
IMPOSSIBLE = -1e6
PASSES, LEAST_VARIANCE = 6, 1e-4
"""Steps of a bin or none that make up a random step; the least variance of one, in bins squared."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """The most likely level of sun."""

    level: Level
    doubt: float
    """How likely any other level is, against this one."""


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """The log score (2 REACH + 1) of each level around one in the middle; the best has 0."""

    middle: Level
    score: FloatGrid

    def later(self, change: Level, spread: Spread) -> "Belief":
        """Return the belief after a change of light and colour known with these errors."""
        return Belief(self.middle + change, diffused(self.score, spread))

    def seen(self, light: Values, colour: Values, contrast: Contrast, after_s: float) -> "Belief":
        """Return the belief after a frame's cells (N,), with the land taken out."""
        shown = counted(
            light - np.float32(self.middle.light), colour - np.float32(self.middle.colour)
        )
        evidence = worth(after_s) * lacking(fits(spectra_of([shown]), contrast))[0]
        return replace(self, score=from_best(self.score + evidence))

    def estimate(self, contrast: Contrast) -> Estimate:
        """Return the most likely level."""
        row, col = np.unravel_index(int(np.argmax(self.score)), self.score.shape)
        near = np.logical_and.outer(
            np.abs(LIGHTS - LIGHTS[row]) < ALIKE[0] * contrast.light,
            np.abs(COLOURS - COLOURS[col]) < ALIKE[1] * contrast.colour,
        )
        weight = np.exp(from_best(self.score))
        local = np.where(near, weight, 0.0)
        light = float(local.sum(axis=1) @ LIGHTS / local.sum())
        colour = float(local.sum(axis=0) @ COLOURS / local.sum())
        return Estimate(self.middle + Level(light, colour), float(weight[~near].max()))


def worth(after_s: float) -> float:
    """Return how many independent cells a frame is worth, by the time since the one before."""
    return WORTH * min(1.0, after_s / WORTH_S)


def lacking(fit: FloatGrid) -> FloatGrid:
    """Return how much worse each level explains a frame than the best does: zero or less.

    A little worse is nearly as good: the model's own errors are the same in all frames, and must
    not add up to certainty.
    """
    worse = fit.max(axis=(1, 2), keepdims=True) - fit
    little = np.minimum(worse, np.float32(TOLERATED))
    found: FloatGrid = np.float32(LITTLE_COUNTS) * little + (worse - little)
    return -found


def near(middle: Level, level: Level, spread: Spread, floor: float) -> FloatGrid:
    """Return the log score of what is known to be near a level, on the grid around `middle`."""
    off = np.add.outer(
        ((LIGHTS + middle.light - level.light) / max(spread[0], STEPS[0])) ** 2,
        ((COLOURS + middle.colour - level.colour) / max(spread[1], STEPS[1])) ** 2,
    )
    found: FloatGrid = np.log(np.exp(-0.5 * off) + floor).astype(np.float32)
    return found


def smoothed(evidence: FloatGrid, spreads: Sequence[Spread], first: FloatGrid) -> FloatGrid:
    """Return the belief in every frame's level (K, grid), from all frames together.

    `evidence` is each level's log score in each frame; `spreads` are the errors of the K - 1
    changes between them, `first` what is believed before the first.
    """
    forward, backward = _forward(evidence, spreads, first), np.zeros_like(evidence)
    for i in range(len(evidence) - 2, -1, -1):
        backward[i] = diffused(backward[i + 1] + evidence[i + 1], spreads[i])
    return np.stack([from_best(each) for each in forward + backward])


def best_course(evidence: FloatGrid, spreads: Sequence[Spread], first: FloatGrid) -> float:
    """Return the score of the best course of all levels; as for `smoothed`."""
    return float(_forward(evidence, spreads, first)[-1].max())


def _forward(evidence: FloatGrid, spreads: Sequence[Spread], first: FloatGrid) -> FloatGrid:
    forward = np.empty_like(evidence)
    forward[0] = first + evidence[0]
    for i in range(1, len(evidence)):
        forward[i] = diffused(forward[i - 1], spreads[i - 1]) + evidence[i]
    return forward


def from_best(score: FloatGrid) -> FloatGrid:
    """Return scores relative to the best."""
    found: FloatGrid = score - score.max()
    return found


def diffused(score: FloatGrid, spread: Spread) -> FloatGrid:
    """Return the best scores after a random step of this spread, or a leap."""
    best = score.max()
    for axis, (each, step) in enumerate(zip(spread, STEPS, strict=True)):
        score = _stepped(score, axis, each / step)
    leapt: FloatGrid = np.maximum(score, best + np.float32(LEAP))
    return leapt


def _stepped(score: FloatGrid, axis: int, bins: float) -> FloatGrid:
    """Return the best scores after steps of one bin or none, with the variance of a random step."""
    passes = min(ceil(bins * bins), PASSES)
    if bins * bins > PASSES:
        return _wide(score, axis, bins)
    cost = np.float32(np.log(0.5 * max(bins * bins / max(passes, 1), LEAST_VARIANCE)))
    rest = (slice(None),) * axis
    up, down = (*rest, slice(1, None)), (*rest, slice(None, -1))
    for _ in range(passes):
        found = score.copy()
        np.maximum(found[up], score[down] + cost, out=found[up])
        np.maximum(found[down], score[up] + cost, out=found[down])
        score = found
    return score


def _wide(score: FloatGrid, axis: int, bins: float) -> FloatGrid:
    """Return the best scores after a normal step of many bins."""
    from scipy.ndimage import grey_dilation

    reach = min(ceil(4.0 * bins), max(REACH))
    taps = (-0.5 * (np.arange(-reach, reach + 1) / bins) ** 2).astype(np.float32)
    shaped = np.expand_dims(taps, 1 - axis)
    found: FloatGrid = grey_dilation(
        score, structure=shaped.tolist(), mode="constant", cval=IMPOSSIBLE
    )
    return found
