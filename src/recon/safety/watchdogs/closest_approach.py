"""How near pairs of vehicles come in the next seconds, in shares of what must be kept.

A pair's closeness at a moment is the larger of its horizontal gap over the horizontal separation
and its vertical gap over the vertical one. Below 1 both are violated.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import inf
from typing import NamedTuple

import numpy as np

from recon.model.arrays import BoolArray, FloatArray, IntArray
from recon.safety.prediction import HazardArea
from recon.safety.prediction.trajectory import Samples
from recon.safety.separation_minima import SeparationMinima

DEPTH_WEIGHT = 0.1
"""Weight of depth besides the gaps: enough to tell which of two ways leads deeper in."""


@dataclass(frozen=True, slots=True)
class Approach:
    """How a pair comes near: when it first is too near (None: never), and its least closeness.

    `height_gap_m` is the least gap between the two bands of heights while it is too near, negative
    by how far they overlap; infinite if it never is.
    """

    in_s: float | None
    least: float
    horizontal_m: float
    vertical_m: float
    height_gap_m: float = inf


class Gaps(NamedTuple):
    """Closeness of P pairs at K moments, and the gaps that it is made of, each (P, K)."""

    closeness: FloatArray
    horizontal_m: FloatArray
    vertical_m: FloatArray


def near_pairs(
    ahead: Samples, need: SeparationMinima, unknown: BoolArray | None = None
) -> tuple[IntArray, IntArray]:
    """Return the pairs whose reach lets them come too near at all, as two arrays of indices.

    `unknown` is (V, V): the vehicles whose heights say nothing about each other.
    """
    reach_m = np.hypot(
        ahead.east_m - ahead.east_m[:, :1], ahead.north_m - ahead.north_m[:, :1]
    ).max(axis=1) + ahead.radius_m.max(axis=1)
    first, second = _all_pairs(len(reach_m))
    apart_m = np.hypot(
        ahead.east_m[first, 0] - ahead.east_m[second, 0],
        ahead.north_m[first, 0] - ahead.north_m[second, 0],
    )
    low_m, high_m = ahead.low_m.min(axis=1), ahead.high_m.max(axis=1)
    is_near = apart_m < need.horizontal_m + reach_m[first] + reach_m[second]
    is_level = low_m[first] - high_m[second] < need.vertical_m
    is_level &= low_m[second] - high_m[first] < need.vertical_m
    is_near &= is_level if unknown is None else is_level | unknown[first, second]
    return first[is_near], second[is_near]


@lru_cache(maxsize=8)
def _all_pairs(count: int) -> tuple[IntArray, IntArray]:
    """Return all pairs of `count`, the same at each look; as large as all of one look's arrays."""
    return np.triu_indices(count, k=1)


def closeness(
    a: Samples,
    first: IntArray,
    b: Samples,
    second: IntArray,
    need: SeparationMinima,
    unknown: BoolArray | None = None,
) -> Gaps:
    """Return how near P pairs are at K moments.

    Between heights that say nothing about each other, `unknown` (V, V), the gap is 0 at most.
    """
    horizontal_m = np.hypot(
        a.east_m[first] - b.east_m[second], a.north_m[first] - b.north_m[second]
    )
    horizontal_m -= a.radius_m[first] + b.radius_m[second]
    vertical_m = np.maximum(a.low_m[first] - b.high_m[second], b.low_m[second] - a.high_m[first])
    if unknown is not None:
        pairs = unknown[first, second][:, np.newaxis]
        vertical_m = np.where(pairs, np.minimum(vertical_m, 0.0), vertical_m)
    return Gaps(_shares(horizontal_m, vertical_m, need), horizontal_m, vertical_m)


def hazard_closeness(
    ahead: Samples,
    times_s: FloatArray,
    hazard: HazardArea,
    need: SeparationMinima,
    unknown: BoolArray | None = None,
) -> Gaps:
    """Return how near V vehicles are to where a hazard area may be, each (V, K).

    No height separates the vehicles in `unknown` (V,) from it.
    """
    radius_m = np.minimum(hazard.largest_m, hazard.radius_m + hazard.growth_mps * times_s)
    circle_m = np.hypot(ahead.east_m - hazard.east_m, ahead.north_m - hazard.north_m) - radius_m
    over_m = ahead.low_m - hazard.high_m
    under_m = hazard.corridor_low_m - ahead.high_m
    if unknown is not None:
        rows = unknown[:, np.newaxis]
        over_m = np.where(rows, np.minimum(over_m, 0.0), over_m)
        under_m = np.where(rows, np.minimum(under_m, 0.0), under_m)
    # In the circle's heights, which reach to the ground, no height is nearer than another.
    vertical_m = np.maximum(np.maximum(over_m, hazard.low_m - ahead.high_m), 0.0)
    least, horizontal_m = _shares(circle_m, vertical_m, need), circle_m
    if hazard.home_m is not None:
        landing_m = np.hypot(ahead.east_m - hazard.home_m[0], ahead.north_m - hazard.home_m[1])
        landing_m -= hazard.corridor_half_m
        path_m = _to_path_m(ahead, hazard, hazard.home_m) - hazard.corridor_half_m
        beside_m = np.maximum(over_m, under_m)
        least = np.minimum(least, _shares(landing_m, vertical_m, need))
        least = np.minimum(least, _shares(path_m, beside_m, need))
        horizontal_m = np.minimum(horizontal_m, np.minimum(landing_m, path_m))
    return Gaps(least, horizontal_m, vertical_m)


def approach(gaps: Gaps, row: int | np.integer, times_s: FloatArray) -> Approach:
    """Return how one of the pairs comes near."""
    close, horizontal_m, vertical_m = (each[row] for each in gaps)
    nearest = int(np.argmin(close))
    is_too_near = close < 1.0
    first_s = float(times_s[int(np.argmax(is_too_near))]) if is_too_near.any() else None
    return Approach(
        first_s,
        float(close[nearest]),
        max(0.0, float(horizontal_m[nearest])),
        max(0.0, float(vertical_m[nearest])),
        float(vertical_m[is_too_near].min(initial=inf)),
    )


def _shares(horizontal_m: FloatArray, vertical_m: FloatArray, need: SeparationMinima) -> FloatArray:
    """Closeness; of what is too near, deeper in a circle is nearer at whatever height."""
    level, upright = horizontal_m / need.horizontal_m, vertical_m / need.vertical_m
    shares: FloatArray = np.maximum(level, upright)
    return np.where(shares < 1.0, shares + DEPTH_WEIGHT * np.minimum(level, 0.0), shares)


def _to_path_m(ahead: Samples, hazard: HazardArea, home_m: tuple[float, float]) -> FloatArray:
    """How far each is from the straight line home."""
    along = np.array(home_m) - (hazard.east_m, hazard.north_m)
    squared = max(float(along @ along), 1e-9)
    east_m, north_m = ahead.east_m - hazard.east_m, ahead.north_m - hazard.north_m
    share = np.clip((east_m * along[0] + north_m * along[1]) / squared, 0.0, 1.0)
    far: FloatArray = np.hypot(east_m - share * along[0], north_m - share * along[1])
    return far
