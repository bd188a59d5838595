"""Sun forecast: shade maps in, probability of sun by cell and lead time out.

A method is a pure function in a file of its own, chosen by name in `FORECASTERS`; adding one needs
that file, a line in the registry and a row in docs/detection-and-forecast.md. It returns a
`SunForecast` on the map's grid: the probability of sun per cell and lead, and each cell's horizon,
beyond which only the recent share in sun is known.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TypeAlias

from recon.forecast.global_shift import global_shift, moved_on
from recon.forecast.persistence import persistence
from recon.forecast.settings import ForecastSettings
from recon.forecast.state import ForecastState
from recon.model.shade import ShadeMap, SunForecast

__all__ = ["FORECASTERS", "ForecastSettings", "ForecastState", "Forecaster", "moved_on"]

Forecaster: TypeAlias = Callable[
    [ForecastState, ShadeMap, ForecastSettings], tuple[ForecastState, SunForecast]
]
"""One shade map: `(state, shade, settings) -> (state, forecast)`, starting from `ForecastState()`.

`shade` is (R, C); the forecast has (L, R, C) probabilities for the L leads of the settings, counted
from the map's capture time. Maps must come in the order they were taken; one that is not newer
raises `ValueError`. Pure: no clock, no random numbers, no files.
"""

FORECASTERS: Mapping[str, Forecaster] = MappingProxyType(
    {"global_shift": global_shift, "persistence": persistence}
)
"""The methods by name."""
