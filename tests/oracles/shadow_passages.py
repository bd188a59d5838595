"""What passes over a point: shadows, sunlit gaps, edges and persistence, from clear-sky indices.

One index a second, (T, P) for P points that are days of their own. A sample is in shade when its
index is below `SHADE_INDEX`. Runs that a series' start or end cuts are not counted.
"""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IndexSeries = npt.NDArray[np.float32]

SHADE_INDEX = 0.65
BROKEN_SHARE = (0.1, 0.75)
"""Share of shade of a day that counts as broken cloud; days outside were not measured either."""
SHORTEST_S = 30
"""Shorter shadows and gaps are no matter to a survey, and were not counted outside either."""
LEADS_MIN = (1, 3, 5, 10, 20)
LOW, HIGH = 0.2, 0.8


@dataclass(slots=True)
class Passages:
    """What was found, over all series so far."""

    shadows_s: list[int] = field(default_factory=list)
    gaps_s: list[int] = field(default_factory=list)
    edges_s: list[float] = field(default_factory=list)
    both: FloatArray = field(default_factory=lambda: np.zeros(len(LEADS_MIN)))
    either: FloatArray = field(default_factory=lambda: np.zeros(len(LEADS_MIN)))
    shaded_s: int = 0
    watched_s: int = 0

    def add(self, index: IndexSeries) -> None:
        """Count those of one more (T, P) series that have broken cloud."""
        share = (index < SHADE_INDEX).mean(axis=0)
        index = index[:, (share >= BROKEN_SHARE[0]) & (share <= BROKEN_SHARE[1])]
        shade = index < SHADE_INDEX
        self.shaded_s += int(shade.sum())
        self.watched_s += shade.size
        for k, lead_min in enumerate(LEADS_MIN):
            now, later = shade[: -60 * lead_min], shade[60 * lead_min :]
            self.both[k] += float((now & later).sum())
            self.either[k] += float((now | later).sum())
        for point in range(index.shape[1]):
            self._add_runs(index[:, point], shade[:, point])

    def _add_runs(self, index: IndexSeries, shade: npt.NDArray[np.bool_]) -> None:
        turns = np.flatnonzero(shade[1:] != shade[:-1]) + 1
        for start, end in pairwise(turns):
            if end - start >= SHORTEST_S:
                (self.shadows_s if shade[start] else self.gaps_s).append(int(end - start))
        bounds = [0, *turns.tolist(), index.size]
        for before, turn, after in zip(bounds[:-2], bounds[1:-1], bounds[2:], strict=True):
            # Only an edge between two runs that count is an edge of a shadow that counts.
            if turn - before >= SHORTEST_S and after - turn >= SHORTEST_S:
                self.edges_s.append(edge_s(index[before:after], turn - before))

    @property
    def persistence(self) -> FloatArray:
        """Intersection over union of shade now and shade later, all series pooled, per lead."""
        return self.both / self.either


def edge_s(index: IndexSeries, turn: int) -> float:
    """Return how long an edge takes from 20 to 80 % of the way between its two levels.

    `index` holds the runs on both sides of the turn; a level is a run's median; the time is that
    between the crossings nearest to the turn, to a part of a second.
    """
    first, second = float(np.median(index[:turn])), float(np.median(index[turn:]))
    share = (index.astype(np.float64) - first) / (second - first)
    start = (
        _crossing(share[turn::-1], LOW) if share[turn] > LOW else -_crossing(-share[turn:], -LOW)
    )
    end = (
        _crossing(-share[turn:], -HIGH) if share[turn] < HIGH else -_crossing(share[turn::-1], HIGH)
    )
    return start + end


def _crossing(share: FloatArray, level: float) -> float:
    """Return after how many seconds a series first falls to a level; its length if never."""
    reached = np.flatnonzero(share <= level)
    if reached.size == 0:
        return float(share.size)
    k = int(reached[0])
    return k if k == 0 else k - 1 + (share[k - 1] - level) / (share[k - 1] - share[k])


def percentiles(values: list[int] | list[float]) -> FloatArray:
    """Return the 10th, 50th and 90th."""
    return np.percentile(np.array(values, dtype=np.float64), [10.0, 50.0, 90.0])
