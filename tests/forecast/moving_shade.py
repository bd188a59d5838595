"""Shade maps of known shade with a known motion, as a good detector would make them."""

import numpy as np
from tests.detection.shaded_field import FIELD, SEEN_RADIUS_M, DriftingShade, centres

from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.geo import GroundGrid
from recon.model.shade import SUNLIT_TRANSMITTANCE, ShadeMap, SunForecast

SEEN = np.hypot(*centres(FIELD)) < SEEN_RADIUS_M


def shade_map(
    transmittance: np.ndarray,
    at_s: float,
    seen: np.ndarray = SEEN,
    confidence: float = 0.9,
    grid: GroundGrid = FIELD,
) -> ShadeMap:
    nowhere = np.float32(np.nan)
    return ShadeMap(
        grid=grid,
        captured_at_ns=round(at_s * 1e9),
        source_serials=("IMAGER",),
        transmittance=np.where(seen, transmittance, nowhere).astype(np.float32),
        valid=seen,
        confidence=np.where(seen, confidence, 0.0).astype(np.float32),
        metres_per_pixel=np.where(seen, 1.0, nowhere).astype(np.float32),
    )


def drawn_velocity(seed: int, slowest: float = 2.0, fastest: float = 8.0) -> tuple[float, float]:
    """Return a random velocity, m/s east and north."""
    rng = np.random.default_rng(seed)
    speed, course = rng.uniform(slowest, fastest), rng.uniform(0.0, 2.0 * np.pi)
    return float(speed * np.cos(course)), float(speed * np.sin(course))


def noisy_map(shade: DriftingShade, at_s: float) -> ShadeMap:
    """Return a map with a detector's errors: 0.1 in transmittance."""
    rng = np.random.default_rng([shade.seed, round(at_s)])
    direct = shade.transmittance(FIELD, at_s)
    return shade_map(np.clip(direct + rng.normal(0.0, 0.1, direct.shape), 0.0, 1.0), at_s)


def is_sunlit(shade: DriftingShade, at_s: float) -> np.ndarray:
    """Return the true cells in sun."""
    return shade.transmittance(FIELD, at_s) >= SUNLIT_TRANSMITTANCE


def forecasts(
    method: str, maps: list[ShadeMap], settings: ForecastSettings | None = None
) -> list[SunForecast]:
    """Return the forecast after each map."""
    state, found = ForecastState(), []
    for one in maps:
        state, forecast = step(method, state, one, settings or ForecastSettings())
        found.append(forecast)
    return found


def step(
    method: str, state: ForecastState, shade: ShadeMap, settings: ForecastSettings
) -> tuple[ForecastState, SunForecast]:
    """Return the state after a map, and its forecast."""
    return FORECASTERS[method].after(state, shade, settings)
