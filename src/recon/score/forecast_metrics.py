"""How good forecasts are, by lead: Brier score and shade IoU, seen ahead and not."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

import numpy as np
import numpy.typing as npt

from recon.model.shade import SURE, MaskMap, SunForecast
from recon.score.shade_metrics import Overlap, overlap

FloatArray = npt.NDArray[np.float64]


class Ahead(Enum):
    """Which cells count: a cell is seen ahead up to its horizon."""

    SEEN = "seen"
    UNSEEN = "unseen"
    ALL = "all"


@dataclass(frozen=True, slots=True)
class LeadScore:
    """Sums over cells of one lead, which can be added up over forecasts."""

    squares: float = 0.0
    cells: int = 0
    shade: Overlap = field(default_factory=Overlap)

    def __add__(self, other: "LeadScore") -> "LeadScore":
        return LeadScore(
            self.squares + other.squares, self.cells + other.cells, self.shade + other.shade
        )

    @property
    def brier(self) -> float | None:
        """Mean square of probability less truth: 0 is best, 0.25 a coin's; None of no cells."""
        return self.squares / self.cells if self.cells else None


def score_lead(
    forecast: SunForecast, lead_s: float, is_sunlit: MaskMap, is_counted: MaskMap
) -> Mapping[Ahead, LeadScore]:
    """Return the score of one of a forecast's leads against the truth at that moment.

    Shade is foretold where sun is less likely than not. Raises `ValueError` for a lead that the
    forecast has not.
    """
    index = np.flatnonzero(forecast.lead_s == lead_s)
    if index.size != 1:
        raise ValueError(f"expected a lead of {forecast.lead_s.tolist()} s, got {lead_s}")
    probability = forecast.sun_probability[int(index[0])] / SURE
    is_seen = forecast.horizon_s >= lead_s
    if lead_s == 0.0:
        is_seen = forecast.horizon_s > 0.0
    chosen = {Ahead.SEEN: is_seen, Ahead.UNSEEN: ~is_seen}
    found = {
        ahead: _score(probability, is_sunlit, cells & is_counted) for ahead, cells in chosen.items()
    }
    return {**found, Ahead.ALL: found[Ahead.SEEN] + found[Ahead.UNSEEN]}


def _score(probability: FloatArray, is_sunlit: MaskMap, cells: MaskMap) -> LeadScore:
    squares = float(((probability - is_sunlit)[cells] ** 2).sum())
    shade = overlap(probability < 0.5, ~is_sunlit, cells)
    return LeadScore(squares, int(cells.sum()), shade)
