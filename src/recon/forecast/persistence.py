"""Two baselines: sun and shade stay as they are, and only the recent share in sun is known.

`persistence`: the probability decays exponentially from the current one to the prior
(`persistence_memory_s`), and is the prior beyond `persistence_horizon_s`. `climatology`: it is the
prior everywhere.
"""

import numpy as np

from recon.forecast.forecaster import Forecaster
from recon.forecast.settings import ForecastSettings
from recon.forecast.state import ForecastState, forecast_of, prior_sunlit, sunlit_now, with_map
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
    levels = np.rint(probability * SURE).astype(np.uint8)
    horizon_s = settings.persistence_horizon_s
    return forecast_of(shade, settings, prior, "persistence", levels, horizon_s)


def _climatology(state: ForecastState, settings: ForecastSettings) -> SunForecast:
    shade, prior = state.newest, prior_sunlit(state, settings)
    shape = len(settings.lead_s), *shade.valid.shape
    levels = np.full(shape, round(prior * SURE), dtype=np.uint8)
    return forecast_of(shade, settings, prior, "climatology", levels, 0.0)


PERSISTENCE = Forecaster(with_map, _persistence)
CLIMATOLOGY = Forecaster(with_map, _climatology)
