"""Figures of predicted times to shade against the true sky, as sums that add up over forecasts.

Counted are cells that are in sun on the map, as far ahead as their clouds are seen coming. A false
alarm is shade that was predicted and does not come until `GRACE_S` after the horizon.
"""

from dataclasses import dataclass

import numpy as np

from recon.forecast import NextChange
from recon.model.arrays import FloatArray

BIN_S, BINS = 5.0, 30
GRACE_S = 15.0


@dataclass(frozen=True, slots=True)
class ChangeScore:
    """Sums over cells; they add up over forecasts."""

    predicted: int = 0
    false_alarms: int = 0
    came: int = 0
    """Cells that shade came over in time to be predicted."""
    missed: int = 0
    """Cells of these for which shade was not predicted."""
    errors: tuple[int, ...] = (0,) * BINS
    """Counts of the error of the time, where shade was predicted and came, in bins of `BIN_S`."""

    def __add__(self, other: "ChangeScore") -> "ChangeScore":
        return ChangeScore(
            self.predicted + other.predicted,
            self.false_alarms + other.false_alarms,
            self.came + other.came,
            self.missed + other.missed,
            tuple(map(sum, zip(self.errors, other.errors, strict=True))),
        )

    @property
    def median_error_s(self) -> float | None:
        """The median error of the time to shade, to a bin's width; None without any."""
        total = sum(self.errors)
        if total == 0:
            return None
        return float(np.searchsorted(np.cumsum(self.errors), 0.5 * total) + 0.5) * BIN_S


def score_change(found: NextChange, true_s: FloatArray) -> ChangeScore:
    """Return the score of N cells; `true_s` (N,) is when shade truly comes, infinite if never."""
    counted = found.is_sunlit & (found.horizon_s > 0.0)
    predicted = counted & found.is_predicted
    false = predicted & (true_s > found.horizon_s + GRACE_S)
    came = counted & (true_s <= found.horizon_s)
    errors_s = np.abs(found.after_s - true_s)[predicted & ~false]
    bins = np.minimum(errors_s / BIN_S, BINS - 1).astype(np.intp)
    return ChangeScore(
        predicted=int(predicted.sum()),
        false_alarms=int(false.sum()),
        came=int(came.sum()),
        missed=int((came & ~predicted).sum()),
        errors=tuple(map(int, np.bincount(bins, minlength=BINS))),
    )
