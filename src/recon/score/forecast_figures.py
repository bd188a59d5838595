"""Figures of sun forecasts against the true sky, as sums that add up over forecasts."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

import numpy as np
import numpy.typing as npt

from recon.model.geo import GroundGrid
from recon.model.shade import SURE, FloatMap, MaskMap, SunForecast
from recon.score.score_grid import nearest_cells
from recon.score.shade_figures import Overlap, overlap

FloatArray = npt.NDArray[np.float64]


class HorizonCells(Enum):
    """Which cells count: those whose horizon reaches the lead, the others, or all."""

    WITHIN = "within horizon"
    BEYOND = "beyond horizon"
    ALL = "all"


@dataclass(frozen=True, slots=True)
class LeadScore:
    """Sums over the cells of one lead; they add up over forecasts."""

    squares: float = 0.0
    cells: int = 0
    shade: Overlap = field(default_factory=Overlap)

    def __add__(self, other: "LeadScore") -> "LeadScore":
        return LeadScore(
            self.squares + other.squares, self.cells + other.cells, self.shade + other.shade
        )

    @property
    def brier(self) -> float | None:
        """Mean squared error of the probability (Brier 1950): 0 is best, 0.25 is always predicting
        one half; None without cells."""
        return self.squares / self.cells if self.cells else None


def score_lead(
    forecast: SunForecast, lead_s: float, grid: GroundGrid, is_sunlit: MaskMap, is_counted: MaskMap
) -> Mapping[HorizonCells, LeadScore]:
    """Return the score of one of a forecast's leads against the truth on `grid` at that moment.

    A cell counts as predicted in shade below a probability of sun of one half. Cells off the
    forecast's own grid have its prior and no horizon. Raises `ValueError` for a lead that the
    forecast does not have.
    """
    index = np.flatnonzero(forecast.lead_s == lead_s)
    if index.size != 1:
        raise ValueError(f"expected a lead of {forecast.lead_s.tolist()} s, got {lead_s}")
    rows, cols, is_on = nearest_cells(forecast.grid, grid)
    levels = forecast.sun_probability[int(index[0])][rows, cols]
    probability = np.where(is_on, levels / SURE, forecast.prior_sunlit)
    horizon_s: FloatMap = np.where(is_on, forecast.horizon_s[rows, cols], np.float32(0.0))
    is_within = horizon_s > 0.0 if lead_s == 0.0 else horizon_s >= lead_s
    chosen = {HorizonCells.WITHIN: is_within, HorizonCells.BEYOND: ~is_within}
    found = {
        ahead: _score(probability, is_sunlit, cells & is_counted) for ahead, cells in chosen.items()
    }
    return {**found, HorizonCells.ALL: found[HorizonCells.WITHIN] + found[HorizonCells.BEYOND]}


def _score(probability: FloatArray, is_sunlit: MaskMap, cells: MaskMap) -> LeadScore:
    squares = float(((probability - is_sunlit)[cells] ** 2).sum())
    shade = overlap(probability < 0.5, ~is_sunlit, cells)
    return LeadScore(squares, int(cells.sum()), shade)
