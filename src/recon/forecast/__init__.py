"""Where the ground will lie in sun: shade maps in, probabilities by lead out.

A method is a pure function of one file, chosen by its name in `FORECASTERS`. Its answer is a
`SunForecast` on the map's grid: for each cell and lead how likely sun is, and the horizon beyond
which it knows nothing but the share in sun of late.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TypeAlias

from recon.forecast.global_shift import global_shift
from recon.forecast.persistence import persistence
from recon.forecast.settings import ForecastSettings
from recon.forecast.state import ForecastState
from recon.model.shade import ShadeMap, SunForecast

__all__ = ["FORECASTERS", "ForecastSettings", "ForecastState", "Forecaster"]

Forecaster: TypeAlias = Callable[
    [ForecastState, ShadeMap, ForecastSettings], tuple[ForecastState, SunForecast]
]
"""One shade map: `(state, shade, settings) -> (state, forecast)`, beginning with `ForecastState()`.

Maps come in the order they were taken; one that is not newer raises `ValueError`. Leads count from
the moment the map was taken.
"""

FORECASTERS: Mapping[str, Forecaster] = MappingProxyType(
    {"global_shift": global_shift, "persistence": persistence}
)
"""The methods by name."""
