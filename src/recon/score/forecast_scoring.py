"""Forecast methods side by side on the maps of one flight, against the true sky.

The station's own forecast is scored as it is. The methods it is compared with observe the same maps
with memories of their own, so that all differences are the methods'. Which cells are seen is
geometry alone, the same for all: those of which every layer's shadow at the lead lies, at the
forecast's time and by its true motion, on ground that the frames showed.
"""

from dataclasses import dataclass, field

import numpy as np

from recon.forecast import FORECASTERS, ForecastSettings, ForecastState, next_change
from recon.forecast.next_change import STEP_S
from recon.geo import nearest_cells
from recon.model.arrays import FloatArray
from recon.model.geo import GroundGrid
from recon.model.shade import SUNLIT_TRANSMITTANCE, MaskMap, ShadeMap, SunForecast
from recon.model.units import NS_PER_S
from recon.score.change_figures import GRACE_S, ChangeScore, score_change
from recon.score.forecast_figures import LeadScore, SeenCells, score_cells
from recon.score.forecast_figures import sun_probability as probability_on
from recon.score.scenario import PERFECT, TRUE_MOTION
from recon.score.settings import SCORE
from recon.sim.world import Sky
from recon.station.state.imaging import ShadePipeline, made

ForecastKey = tuple[str, float, SeenCells]
"""Method, lead in seconds, cells."""


@dataclass(slots=True)
class ForecastScoring:
    """The sums of one run."""

    sky: Sky
    grid: GroundGrid
    counted: MaskMap
    own: str
    """The station's method."""
    compared: tuple[str, ...]
    """Names of `FORECASTERS`, and `TRUE_MOTION`: the map of the present, moved without error."""
    settings: ForecastSettings
    zero_ns: int = 0
    """The maps' time at which the sky's is zero."""
    sums: dict[ForecastKey, LeadScore] = field(default_factory=dict)
    changes: ChangeScore = field(default_factory=ChangeScore)
    """Changes of the station's own method; the perfect one follows no shadows in the map."""
    _states: dict[str, ForecastState] = field(default_factory=dict)
    _number: int = 0
    _due_s: float = 0.0

    def update(self, line: ShadePipeline, now_s: float) -> None:
        """Observe the newest map, if new, and score all forecasts from it, if due."""
        if line.shade is None or line.number == self._number:
            return
        self._number = line.number
        for name in self.compared:
            if name != TRUE_MOTION:
                state = self._states.get(name, ForecastState())
                observed = FORECASTERS[name].observed
                self._states[name] = observed(state, line.shade, self.settings)
        if now_s >= self._due_s:
            self._due_s = now_s + SCORE.score_forecasts_every_s
            sun = made(line.newest_sun(self.settings))
            assert sun is not None  # there is a map
            self._score(sun, line.shade, line.seen)
            if self.own != PERFECT:
                self.changes += self._changes(sun, line.followed or line.shade)

    def _score(self, own: SunForecast, shade: ShadeMap, seen: MaskMap | None) -> None:
        issued = {
            name: FORECASTERS[name].forecast(state, self.settings)
            for name, state in self._states.items()
        }
        issued[self.own] = own
        at_s = (shade.captured_at_ns - self.zero_ns) / NS_PER_S
        view = shade.valid if seen is None else seen
        for lead_s in SCORE.lead_s:
            later_s = at_s + lead_s
            is_sunlit: MaskMap = self.sky.on_grid(self.grid, later_s) >= SUNLIT_TRANSMITTANCE
            is_seen = self._seen(shade.grid, view, at_s, later_s)
            chances = {n: probability_on(each, lead_s, self.grid) for n, each in issued.items()}
            if TRUE_MOTION in self.compared:
                chances[TRUE_MOTION] = self._true_motion(own, is_seen, at_s, later_s)
            for name, probability in chances.items():
                self._add(name, lead_s, probability, is_sunlit, is_seen)

    def _add(
        self, name: str, lead_s: float, chances: FloatArray, is_sunlit: MaskMap, is_seen: MaskMap
    ) -> None:
        for cells, found in score_cells(chances, is_sunlit, is_seen, self.counted).items():
            before = self.sums.get((name, lead_s, cells), LeadScore())
            self.sums[name, lead_s, cells] = before + found

    def _seen(self, grid: GroundGrid, view: MaskMap, at_s: float, later_s: float) -> MaskMap:
        """Return the cells (R, C) whose clouds at a later time are over ground in view at a time.

        Under a clear sky these are the cells in view.
        """
        is_seen = np.ones((self.grid.rows, self.grid.cols), dtype=np.bool_)
        for east_m, north_m in self.sky.origins_m(at_s, later_s).tolist() or [(0.0, 0.0)]:
            rows, cols, is_on = nearest_cells(grid, self.grid, (east_m, north_m))
            is_seen &= view[rows, cols] & is_on
        return is_seen

    def _changes(self, own: SunForecast, shade: ShadeMap) -> ChangeScore:
        """Return the score of the times to shade that follow from a forecast and its map."""
        rows, cols, is_on = np.broadcast_arrays(*nearest_cells(shade.grid, self.grid))
        counted = self.counted & is_on
        cells = np.stack([rows[counted], cols[counted]], axis=1)
        found = next_change(shade, own, cells, self.settings)
        at_s = (shade.captured_at_ns - self.zero_ns) / NS_PER_S
        until_s = float(found.horizon_s.max(initial=0.0)) + GRACE_S
        true_s = np.full(len(found.horizon_s), np.inf)
        for lead_s in np.arange(STEP_S, until_s + STEP_S, STEP_S).tolist():
            later_s = at_s + lead_s
            is_shade = self.sky.on_grid(self.grid, later_s)[counted] < SUNLIT_TRANSMITTANCE
            true_s = np.where(is_shade & np.isinf(true_s), lead_s, true_s)
        return score_change(found, true_s)

    def _true_motion(
        self, own: SunForecast, is_seen: MaskMap, at_s: float, later_s: float
    ) -> FloatArray:
        surest = self.settings.surest
        is_sunlit = self.sky.drifted(self.grid, at_s, later_s) >= SUNLIT_TRANSMITTANCE
        return np.where(is_seen, np.where(is_sunlit, surest, 1.0 - surest), own.prior_sunlit)
