"""Forecast methods on a recorded sequence of maps: each is compared with the map of its time.

Truth is what came: cells count that the later map knows. `SEEN` are those within the method's own
horizon. Methods are made for maps a few seconds apart; a slower sequence (radar, satellites) is
read as if its maps were `USUAL_STEP_S` apart, so that leads and speeds count in its own steps.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.shade import ShadeMap, SunForecast
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.score.forecast_figures import LeadScore, score_cells, sun_probability
from recon.score.forecast_scoring import ForecastKey
from recon.score.settings import SCORE

USUAL_STEP_S = 5.0
NOWHERE = LocalFrame(GeoPoint(0.0, 0.0, 0.0))
CELL_M = 4.0


def time_scale(step_s: float) -> float:
    """Return how many seconds of a sequence one second of the methods stands for."""
    return max(1.0, step_s / USUAL_STEP_S)


def unplaced_grid(rows: int, cols: int) -> GroundGrid:
    """Return a grid for maps of which only the cells matter."""
    return GroundGrid(NOWHERE, 0.0, 0.0, CELL_M, rows, cols)


@dataclass(slots=True)
class Verification:
    """The sums of all methods over the maps so far."""

    methods: Sequence[str]
    step_s: float
    """Step between maps, in the methods' time."""
    settings: ForecastSettings = field(default_factory=ForecastSettings)
    sums: dict[ForecastKey, LeadScore] = field(default_factory=dict)
    _states: dict[str, ForecastState] = field(default_factory=dict)
    _issued: list[dict[str, SunForecast]] = field(default_factory=list)

    def observe(self, shade: ShadeMap) -> None:
        """Compare earlier forecasts with a map, and forecast from it when one is due."""
        self._compare(shade)
        for name in self.methods:
            state = self._states.get(name, ForecastState())
            self._states[name] = FORECASTERS[name].observed(state, shade, self.settings)
        every_ns = seconds_to_ns(SCORE.score_forecasts_every_s)
        newest_ns = self._newest_ns()
        if newest_ns is None or shade.captured_at_ns - newest_ns >= every_ns:
            self._issued.append(
                {n: FORECASTERS[n].forecast(s, self.settings) for n, s in self._states.items()}
            )

    def _newest_ns(self) -> int | None:
        return next(iter(self._issued[-1].values())).issued_at_ns if self._issued else None

    def _compare(self, shade: ShadeMap) -> None:
        longest_s = max(SCORE.lead_s) + self.step_s
        kept = []
        for forecasts in self._issued:
            issued_ns = next(iter(forecasts.values())).issued_at_ns
            after_s = ns_to_seconds(shade.captured_at_ns - issued_ns)
            for lead_s in SCORE.lead_s:
                # The nearest map: one in the middle between two counts with the earlier.
                if -self.step_s / 2.0 <= lead_s - after_s < self.step_s / 2.0:
                    self._add(forecasts, lead_s, shade)
            if after_s <= longest_s:
                kept.append(forecasts)
        self._issued = kept

    def _add(self, forecasts: dict[str, SunForecast], lead_s: float, shade: ShadeMap) -> None:
        for name, forecast in forecasts.items():
            chances = sun_probability(forecast, lead_s, shade.grid)
            is_seen = forecast.horizon_s >= lead_s
            found = score_cells(chances, shade.is_sunlit, is_seen, shade.valid)
            for cells, score in found.items():
                before = self.sums.get((name, lead_s, cells), LeadScore())
                self.sums[name, lead_s, cells] = before + score


def verified(
    maps: Iterable[ShadeMap], methods: Sequence[str], step_s: float
) -> dict[ForecastKey, LeadScore]:
    """Return the scores of all methods on maps in order of time, `step_s` apart.

    Raises `ValueError` for a map that is not newer than the one before.
    """
    found = Verification(methods, step_s)
    for each in maps:
        found.observe(each)
    return found.sums
