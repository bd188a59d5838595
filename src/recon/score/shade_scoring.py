"""The station's shade maps and sun forecasts, scored against the simulator's sky."""

from dataclasses import dataclass, field

import numpy as np

from recon.model.geo import GroundGrid
from recon.model.shade import SUNLIT_TRANSMITTANCE, MaskMap, ShadeMap, SunForecast
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.score.forecast_metrics import HorizonCells, LeadScore, score_lead
from recon.score.scenario import NO_FORECAST, Scenario
from recon.score.settings import SCORE
from recon.score.shade_metrics import Overlap, boundary_error_m, overlap, shade_or_wrong
from recon.sim.world import Sky
from recon.station.state.station import Station


@dataclass(slots=True)
class ImagerScore:
    """Sums of one run."""

    shade: Overlap = field(default_factory=Overlap)
    boundary_errors_m: list[float] = field(default_factory=list)
    known_shares: list[float] = field(default_factory=list)
    shade_shares: list[float] = field(default_factory=list)
    """Of the footprint, in truth."""
    leads: dict[tuple[float, HorizonCells], LeadScore] = field(default_factory=dict)


@dataclass(slots=True)
class ShadeScoring:
    """Scores the station's newest map and forecast at fixed intervals."""

    scenario: Scenario
    sky: Sky
    footprint: MaskMap
    """On `grid`; used while the station has no map."""
    grid: GroundGrid
    score: ImagerScore = field(default_factory=ImagerScore)
    _maps_due_s: float = SCORE.score_maps_every_s
    _forecasts_due_s: float = SCORE.score_forecasts_every_s

    def update(self, station: Station, now_ns: int) -> None:
        """Score the station's present map and forecast, if due."""
        now_s = now_ns / NS_PER_S
        line = station.shade
        if now_s >= self._maps_due_s:
            self._maps_due_s += SCORE.score_maps_every_s
            oldest_ns = now_ns - seconds_to_ns(SCORE.oldest_map_s)
            shade = line.shade
            is_new = shade is not None and shade.captured_at_ns >= oldest_ns
            self._score_map(shade if is_new else None, now_s)
        has_forecast = self.scenario.methods.forecast != NO_FORECAST
        if has_forecast and now_s >= self._forecasts_due_s and line.sun is not None:
            self._forecasts_due_s = now_s + SCORE.score_forecasts_every_s
            self._score_forecast(line.sun)

    def _score_map(self, shade: ShadeMap | None, now_s: float) -> None:
        grid = self.grid if shade is None else shade.grid
        at_s = now_s if shade is None else shade.captured_at_ns / NS_PER_S
        counted = self.footprint if shade is None else footprint_on(grid, self.scenario)
        is_shade: MaskMap = self.sky.on_grid(grid, at_s) < SUNLIT_TRANSMITTANCE
        detected = ~is_shade if shade is None else shade_or_wrong(shade, is_shade)
        self.score.shade += overlap(detected, is_shade, counted)
        error_m = boundary_error_m(detected, is_shade, counted, grid.cell_m)
        if error_m is not None:
            self.score.boundary_errors_m.append(error_m)
        known = 0.0 if shade is None else float(shade.valid[counted].mean())
        self.score.known_shares.append(known)
        self.score.shade_shares.append(float(is_shade[counted].mean()))

    def _score_forecast(self, sun: SunForecast) -> None:
        counted = footprint_on(sun.grid, self.scenario)
        for lead_s in SCORE.lead_s:
            if lead_s not in sun.lead_s:
                continue
            at_s = sun.issued_at_ns / NS_PER_S + lead_s
            is_sunlit: MaskMap = self.sky.on_grid(sun.grid, at_s) >= SUNLIT_TRANSMITTANCE
            for ahead, found in score_lead(sun, lead_s, is_sunlit, counted).items():
                before = self.score.leads.get((lead_s, ahead), LeadScore())
                self.score.leads[lead_s, ahead] = before + found


def footprint_on(grid: GroundGrid, scenario: Scenario) -> MaskMap:
    """Return the cells of a grid within the imaging drone's radius (rows, cols)."""
    imager = scenario.imager
    east_m = grid.west_m + (np.arange(grid.cols) + 0.5) * grid.cell_m - imager.over_m[0]
    north_m = grid.north_m - (np.arange(grid.rows) + 0.5) * grid.cell_m - imager.over_m[1]
    inside: MaskMap = np.hypot.outer(north_m, east_m) <= imager.radius_m
    return inside
