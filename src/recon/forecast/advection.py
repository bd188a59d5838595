"""Shadows move with one velocity; where none are seen upwind, the nearest seen ones are the guide.

Theory of operation, per forecast:

1. The velocity is that of all recent pairs of maps together (`pooled_motion`).
2. At each lead, what will be over a cell is now upwind of it. If that place is seen, its shade is
   the best estimate; else that of the seen place nearest to it is. The farther off that is, the
   less it shows: its deviation from the prior counts by 1 / (1 + distance / scale), where the scale
   follows from its spatial correlation in this flight (`spatial_correlation`). Of seen shade it is
   at most `most_scale_of_shade_m`.
3. From shade to sun the probability rises over an edge that is the softer, the farther off the
   place is that stands for the one upwind; under thin even cloud, which changes little with
   distance, it stays sharp.
4. Followed shadows change their shape: deviations fade with `shade_memory_s`, and chances are
   spread over places as far off as edges were in this flight (`edge_errors`).
5. Without a velocity the wind at the clouds' height is, if a weather forecast states it, as far off
   as it may be wrong; else the shade above each cell, as far off as shadows usually move.
"""

from dataclasses import dataclass, replace
from math import exp

import cv2
import numpy as np

from recon.forecast.edge_errors import edge_error_m, spread, with_edge_errors
from recon.forecast.followed import with_followed, with_recent
from recon.forecast.forecaster import Forecaster
from recon.forecast.motion import ShadowMotion
from recon.forecast.pooled_motion import pooled_motion, with_agreement
from recon.forecast.settings import ForecastSettings
from recon.forecast.spatial_correlation import shade_scale_m, soft_edge_share, with_correlation
from recon.forecast.state import ForecastState, forecast_of, prior_sunlit, with_map
from recon.forecast.upwind import Cells, nearest_seen, visible_upwind_s, without_single_gaps
from recon.model.geo import GroundGrid
from recon.model.shade import (
    SUNLIT_TRANSMITTANCE,
    SURE,
    FloatMap,
    ShadeMap,
    SunForecast,
)


def _observed(state: ForecastState, shade: ShadeMap, settings: ForecastSettings) -> ForecastState:
    state = with_correlation(with_map(state, shade, settings), shade, settings)
    state = with_agreement(state, shade, settings)
    motion = pooled_motion(state, settings)
    state = with_recent(with_edge_errors(state, motion, settings), shade, settings)
    return with_followed(state, motion, settings)


def _forecast(state: ForecastState, settings: ForecastSettings) -> SunForecast:
    newest, prior = state.newest, prior_sunlit(state, settings)
    shade = state.followed or newest
    motion = pooled_motion(state, settings)
    shape = len(settings.lead_s), *shade.valid.shape
    probability = np.full(shape, prior, dtype=np.float32)
    horizon_s: FloatMap | float = 0.0
    if shade.valid.any():
        seen = _Seen.of(shade)
        scaled = replace(
            settings,
            shade_scale_m=shade_scale_m(state, settings),
            soft_edge_per_m=soft_edge_share(state, settings) * settings.soft_edge_per_m,
        )
        for number, lead in enumerate(settings.lead_s):
            error_m = 0.0 if motion is None else edge_error_m(state, lead, settings)
            probability[number] = seen.sun_after(lead, motion, prior, error_m, scaled)
        if motion is not None:
            closed = without_single_gaps(shade.valid)
            horizon_s = visible_upwind_s(closed, shade.grid, motion, settings)
    levels = np.rint(probability * SURE).astype(np.uint8)
    velocity_mps = None if motion is None else (motion.east_mps, motion.north_mps)
    return forecast_of(shade, settings, prior, "advection", levels, horizon_s, velocity_mps)


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """A map whose unseen cells have the values of the seen ones nearest to them; all (R, C)."""

    grid: GroundGrid
    transmittance: FloatMap
    confidence: FloatMap
    nearest: tuple[FloatMap, FloatMap]
    """Row and column of the seen cell nearest to each."""

    @classmethod
    def of(cls, shade: ShadeMap) -> "_Seen":
        at = nearest_seen(shade.valid)
        nearest = at[0].astype(np.float32), at[1].astype(np.float32)
        return cls(shade.grid, shade.transmittance[at], shade.confidence[at], nearest)

    def sun_after(
        self,
        lead_s: float,
        motion: ShadowMotion | None,
        prior: float,
        error_m: float,
        settings: ForecastSettings,
    ) -> FloatMap:
        """Return each cell's probability of sun (R, C) a time after the map, whose edges may then
        be as far off as `error_m`."""
        rows, cols, off_m = self._upwind(lead_s, motion, settings)
        direct, confidence = (
            cv2.remap(each, cols, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
            for each in (self.transmittance, self.confidence)
        )
        soft = settings.least_soft_edge + settings.soft_edge_per_m * off_m
        soft = np.minimum(soft, settings.most_soft_edge)
        sun = (direct - SUNLIT_TRANSMITTANCE) / (2.0 * soft) + 0.5
        sun = np.clip(sun, 1.0 - settings.surest, settings.surest).astype(np.float32, copy=False)
        sun = spread(sun, error_m, self.grid.cell_m)
        weight = confidence * exp(-lead_s / settings.shade_memory_s)
        of_shade_m = min(settings.shade_scale_m, settings.most_scale_of_shade_m)
        scale_m = np.where(sun < prior, of_shade_m, settings.shade_scale_m).astype(np.float32)
        weight = weight / (1.0 + off_m / scale_m)
        found: FloatMap = (prior + weight * (sun - prior)).astype(np.float32)
        return found

    def _upwind(
        self, lead_s: float, motion: ShadowMotion | None, settings: ForecastSettings
    ) -> tuple[FloatMap, FloatMap, FloatMap]:
        """Return the row and column that are read for each cell, and how far in metres they are
        from the place upwind: 0 where that is seen itself."""
        grid = self.grid
        expected, error_mps = _expected(motion, settings)
        # All cells of a row have the same row upwind of them, all of a column the same column.
        rows = _moved(grid.rows, expected.north_mps * lead_s / grid.cell_m)
        cols = _moved(grid.cols, -expected.east_mps * lead_s / grid.cell_m)
        near_rows, near_cols = (
            each.take(_index(rows), axis=0).take(_index(cols), axis=1) for each in self.nearest
        )
        down, right = rows[:, np.newaxis], cols[np.newaxis, :]
        off_m = np.hypot(down - near_rows, right - near_cols) * np.float32(grid.cell_m)
        is_there = off_m < grid.cell_m
        off_m[is_there] = 0.0
        if error_mps > 0.0:
            off_m += np.float32(error_mps * lead_s)
        return np.where(is_there, down, near_rows), np.where(is_there, right, near_cols), off_m


def _expected(
    motion: ShadowMotion | None, settings: ForecastSettings
) -> tuple[ShadowMotion, float]:
    """Return the motion to look upwind by, and how wrong it may be, in m/s."""
    if motion is not None:
        return motion, 0.0
    if settings.wind_aloft_mps is not None:
        return ShadowMotion(*settings.wind_aloft_mps), settings.wind_aloft_error_mps
    return ShadowMotion(0.0, 0.0), settings.usual_speed_mps


def _moved(count: int, by: float) -> FloatMap:
    return np.arange(count, dtype=np.float32) + np.float32(by)


def _index(places: FloatMap) -> Cells:
    """Return the nearest row of the grid to each of all its rows, moved; columns likewise."""
    return np.rint(places).clip(0, places.size - 1).astype(np.intp)


ADVECTION = Forecaster(_observed, _forecast)
