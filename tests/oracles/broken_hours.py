"""What passes over a point in hours of broken cloud, under the sky of a scenario and as measured.

Measured: irradiance at 1 Hz on 15 days of broken cloud; of these the hours with a share of shade of
0.2 to 0.6. The simulated hours are chosen in the same way, so that like is compared with like:
clear and overcast hours would make any sky look long-lived.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from tests.oracles.shadow_passages import SHADE_INDEX, SHORTEST_S, IndexSeries, edge_s

HOUR_S, WINDOW_S = 3_600, 60
BROKEN_SHARE = (0.2, 0.6)
MIXED_SHARE = (0.1, 0.9)
"""Of shade in a window that counts as mixed."""
LEADS_MIN = (1, 3, 5, 10)
LAGS_S = (60, 120, 300)

MEASURED = {
    "edges an hour": 6.5,
    "shadow, s, 50 %": 85.0,
    "shadow, s, 90 %": 330.0,
    "persistence IoU, 1 min": 0.65,
    "persistence IoU, 3 min": 0.48,
    "persistence IoU, 5 min": 0.42,
    "persistence IoU, 10 min": 0.31,
    "autocorrelation, 60 s": 0.62,
    "autocorrelation, 120 s": 0.47,
    "autocorrelation, 300 s": 0.27,
    "mixed windows of 60 s": 0.20,
    "20-80 % edge, s": 15.0,
}


@dataclass(slots=True)
class BrokenHours:
    """Sums over hours of broken cloud."""

    watched: int = 0
    hours: int = 0
    shadows_s: list[int] = field(default_factory=list)
    edges_s: list[float] = field(default_factory=list)
    both: npt.NDArray[np.float64] = field(default_factory=lambda: np.zeros(len(LEADS_MIN)))
    either: npt.NDArray[np.float64] = field(default_factory=lambda: np.zeros(len(LEADS_MIN)))
    correlations: list[list[float]] = field(default_factory=list)
    """By hour, at each lag."""
    mixed: int = 0

    def add(self, index: IndexSeries) -> None:
        """Count the hours of a series (T, P) of clear-sky indices, one a second."""
        whole = index[: len(index) // HOUR_S * HOUR_S]
        for hour in whole.T.reshape(-1, HOUR_S):
            self.watched += 1
            shade = hour < SHADE_INDEX
            if BROKEN_SHARE[0] <= shade.mean() <= BROKEN_SHARE[1]:
                self._add_hour(hour, shade)

    def _add_hour(self, index: IndexSeries, shade: npt.NDArray[np.bool_]) -> None:
        self.hours += 1
        turns = (np.flatnonzero(shade[1:] != shade[:-1]) + 1).tolist()
        runs = [end - start for start, end in pairwise(turns) if shade[start]]
        self.shadows_s += [run for run in runs if run >= SHORTEST_S]
        bounds = [0, *turns, HOUR_S]
        for before, turn, after in zip(bounds[:-2], turns, bounds[2:], strict=True):
            if turn - before >= SHORTEST_S and after - turn >= SHORTEST_S:
                self.edges_s.append(edge_s(index[before:after], turn - before))
        for k, lead_min in enumerate(LEADS_MIN):
            now, later = shade[: -60 * lead_min], shade[60 * lead_min :]
            self.both[k] += float((now & later).sum())
            self.either[k] += float((now | later).sum())
        self.correlations.append([float(np.corrcoef(shade[:-s], shade[s:])[0, 1]) for s in LAGS_S])
        share = shade.reshape(-1, WINDOW_S).mean(axis=1)
        self.mixed += int(((share > MIXED_SHARE[0]) & (share < MIXED_SHARE[1])).sum())

    @property
    def figures(self) -> dict[str, float]:
        """The figures under the names of `MEASURED`."""
        found = [
            len(self.edges_s) / self.hours,
            *np.percentile(self.shadows_s, [50.0, 90.0]).tolist(),
            *(self.both / self.either).tolist(),
            *np.nanmean(np.array(self.correlations), axis=0).tolist(),
            self.mixed / (self.hours * HOUR_S / WINDOW_S),
            float(np.median(self.edges_s)),
        ]
        return dict(zip(MEASURED, found, strict=True))


def farthest_off(found: dict[str, float]) -> tuple[float, str]:
    """Return by which share a figure is off at most, and its name."""
    return max((abs(found[name] / truth - 1.0), name) for name, truth in MEASURED.items())


def hours_table(names: Iterable[str], found: list[dict[str, float]]) -> str:
    """Return measured and simulated figures side by side, as a Markdown table."""
    heads = ["figure", "measured", *names]
    lines = [f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    for name, measured in MEASURED.items():
        cells = [f"{_number(each[name])} ({each[name] / measured:.2f})" for each in found]
        lines.append(f"| {name} | {_number(measured)} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _number(value: float) -> str:
    return f"{value:.2f}" if value < 1.0 else f"{value:.1f}" if value < 30.0 else f"{value:.0f}"
