"""Two baselines: sun and shade stay as they are, and only the recent share in sun is known.

`persistence`: the probability decays exponentially from the current one to the prior
(`persistence_memory_s`), and is the prior beyond `persistence_horizon_s`. `climatology`: it is the
prior everywhere.
"""

import numpy as np

from recon.forecast.forecaster import Forecaster
from recon.forecast.settings import ForecastSettings
from recon.forecast.state import ForecastState, prior_sunlit, sunlit_now, with_map
from recon.model.shade import SURE, ShadeMap, SunForecast


def _persistence(state: ForecastState, settings: ForecastSettings) -> SunForecast:
    return persisting(state.newest, prior_sunlit(state, settings), settings)


def persisting(shade: ShadeMap, prior: float, settings: ForecastSettings) -> SunForecast:
    """Return the forecast by persistence of one map; other methods fall back to it."""
    lead_s = np.array(settings.lead_s, dtype=np.float64)
    kept = np.exp(-lead_s / settings.persistence_memory_s)
    kept[lead_s > settings.persistence_horizon_s] = 0.0
    now = sunlit_now(shade, prior, settings)
    # Relaxation of a two-state process towards its mean.
    probability = prior + kept[:, np.newaxis, np.newaxis] * (now - prior)
    return SunForecast(
        grid=shade.grid,
        issued_at_ns=shade.captured_at_ns,
        lead_s=lead_s,
        sun_probability=np.rint(probability * SURE).astype(np.uint8),
        horizon_s=np.where(
            shade.valid, np.float32(settings.persistence_horizon_s), np.float32(np.nan)
        ),
        prior_sunlit=prior,
        method="persistence",
    )


def _climatology(state: ForecastState, settings: ForecastSettings) -> SunForecast:
    shade, prior = state.newest, prior_sunlit(state, settings)
    lead_s = np.array(settings.lead_s, dtype=np.float64)
    cells = shade.valid.shape
    return SunForecast(
        grid=shade.grid,
        issued_at_ns=shade.captured_at_ns,
        lead_s=lead_s,
        sun_probability=np.full((len(lead_s), *cells), round(prior * SURE), dtype=np.uint8),
        horizon_s=np.where(shade.valid, np.float32(0.0), np.float32(np.nan)),
        prior_sunlit=prior,
        method="climatology",
    )


PERSISTENCE = Forecaster(with_map, _persistence)
CLIMATOLOGY = Forecaster(with_map, _climatology)
