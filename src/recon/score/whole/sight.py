"""What the station saw and foresaw, scored against the sky."""

from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from recon.model.geo import GroundGrid
from recon.model.shade import SUNLIT_TRANSMITTANCE, MaskMap, ShadeMap, SunForecast
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.score.forecast_metrics import LeadScore, score_lead
from recon.score.imager import ImagerScore
from recon.score.scenario import NO_FORECAST, Scenario
from recon.score.settings import RUN
from recon.score.shade_metrics import boundary_error_m, overlap, told_shade
from recon.sim.world import Sky
from recon.station.state.station import Station

T = TypeVar("T")
OLDEST_S = 10.0
"""A shade map older than this says nothing of now: the cells count as told wrongly."""


@dataclass(slots=True)
class Sight:
    """Looks at the station's newest map and forecast when they are due to be scored."""

    scenario: Scenario
    sky: Sky
    footprint: MaskMap
    """On `grid`; used where nothing was told."""
    grid: GroundGrid
    score: ImagerScore = field(default_factory=ImagerScore)
    _maps_due_s: float = RUN.score_maps_every_s
    _forecasts_due_s: float = RUN.score_forecasts_every_s

    def look(self, station: Station, now_ns: int) -> None:
        """Score what the station has now, if it is time to."""
        now_s = now_ns / NS_PER_S
        line = station.shade
        if now_s >= self._maps_due_s:
            self._maps_due_s += RUN.score_maps_every_s
            shade = line.shade
            is_new = shade is not None and now_ns - shade.captured_at_ns <= seconds_to_ns(OLDEST_S)
            self._score_map(shade if is_new else None, now_s)
        is_foreseen = self.scenario.methods.forecast != NO_FORECAST
        if is_foreseen and now_s >= self._forecasts_due_s and line.sun is not None:
            self._forecasts_due_s = now_s + RUN.score_forecasts_every_s
            self._score_forecast(line.sun)

    def _score_map(self, shade: ShadeMap | None, now_s: float) -> None:
        grid = self.grid if shade is None else shade.grid
        at_s = now_s if shade is None else shade.captured_at_ns / NS_PER_S
        seen = self.footprint if shade is None else footprint_on(grid, self.scenario)
        is_shade: MaskMap = self.sky.on_grid(grid, at_s) < SUNLIT_TRANSMITTANCE
        told = ~is_shade if shade is None else told_shade(shade, is_shade)
        self.score.shade += overlap(told, is_shade, seen)
        error_m = boundary_error_m(told, is_shade, seen, grid.cell_m)
        if error_m is not None:
            self.score.boundary_errors_m.append(error_m)
        self.score.known_shares.append(0.0 if shade is None else float(shade.valid[seen].mean()))
        self.score.shade_shares.append(float(is_shade[seen].mean()))

    def _score_forecast(self, sun: SunForecast) -> None:
        seen = footprint_on(sun.grid, self.scenario)
        for lead_s in RUN.lead_s:
            if lead_s not in sun.lead_s:
                continue
            at_s = sun.issued_at_ns / NS_PER_S + lead_s
            is_sunlit: MaskMap = self.sky.on_grid(sun.grid, at_s) >= SUNLIT_TRANSMITTANCE
            for ahead, found in score_lead(sun, lead_s, is_sunlit, seen).items():
                before = self.score.leads.get((lead_s, ahead), LeadScore())
                self.score.leads[lead_s, ahead] = before + found


def footprint_on(grid: GroundGrid, scenario: Scenario) -> MaskMap:
    """Return the cells of a grid within the eye's radius (rows, cols)."""
    imager = scenario.imager
    east_m = grid.west_m + (np.arange(grid.cols) + 0.5) * grid.cell_m - imager.over_m[0]
    north_m = grid.north_m - (np.arange(grid.rows) + 0.5) * grid.cell_m - imager.over_m[1]
    inside: MaskMap = np.hypot.outer(north_m, east_m) <= imager.radius_m
    return inside
