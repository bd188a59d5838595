"""Figures of several runs with confidence intervals: means, ratios of sums, censored times.

The result does not depend on the order of the runs, to the last bit.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, inf, log, sqrt

import numpy as np
from scipy.special import betaincinv, stdtrit

CONFIDENCE = 0.95
RESAMPLES = 2_000
RESAMPLING_SEED = 1


@dataclass(frozen=True, slots=True)
class Interval:
    """A figure over all runs with its 95 % confidence interval; infinite bounds for one run."""

    mean: float
    low: float
    high: float
    count: int
    """Number of runs that have the figure."""


@dataclass(frozen=True, slots=True)
class Times:
    """Times to an event that some runs do not reach within the limit.

    `mean` takes the limit for those runs, so it is a lower bound; `reached` of `count` shows how
    many runs it concerns.
    """

    mean: Interval
    median_s: float
    """Infinite where half of the runs or more did not reach the event."""
    reached: int
    count: int


def interval(values: Sequence[float | None]) -> Interval | None:
    """Return the mean of the values, with Student's t interval; None without values."""
    present = sorted(value for value in values if value is not None)
    count = len(present)
    if count == 0:
        return None
    mean = sum(present) / count
    if count == 1:
        return Interval(mean, -inf, inf, 1)
    deviation = sqrt(sum((value - mean) ** 2 for value in present) / (count - 1))
    half = float(stdtrit(count - 1, 0.5 + CONFIDENCE / 2.0)) * deviation / sqrt(count)
    return Interval(mean, mean - half, mean + half, count)


def probability_at_most(happened: int, of: int) -> float:
    """Return the upper 95 % bound on the probability of what happened in some of `of` trials.

    One-sided and exact (Clopper and Pearson 1934): with none of n it is about 3 / n.
    """
    return 1.0 if happened >= of else float(betaincinv(happened + 1, of - happened, CONFIDENCE))


def ratio(parts: Sequence[tuple[float, float]]) -> Interval | None:
    """Return the sum of first parts over the sum of second parts, one pair per run.

    The interval is a percentile bootstrap over whole runs (Efron 1979) with a fixed seed. Runs
    whose second part is 0 are excluded; None without others.
    """
    present = np.array(sorted(part for part in parts if part[1] > 0.0), dtype=np.float64)
    if present.size == 0:
        return None
    total = present.sum(axis=0)
    count = len(present)
    if count == 1:
        return Interval(float(total[0] / total[1]), -inf, inf, 1)
    rng = np.random.default_rng(RESAMPLING_SEED)
    drawn = present[rng.integers(0, count, (RESAMPLES, count))].sum(axis=1)
    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(drawn[:, 0] / drawn[:, 1], [tail, 1.0 - tail])
    return Interval(float(total[0] / total[1]), float(low), float(high), count)


def log_ratio(
    pairs: Sequence[tuple[float | None, float | None]],
) -> Interval | None:
    """Return the geometric mean of first over second values, one pair per run.

    The interval is Student's t of the logarithms of the runs' ratios: what differs from run to run,
    but not between the two, drops out. Runs without two positive values are excluded; None without
    others.
    """
    logs = [log(a / b) for a, b in pairs if a is not None and b is not None and a > 0.0 < b]
    found = interval(logs)
    if found is None:
        return None
    return Interval(exp(found.mean), exp(found.low), exp(found.high), found.count)


def pooled_quantile(groups: Sequence[Sequence[float]], share: float) -> Interval | None:
    """Return a quantile of all values of all runs, one group per run; None without values.

    The interval is a percentile bootstrap over whole runs, as that of `ratio`.
    """
    present = sorted(sorted(group) for group in groups if group)
    if not present:
        return None
    count = len(present)
    mean = float(np.quantile(np.concatenate(present), share))
    if count == 1:
        return Interval(mean, -inf, inf, 1)
    rng = np.random.default_rng(RESAMPLING_SEED)
    drawn = [
        np.quantile(np.concatenate([present[i] for i in numbers]), share)
        for numbers in rng.integers(0, count, (RESAMPLES, count))
    ]
    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(drawn, [tail, 1.0 - tail])
    return Interval(mean, float(low), float(high), count)


def times(values: Sequence[float | None], limit_s: float) -> Times | None:
    """Return times to an event (None: not reached), cut at the limit; None without runs."""
    cut = interval([limit_s if value is None else min(value, limit_s) for value in values])
    if cut is None:
        return None
    known = sorted(inf if value is None or value > limit_s else value for value in values)
    middle = (len(known) - 1) // 2
    median_s = (known[middle] + known[-1 - middle]) / 2.0
    return Times(cut, median_s, sum(value < inf for value in known), len(known))
