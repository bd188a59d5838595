"""A sun forecast of one's own: the mean of persistence and climatology.

Install it beside Recon with `pip install examples/own_method`; then `recon methods` lists it.
"""

from dataclasses import replace

import numpy as np

from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.forecast.forecaster import Forecaster
from recon.model.shade import SunForecast


def forecast(state: ForecastState, settings: ForecastSettings) -> SunForecast:
    """Return the probability of sun from the newest map, for each lead of the settings."""
    now = FORECASTERS["persistence"].forecast(state, settings)
    usual = FORECASTERS["climatology"].forecast(state, settings)
    mean = (now.sun_probability.astype(np.uint16) + usual.sun_probability) // 2
    return replace(now, sun_probability=mean.astype(np.uint8), method="half_persistence")


HALF_PERSISTENCE = Forecaster(FORECASTERS["persistence"].observed, forecast)
