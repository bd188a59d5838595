"""All shadows move on with one common velocity.

Theory of operation, per map:

1. Phase correlation with maps 10, 20 and 40 s older gives a velocity per pair (`motion`); the
   median over the last minute is the motion. Without enough agreeing pairs the forecast is that
   of `persistence`, and its `method` is reported as such.
2. At each lead a cell gets the probability of the place now upwind of it, as long as that place is
   visible now: this bounds the cell's horizon. Single unknown cells between known ones do not: they
   get their neighbours' mean. For a cell that is unknown itself nothing is predicted.
3. The map is blurred by the growing error of the velocity, and fades to the prior as clouds change
   shape (`shape_memory_s`).
"""

from dataclasses import replace

import cv2
import numpy as np

from recon.forecast.forecaster import Forecaster
from recon.forecast.motion import ShadowMotion, motion_of, with_pairs
from recon.forecast.persistence import persisting
from recon.forecast.settings import ForecastSettings
from recon.forecast.state import ForecastState, forecast_of, prior_sunlit, sunlit_now, with_map
from recon.forecast.upwind import upwind, visible_upwind_s, without_single_gaps
from recon.model.geo import GroundGrid
from recon.model.shade import SURE, FloatMap, MaskMap, ShadeMap, SunForecast
from recon.model.units import seconds_to_ns

CONFIDENCE_HALVES_S = 3.0
"""Of a map that is moved on: shadows change their shape, and the velocity is not exact."""
BOX_OVER_SIGMA = float(np.sqrt(12.0))
"""A box this many standard deviations wide has that standard deviation."""


def _observed(state: ForecastState, shade: ShadeMap, settings: ForecastSettings) -> ForecastState:
    return with_pairs(with_map(state, shade, settings), shade, settings)


def _forecast(state: ForecastState, settings: ForecastSettings) -> SunForecast:
    prior, motion = prior_sunlit(state, settings), motion_of(state, settings)
    if motion is None:
        return persisting(state.newest, prior, settings)
    return _moving_on(state.newest, motion, prior, settings)


GLOBAL_SHIFT = Forecaster(_observed, _forecast)


def _moving_on(
    shade: ShadeMap, motion: ShadowMotion, prior: float, settings: ForecastSettings
) -> SunForecast:
    closed = without_single_gaps(shade.valid)
    upwind_s = visible_upwind_s(closed, shade.grid, motion, settings)
    horizon_s = np.where(shade.valid, upwind_s, np.float32(np.nan))
    now = _filled(sunlit_now(shade, prior, settings), shade.valid, closed)
    shape = len(settings.lead_s), *now.shape
    probability = np.full(shape, round(prior * SURE), dtype=np.uint8)
    for i, lead in enumerate(settings.lead_s):
        known = horizon_s >= lead
        if known.any():
            later = _after(now, shade.grid, motion, lead)
            # Shapes decorrelate: fade to the prior even where the motion is known.
            later = prior + np.exp(-lead / settings.shape_memory_s) * (later - prior)
            probability[i][known] = np.rint(later[known] * SURE).astype(np.uint8)
    velocity_mps = motion.east_mps, motion.north_mps
    return forecast_of(shade, settings, prior, "global_shift", probability, upwind_s, velocity_mps)


def moved_on(shade: ShadeMap, velocity_mps: tuple[float, float] | None, seconds: float) -> ShadeMap:
    """Return a map as the motion (east, north) alone changes it in a time, in whole cells.

    What was not seen then is not valid. The confidence halves in `CONFIDENCE_HALVES_S`.
    """
    grid, (east_mps, north_mps) = shade.grid, velocity_mps or (0.0, 0.0)
    right, down = (round(mps * seconds / grid.cell_m) for mps in (east_mps, -north_mps))
    move = np.array([[1.0, 0.0, right], [0.0, 1.0, down]])

    def moved(values: FloatMap, nowhere: float) -> FloatMap:
        size = (grid.cols, grid.rows)
        found = cv2.warpAffine(values, move, size, flags=cv2.INTER_NEAREST, borderValue=nowhere)
        return found.astype(np.float32, copy=False)

    fading = np.float32(np.exp2(-seconds / CONFIDENCE_HALVES_S))
    return replace(
        shade,
        captured_at_ns=shade.captured_at_ns + seconds_to_ns(seconds),
        transmittance=moved(shade.transmittance, float("nan")),
        valid=moved(shade.valid.astype(np.float32), 0.0) > 0.5,
        confidence=moved(shade.confidence, 0.0) * fading,
        metres_per_pixel=moved(shade.metres_per_pixel, float("nan")),
    )


def _filled(now: FloatMap, known: MaskMap, closed: MaskMap) -> FloatMap:
    """Return (R, C): the map with the mean of the known neighbours in the closed gaps."""
    weight = known.astype(np.float32)
    sums, counts = (
        cv2.boxFilter(each, -1, (3, 3), normalize=False, borderType=cv2.BORDER_CONSTANT)
        for each in (now * weight, weight)
    )
    gaps = closed & ~known & (counts > 0.0)
    return np.where(gaps, sums / np.maximum(counts, 1.0), now).astype(np.float32)


def _after(now: FloatMap, grid: GroundGrid, motion: ShadowMotion, lead_s: float) -> FloatMap:
    """Return (R, C): the current map moved to a lead, blurred by the position error then."""
    # An odd number of cells, so that blurring does not shift the map.
    box = round(BOX_OVER_SIGMA * motion.spread_mps * lead_s / grid.cell_m) // 2 * 2 + 1
    blurred = cv2.blur(now, (box, box), borderType=cv2.BORDER_REPLICATE) if box > 1 else now
    to_now = upwind(grid, motion, lead_s)
    size = (grid.cols, grid.rows)
    how = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    later = cv2.warpAffine(blurred, to_now, size, flags=how, borderMode=cv2.BORDER_REPLICATE)
    return later.astype(np.float32, copy=False)
