"""Courses read at moments: where every vehicle is at each of them, all at once."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from recon.safety.prediction.course import (
    CURVE,
    EAST_0,
    EAST_1,
    END_S,
    FOREVER_S,
    HIGH_0,
    HIGH_1,
    LOW_0,
    LOW_1,
    NORTH_0,
    NORTH_1,
    RADIUS_0,
    RADIUS_1,
    START_S,
    FloatArray,
    Row,
)

_APART_S = 4.0 * FOREVER_S
"""Vehicles' times are laid one behind the other on one axis, this far apart."""


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """V vehicles at K moments: each array is (V, K), metres in the plane and up."""

    east_m: FloatArray
    north_m: FloatArray
    low_m: FloatArray
    high_m: FloatArray
    radius_m: FloatArray


def sample(courses: Sequence[Sequence[Row] | FloatArray], times_s: npt.ArrayLike) -> Samples:
    """Return where each course's vehicle is at (K,) moments; before and after it, at its ends.

    No course may be without a row.
    """
    times = np.asarray(times_s, dtype=np.float64)
    rows = np.array([row for course in courses for row in course], dtype=np.float64)
    counts = np.array([len(course) for course in courses])
    vehicle = np.repeat(np.arange(len(courses)), counts)
    axis = rows[:, START_S] + vehicle * _APART_S
    asked = times[np.newaxis, :] + np.arange(len(courses))[:, np.newaxis] * _APART_S
    first = np.cumsum(counts) - counts
    index = np.searchsorted(axis, asked, side="right") - 1
    found = rows[np.maximum(index, first[:, np.newaxis])]
    return _at(found, times)


def _at(found: FloatArray, times: FloatArray) -> Samples:
    lasts_s = np.maximum(found[..., END_S] - found[..., START_S], 1e-9)
    gone_s = np.clip(times - found[..., START_S], 0.0, lasts_s)
    in_time = gone_s / lasts_s
    curve = found[..., CURVE]
    share = (1.0 / lasts_s - curve * lasts_s) * gone_s + curve * gone_s**2

    def between(start: int, end: int, at: FloatArray) -> FloatArray:
        value: FloatArray = found[..., start] + at * (found[..., end] - found[..., start])
        return value

    return Samples(
        east_m=between(EAST_0, EAST_1, share),
        north_m=between(NORTH_0, NORTH_1, share),
        low_m=between(LOW_0, LOW_1, share),
        high_m=between(HIGH_0, HIGH_1, share),
        radius_m=between(RADIUS_0, RADIUS_1, in_time),
    )
