"""A baseline: every place has a motion of its own, read from two maps, and shadows follow it.

Dense optical flow (T. Kroeger et al., Fast Optical Flow using Dense Inverse Search, ECCV 2016, as
OpenCV has it) between two maps a quarter of a minute apart; where the maps are even it shows
nothing, so it is averaged with weights of the slopes of shade. Shadows then follow it backwards in
steps from each cell (semi-Lagrangian advection; U. Germann and I. Zawadzki, Monthly Weather Review
130, 2002). Without an earlier map, or without slopes, the forecast is that of `persistence`.
"""

from collections.abc import Iterator

import cv2
import numpy as np
import numpy.typing as npt

from recon.forecast.followed import with_recent
from recon.forecast.forecaster import Forecaster
from recon.forecast.persistence import persisting
from recon.forecast.settings import ForecastSettings
from recon.forecast.state import ForecastState, forecast_of, prior_sunlit, sunlit_now, with_map
from recon.forecast.upwind import nearest_seen, without_single_gaps
from recon.model.shade import SURE, FloatMap, ShadeMap, SunForecast
from recon.model.units import ns_to_seconds, seconds_to_ns

Flow = npt.NDArray[np.float32]
"""(R, C, 2): cells to the right and downward per second."""

LEAST_CELLS = 32
"""Rows and columns of the smallest map that flow is read from."""
SMOOTHED_CELLS = 12.0
NOISE_SLOPE, LEAST_SLOPE = 0.01, 0.001
"""Slope of smoothed maps, per cell, that the detection's errors have too; mean slope beyond it from
which on a pair of maps shows a motion."""


def _observed(state: ForecastState, shade: ShadeMap, settings: ForecastSettings) -> ForecastState:
    return with_recent(with_map(state, shade, settings), shade, settings)


def _forecast(state: ForecastState, settings: ForecastSettings) -> SunForecast:
    shade, prior = state.newest, prior_sunlit(state, settings)
    flow = _flow_of(state, settings)
    if flow is None:
        return persisting(shade, prior, settings)
    now = sunlit_now(shade, prior, settings)
    seen = without_single_gaps(shade.valid)
    shape = len(settings.lead_s), *now.shape
    probability = np.full(shape, round(prior * SURE), dtype=np.uint8)
    horizon_s = np.zeros(now.shape, dtype=np.float32)
    alive = shade.valid.copy()
    for number, (lead, rows, cols) in enumerate(_upwind(flow, settings)):
        there = _read(seen.astype(np.float32), rows, cols, nowhere=0.0) > 0.5
        alive &= there
        later = _read(now, rows, cols, nowhere=prior)
        later = prior + np.exp(-lead / settings.shape_memory_s) * (later - prior)
        probability[number][alive] = np.rint(later[alive] * SURE).astype(np.uint8)
        horizon_s[alive] = lead
    return forecast_of(shade, settings, prior, "dense_flow", probability, horizon_s)


def _flow_of(state: ForecastState, settings: ForecastSettings) -> Flow | None:
    """Return the motion everywhere; None where two maps do not show any."""
    now, least_ns = state.newest, seconds_to_ns(settings.flow_over_s - settings.keep_every_s)
    older = [one for one in state.recent if now.captured_at_ns - one.captured_at_ns >= least_ns]
    if not older or min(now.valid.shape) < LEAST_CELLS or not now.valid.any():
        return None
    before = older[-1]
    if before.grid != now.grid or not before.valid.any():
        return None
    first, second = (_grey(each) for each in (before, now))
    search = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    found = np.asarray(search.calc(first, second, np.zeros((*first.shape, 2), np.float32)))
    even = cv2.GaussianBlur(second.astype(np.float32), (0, 0), settings.smooth_cells)
    slopes = np.hypot(*np.gradient(even / np.float32(SURE))) - np.float32(NOISE_SLOPE)
    seen = before.valid & now.valid
    weight = np.where(seen, np.maximum(slopes, 0.0), 0.0).astype(np.float32)
    total = float(weight.sum())
    if total <= LEAST_SLOPE * float(seen.sum()):
        return None
    seconds = ns_to_seconds(now.captured_at_ns - before.captured_at_ns)
    mean = (weight[..., np.newaxis] * found).sum(axis=(0, 1)) / total
    smooth = cv2.GaussianBlur(weight[..., np.newaxis] * (found - mean), (0, 0), SMOOTHED_CELLS)
    share = cv2.GaussianBlur(weight, (0, 0), SMOOTHED_CELLS)[..., np.newaxis]
    flow: Flow = ((mean + smooth / (share + np.float32(LEAST_SLOPE))) / seconds).astype(np.float32)
    return flow


def _grey(shade: ShadeMap) -> npt.NDArray[np.uint8]:
    """Return (R, C): the transmittance in 255ths; of the nearest seen cell where nothing is."""
    filled = shade.transmittance[nearest_seen(shade.valid)]
    return np.rint(np.clip(filled, 0.0, 1.0) * SURE).astype(np.uint8)


def _upwind(flow: Flow, settings: ForecastSettings) -> Iterator[tuple[float, FloatMap, FloatMap]]:
    """Yield each lead, and row and column (R, C) of what will be over each cell then."""
    both = np.indices(flow.shape[:2], dtype=np.float32)
    rows: FloatMap = both[0]
    cols: FloatMap = both[1]
    at_s = 0.0
    for lead_s in settings.lead_s:
        while at_s < lead_s:
            step_s = np.float32(min(settings.horizon_step_s, lead_s - at_s))
            moved = cv2.remap(flow, cols, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
            cols, rows = cols - step_s * moved[..., 0], rows - step_s * moved[..., 1]
            at_s += float(step_s)
        yield lead_s, rows, cols


def _read(values: FloatMap, rows: FloatMap, cols: FloatMap, nowhere: float) -> FloatMap:
    found = cv2.remap(
        values,
        cols,
        rows,
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_CONSTANT,
        borderValue=nowhere,
    )
    read: FloatMap = found.astype(np.float32, copy=False)
    return read


DENSE_FLOW = Forecaster(_observed, _forecast)
