"""Gaussian values that change in time, as a pure function of it: blended between seeded keyframes.

Independent keyframes are one period apart; in between, two are blended so that the variance stays
one. Only operations that round the same in every order are used, so a value does not depend on what
else is asked in the same call.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import inf

import numpy as np
import numpy.typing as npt

from recon.model.arrays import FloatArray

FloatImage = npt.NDArray[np.float32]

PERIODS_PER_LIFETIME = 1.0 / 0.90017
"""Periods until the correlation falls to 1/e with this blending (solved numerically)."""
NUMBERS = 2**32
NUMBERS_KEPT = 4096


@dataclass(frozen=True, slots=True, eq=False)
class Blend:
    """The keyframe before each time, and the weights of that one and the next."""

    number: npt.NDArray[np.int64]
    share: FloatArray
    next_share: FloatArray


def blend(time_s: FloatArray, lifetime_s: float | FloatArray, shift: float | FloatArray) -> Blend:
    """Return the keyframes of times; `shift` in 0..1 moves them; an infinite lifetime: frozen.

    All are broadcast together.
    """
    period_s = np.asarray(lifetime_s) * PERIODS_PER_LIFETIME
    position = np.where(period_s < inf, time_s / period_s + shift, 0.0)
    number = np.floor(position)
    along = position - number
    norm = np.sqrt((1.0 - along) * (1.0 - along) + along * along)
    return Blend(number.astype(np.int64), (1.0 - along) / norm, along / norm)


def gaussian(stream: tuple[int, ...], time_s: FloatArray, lifetime_s: float) -> FloatArray:
    """Return values of mean 0 and deviation 1 at times (any shape), changing over `lifetime_s`."""
    blended = blend(time_s, lifetime_s, phase(stream))
    numbers = blended.number.ravel() if time_s.size == 1 else np.unique(blended.number)
    drawn = np.array([[number(stream, int(n) + step) for n in numbers] for step in (0, 1)])
    place = np.searchsorted(numbers, blended.number)
    value: FloatArray = blended.share * drawn[0][place] + blended.next_share * drawn[1][place]
    return value


def generator(stream: tuple[int, ...], key: int) -> np.random.Generator:
    """Return the random numbers of one keyframe; its key may be negative."""
    return np.random.default_rng((*stream, key % NUMBERS))


@lru_cache(maxsize=NUMBERS_KEPT)
def number(stream: tuple[int, ...], key: int) -> float:
    """Return one keyframe's value, of mean 0 and deviation 1."""
    return float(generator(stream, key).standard_normal())


@lru_cache(maxsize=NUMBERS_KEPT)
def phase(stream: tuple[int, ...]) -> float:
    """Return a stream's shift of its keyframes, 0 to 1, so that streams do not change in step."""
    return float(generator(stream, -1).random())
