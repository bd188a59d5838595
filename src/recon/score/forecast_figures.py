"""Figures of sun forecasts against the true sky, as sums that add up over forecasts."""

from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from recon.geo import nearest_cells
from recon.model.arrays import FloatArray
from recon.model.geo import GroundGrid
from recon.model.shade import SURE, MaskMap, SunForecast
from recon.score.shade_figures import Overlap, overlap

BINS = 10
"""Bins of the probability, of equal width."""


class SeenCells(Enum):
    """Which cells count: those whose clouds at the lead are over seen ground now; others; all."""

    SEEN = "seen"
    UNSEEN = "not seen"
    ALL = "all"


@dataclass(frozen=True, slots=True)
class Calibration:
    """Sums over cells by predicted probability, for its reliability."""

    predicted: tuple[float, ...] = (0.0,) * BINS
    """Sum of probabilities."""
    sunlit: tuple[int, ...] = (0,) * BINS
    """Cells truly in sun."""
    cells: tuple[int, ...] = (0,) * BINS

    def __add__(self, other: "Calibration") -> "Calibration":
        return Calibration(
            tuple(map(sum, zip(self.predicted, other.predicted, strict=True))),
            tuple(map(sum, zip(self.sunlit, other.sunlit, strict=True))),
            tuple(map(sum, zip(self.cells, other.cells, strict=True))),
        )

    @property
    def error_sum(self) -> float:
        """Cells times the difference of mean probability and true share in sun, over the bins."""
        return sum(abs(p - s) for p, s in zip(self.predicted, self.sunlit, strict=True))


@dataclass(frozen=True, slots=True)
class LeadScore:
    """Sums over the cells of one lead; they add up over forecasts."""

    squares: float = 0.0
    cells: int = 0
    shade: Overlap = field(default_factory=Overlap)
    calibration: Calibration = field(default_factory=Calibration)

    def __add__(self, other: "LeadScore") -> "LeadScore":
        return LeadScore(
            self.squares + other.squares,
            self.cells + other.cells,
            self.shade + other.shade,
            self.calibration + other.calibration,
        )

    @property
    def brier(self) -> float | None:
        """Mean squared error of the probability (Brier 1950): 0 is best, 0.25 is always predicting
        one half; None without cells."""
        return self.squares / self.cells if self.cells else None


def sun_probability(forecast: SunForecast, lead_s: float, grid: GroundGrid) -> FloatArray:
    """Return a forecast's probability of sun at one of its leads on another grid (R, C).

    Cells off the forecast's own grid have its prior. Raises `ValueError` for a lead that the
    forecast does not have.
    """
    index = np.flatnonzero(forecast.lead_s == lead_s)
    if index.size != 1:
        raise ValueError(f"expected a lead of {forecast.lead_s.tolist()} s, got {lead_s}")
    rows, cols, is_on = nearest_cells(forecast.grid, grid)
    levels = forecast.sun_probability[int(index[0])][rows, cols]
    return np.where(is_on, levels / SURE, forecast.prior_sunlit)


def score_cells(
    probability: FloatArray, is_sunlit: MaskMap, is_seen: MaskMap, is_counted: MaskMap
) -> dict[SeenCells, LeadScore]:
    """Return the scores of probabilities of sun against the truth; all arrays are (R, C).

    A cell counts as predicted in shade below a probability of one half.
    """
    seen = _score(probability, is_sunlit, is_counted & is_seen)
    unseen = _score(probability, is_sunlit, is_counted & ~is_seen)
    return {SeenCells.SEEN: seen, SeenCells.UNSEEN: unseen, SeenCells.ALL: seen + unseen}


def _score(probability: FloatArray, is_sunlit: MaskMap, cells: MaskMap) -> LeadScore:
    chances, truth = probability[cells], is_sunlit[cells]
    squares = float(((chances - truth) ** 2).sum())
    shade = overlap(probability < 0.5, ~is_sunlit, cells)
    return LeadScore(squares, int(cells.sum()), shade, _calibration(chances, truth))


def _calibration(chances: FloatArray, truth: MaskMap) -> Calibration:
    number = np.minimum((chances * BINS).astype(np.intp), BINS - 1)

    predicted = np.bincount(number, chances, minlength=BINS)
    sunlit = np.bincount(number, truth.astype(np.float64), minlength=BINS)
    cells = np.bincount(number, minlength=BINS)
    return Calibration(tuple(predicted.tolist()), tuple(map(int, sunlit)), tuple(map(int, cells)))
