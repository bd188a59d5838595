"""Figures of several runs as one, with confidence intervals: means, shares of sums, times cut off.

The order of the runs changes no bit.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, sqrt

import numpy as np
from scipy.special import stdtrit

CONFIDENCE = 0.95
RESAMPLES = 2_000
RESAMPLING_SEED = 1


@dataclass(frozen=True, slots=True)
class Interval:
    """A figure of all runs, and where it lies with 95 % confidence; no run is like the next.

    With one run alone the interval is without bounds.
    """

    mean: float
    low: float
    high: float
    count: int
    """Runs that have the figure."""


@dataclass(frozen=True, slots=True)
class Times:
    """Times until something, of which some runs do not live to see.

    `mean` is the mean of the times, the limit put in for those cut off by it: too small by what
    they would have taken longer, which is why `reached` of `count` stands beside it.
    """

    mean: Interval
    median_s: float
    """Infinite where half of the runs or more were cut off."""
    reached: int
    count: int


def interval(values: Sequence[float | None]) -> Interval | None:
    """Return the mean of the runs that have a value, by Student's t; None when none has."""
    there = sorted(value for value in values if value is not None)
    count = len(there)
    if count == 0:
        return None
    mean = sum(there) / count
    if count == 1:
        return Interval(mean, -inf, inf, 1)
    deviation = sqrt(sum((value - mean) ** 2 for value in there) / (count - 1))
    half = float(stdtrit(count - 1, 0.5 + CONFIDENCE / 2.0)) * deviation / sqrt(count)
    return Interval(mean, mean - half, mean + half, count)


def ratio(parts: Sequence[tuple[float, float]]) -> Interval | None:
    """Return the sum of first parts over that of second parts, one pair a run; None over nothing.

    The interval is by resampling whole runs, always the same way. Runs whose second part is 0 have
    no say.
    """
    there = np.array(sorted(part for part in parts if part[1] > 0.0), dtype=np.float64)
    if there.size == 0:
        return None
    total = there.sum(axis=0)
    count = len(there)
    if count == 1:
        return Interval(float(total[0] / total[1]), -inf, inf, 1)
    rng = np.random.default_rng(RESAMPLING_SEED)
    drawn = there[rng.integers(0, count, (RESAMPLES, count))].sum(axis=1)
    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(drawn[:, 0] / drawn[:, 1], [tail, 1.0 - tail])
    return Interval(float(total[0] / total[1]), float(low), float(high), count)


def times(values: Sequence[float | None], limit_s: float) -> Times | None:
    """Return what is known of times cut off at a limit (None: cut off); None of no runs."""
    cut = interval([limit_s if value is None else min(value, limit_s) for value in values])
    if cut is None:
        return None
    known = sorted(inf if value is None or value > limit_s else value for value in values)
    middle = (len(known) - 1) // 2
    median_s = (known[middle] + known[-1 - middle]) / 2.0
    return Times(cut, median_s, sum(value < inf for value in known), len(known))
