"""The eye of a run: shade maps and forecasts by the named methods, scored against the sky."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.detection import DETECTORS, DetectionSettings, DetectionState, RejectedFrame
from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.geo import GroundGrid
from recon.model.shade import (
    SUNLIT_TRANSMITTANCE,
    FloatArray,
    FloatMap,
    MaskMap,
    ShadeMap,
    SunForecast,
)
from recon.model.units import seconds_to_ns
from recon.score.fault_effects import blind_spans
from recon.score.forecast_metrics import Ahead, LeadScore, score_lead
from recon.score.ground import CoarseImager
from recon.score.scenario import IDEAL, NO_FORECAST, Scenario
from recon.score.settings import RUN, RunSettings
from recon.score.shade_metrics import Overlap, boundary_error_m, overlap, told_shade
from recon.sim.world import Sky
from recon.sim.world.light import clear_sky_light

PIXELS_PER_RADIAN = 250.0


@dataclass(slots=True)
class ImagerScore:
    """What is summed up of one run."""

    shade: Overlap = field(default_factory=Overlap)
    boundary_errors_m: list[float] = field(default_factory=list)
    known_shares: list[float] = field(default_factory=list)
    shade_shares: list[float] = field(default_factory=list)
    """Of the footprint, in truth."""
    leads: dict[tuple[float, Ahead], LeadScore] = field(default_factory=dict)


class Imager:
    """Looks once a period; remembers what its methods remember."""

    def __init__(
        self, scenario: Scenario, sky: Sky, seed: int, settings: RunSettings = RUN
    ) -> None:
        self._scenario, self._sky, self._settings = scenario, sky, settings
        self.grid, self.footprint = _footprint(scenario)
        self._middles_m = _middles_m(self.grid, self.footprint)
        fine_m = np.float32(scenario.imager.height_m / PIXELS_PER_RADIAN)
        self._sure = self.footprint.astype(np.float32)
        self._fine = np.where(self.footprint, fine_m, np.float32(np.nan))
        over_m = scenario.imager.over_m
        place_m = (over_m[0], over_m[1], scenario.imager.height_m)
        self._blind_s = blind_spans(scenario)
        self._camera = CoarseImager(self.grid, self.footprint, place_m, seed)
        self._detection, self._forecast = DetectionState(), ForecastState()
        self._to_check: dict[float, list[tuple[float, SunForecast]]] = {}
        self._number = 0
        self.score = ImagerScore()

    def look(self, time_s: float) -> ShadeMap | None:
        """Return the shade map of a moment; None when there is no picture, or it is rejected.

        Times are whole multiples of the eye's period, each after the one before.
        """
        truth = self._truth(time_s)
        is_shade = truth < SUNLIT_TRANSMITTANCE
        self._check(time_s, ~is_shade)
        shade = None if self._is_blind(time_s) else self._detected(time_s, truth)
        if _is_due(time_s, self._settings.score_maps_every_s):
            self._score_map(shade, is_shade)
        if shade is not None and _is_due(time_s, self._settings.forecast_every_s):
            self._foresee(time_s, shade)
        return shade

    def _is_blind(self, time_s: float) -> bool:
        return any(from_s <= time_s < until_s for from_s, until_s in self._blind_s)

    def _truth(self, time_s: float) -> FloatMap:
        """What reaches the cells of the footprint; 1 outside, where nobody looks."""
        truth = np.ones(self.footprint.shape, dtype=np.float32)
        truth[self.footprint] = self._sky.transmittance(*self._middles_m, time_s)
        return truth

    def _detected(self, time_s: float, truth: FloatMap) -> ShadeMap | None:
        self._number += 1
        method = self._scenario.methods.detection
        if method == IDEAL:
            return self._ideal(time_s, truth)
        light = clear_sky_light(self._sky.sun_at(time_s), self._scenario.light)
        picture = self._camera.picture(self._number, time_s, truth, light)
        settings = DetectionSettings(method=method, grid=self.grid)
        self._detection, found = DETECTORS[method](self._detection, picture, settings)
        return None if isinstance(found, RejectedFrame) else found

    def _ideal(self, time_s: float, truth: FloatMap) -> ShadeMap:
        """The truth, as a map."""
        seen = self.footprint
        told = np.where(seen, truth, np.float32(np.nan))
        at_ns = seconds_to_ns(time_s)
        return ShadeMap(self.grid, at_ns, ("IMAGER",), told, seen, self._sure, self._fine)

    def _score_map(self, shade: ShadeMap | None, is_shade: MaskMap) -> None:
        seen, score = self.footprint, self.score
        told = ~is_shade if shade is None else told_shade(shade, is_shade)
        score.shade += overlap(told, is_shade, seen)
        error_m = boundary_error_m(told, is_shade, seen, self.grid.cell_m)
        if error_m is not None:
            score.boundary_errors_m.append(error_m)
        known = 0.0 if shade is None else float(shade.valid[seen].mean())
        score.known_shares.append(known)
        score.shade_shares.append(float(is_shade[seen].mean()))

    def _foresee(self, time_s: float, shade: ShadeMap) -> None:
        method = self._scenario.methods.forecast
        if method == NO_FORECAST:
            return
        settings = ForecastSettings(method=method)
        self._forecast, forecast = FORECASTERS[method](self._forecast, shade, settings)
        if _is_due(time_s, self._settings.score_forecasts_every_s):
            for lead_s in self._settings.lead_s:
                self._to_check.setdefault(time_s + lead_s, []).append((lead_s, forecast))

    def _check(self, time_s: float, is_sunlit: MaskMap) -> None:
        """Score the forecasts that spoke of this moment."""
        for lead_s, forecast in self._to_check.pop(time_s, ()):
            self._add(score_lead(forecast, lead_s, is_sunlit, self.footprint), lead_s)

    def _add(self, found: Mapping[Ahead, LeadScore], lead_s: float) -> None:
        for ahead, score in found.items():
            before = self.score.leads.get((lead_s, ahead), LeadScore())
            self.score.leads[lead_s, ahead] = before + score


def _footprint(scenario: Scenario) -> tuple[GroundGrid, MaskMap]:
    """The grid around what the eye sees, and the circle in it; or the region's part of that."""
    imager = scenario.imager
    half = int(np.ceil(imager.radius_m / imager.cell_m))
    side_m = half * imager.cell_m
    west_m, north_m = imager.over_m[0] - side_m, imager.over_m[1] + side_m
    grid = GroundGrid(scenario.frame, west_m, north_m, imager.cell_m, 2 * half, 2 * half)
    off_m = (np.arange(2 * half) + 0.5) * imager.cell_m - side_m
    circle: MaskMap = np.hypot.outer(off_m, off_m) <= imager.radius_m
    if scenario.methods.is_guidance_alone:
        circle &= _region_cells(scenario, grid)
    return grid, circle


def _region_cells(scenario: Scenario, grid: GroundGrid) -> MaskMap:
    """The cells that hold any of the region, and some beside it."""
    region = scenario.survey.region
    area = shapely.Polygon(region.outline_m, list(region.holes_m)).buffer(grid.cell_m)
    east_m, north_m = _middles_m(grid, np.ones((grid.rows, grid.cols), dtype=np.bool_))
    inside = shapely.contains_xy(area, east_m, north_m)
    return np.asarray(inside, dtype=np.bool_).reshape(grid.rows, grid.cols)


def _middles_m(grid: GroundGrid, cells: MaskMap) -> tuple[FloatArray, FloatArray]:
    """East and north of the middles of the chosen cells, (N,) each, by rows."""
    row, col = (axis.astype(np.float64) for axis in np.nonzero(cells))
    return grid.west_m + (col + 0.5) * grid.cell_m, grid.north_m - (row + 0.5) * grid.cell_m


def _is_due(time_s: float, every_s: float) -> bool:
    """Whether a time is a whole multiple; times and periods are whole seconds."""
    return time_s % every_s == 0.0
