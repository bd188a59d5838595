"""Forecast methods on a recorded sequence of maps: each is compared with the map of its time.

Truth is what came: the map nearest to the lead's time, at most `NEAR_S` from it; a lead whose time
is in a longer gap is not compared. Cells count that the later map knows. `SEEN` are those within
the method's own horizon. Methods are made for maps a few seconds apart; a slower sequence (radar,
satellites) is read as if its maps were `USUAL_STEP_S` apart, so that leads and speeds count in its
own steps.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.shade import ShadeMap, SunForecast
from recon.model.units import seconds_to_ns
from recon.score.forecast_figures import LeadScore, score_cells, sun_probability
from recon.score.forecast_scoring import ForecastKey
from recon.score.settings import SCORE

USUAL_STEP_S = 5.0
NEAR_S = USUAL_STEP_S / 2.0
"""Half the step between two maps: each lead of a sequence without gaps has a map. Maps of a flight
are half a second apart with gaps of seconds, which are short for the shortest lead, too."""
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
    settings: ForecastSettings = field(default_factory=ForecastSettings)
    sums: dict[ForecastKey, LeadScore] = field(default_factory=dict)
    _states: dict[str, ForecastState] = field(default_factory=dict)
    _issued: list[dict[str, SunForecast]] = field(default_factory=list)
    _before: ShadeMap | None = None

    def observe(self, shade: ShadeMap) -> None:
        """Compare earlier forecasts with a map, and forecast from it when one is due."""
        self._compare(shade.captured_at_ns, shade)
        self._before = shade
        for name in self.methods:
            state = self._states.get(name, ForecastState())
            self._states[name] = FORECASTERS[name].observed(state, shade, self.settings)
        every_ns = seconds_to_ns(SCORE.score_forecasts_every_s)
        newest_ns = self._newest_ns()
        if newest_ns is None or shade.captured_at_ns - newest_ns >= every_ns:
            self._issued.append(
                {n: FORECASTERS[n].forecast(s, self.settings) for n, s in self._states.items()}
            )

    def finish(self) -> None:
        """Compare with the last map what was forecast for a time shortly after it."""
        if self._before is not None:
            self._compare(self._before.captured_at_ns + seconds_to_ns(NEAR_S), None)
            self._before = None

    def _newest_ns(self) -> int | None:
        return _issued_ns(self._issued[-1]) if self._issued else None

    def _compare(self, at_ns: int, after: ShadeMap | None) -> None:
        """Compare leads whose time is after the map before, up to a time: that of the map after."""
        before = self._before
        if before is None:
            return
        for forecasts in self._issued:
            issued_ns = _issued_ns(forecasts)
            for lead_s in SCORE.lead_s:
                due_ns = issued_ns + seconds_to_ns(lead_s)
                if before.captured_at_ns < due_ns <= at_ns:
                    self._compare_lead(forecasts, lead_s, before, after)
        longest_ns = seconds_to_ns(max(SCORE.lead_s))
        self._issued = [each for each in self._issued if at_ns <= _issued_ns(each) + longest_ns]

    def _compare_lead(
        self,
        forecasts: dict[str, SunForecast],
        lead_s: float,
        before: ShadeMap,
        after: ShadeMap | None,
    ) -> None:
        """Compare with the nearer of the maps around a lead's time; the later one in the middle."""
        due_ns = _issued_ns(forecasts) + seconds_to_ns(lead_s)
        early_ns = due_ns - before.captured_at_ns
        is_later = after is not None and after.captured_at_ns - due_ns <= early_ns
        nearest = after if after is not None and is_later else before
        if abs(due_ns - nearest.captured_at_ns) <= seconds_to_ns(NEAR_S):
            self._add(forecasts, lead_s, nearest)

    def _add(self, forecasts: dict[str, SunForecast], lead_s: float, shade: ShadeMap) -> None:
        for name, forecast in forecasts.items():
            chances = sun_probability(forecast, lead_s, shade.grid)
            is_seen = forecast.horizon_s >= lead_s
            found = score_cells(chances, shade.is_sunlit, is_seen, shade.valid)
            for cells, score in found.items():
                before = self.sums.get((name, lead_s, cells), LeadScore())
                self.sums[name, lead_s, cells] = before + score


def verified(maps: Iterable[ShadeMap], methods: Sequence[str]) -> dict[ForecastKey, LeadScore]:
    """Return the scores of all methods on maps in order of time, in the methods' time.

    Raises `ValueError` for a map that is not newer than the one before.
    """
    found = Verification(methods)
    for each in maps:
        found.observe(each)
    found.finish()
    return found.sums


def _issued_ns(forecasts: dict[str, SunForecast]) -> int:
    return next(iter(forecasts.values())).issued_at_ns
