"""What a forecast method is: two pure functions, one per map and one per forecast."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from recon.forecast.hindcast import with_hindcast
from recon.forecast.settings import ForecastSettings
from recon.forecast.state import ForecastState
from recon.model.shade import MaskMap, ShadeMap, SunForecast


@dataclass(frozen=True, slots=True)
class Forecaster:
    """A method. Pure: no clock, no unseeded random numbers, no files.

    Every map is observed; a forecast is made when one is wanted, of the newest map.
    """

    observed: Callable[[ForecastState, ShadeMap, ForecastSettings], ForecastState]
    """The state after a map (R, C), starting from `ForecastState()`. Raises `ValueError` for a map
    that is not newer than the one before."""
    forecast: Callable[[ForecastState, ForecastSettings], SunForecast]
    """Returns the forecast from the newest map: (L, R, C) probabilities for the L leads of the
    settings, counted from its capture time. Raises `ValueError` before the first map."""

    def after(
        self,
        state: ForecastState,
        shade: ShadeMap,
        settings: ForecastSettings,
        in_view: MaskMap | None = None,
    ) -> tuple[ForecastState, SunForecast]:
        """Return the state after a map, and the forecast from it; earlier ones are compared with
        the map.

        `in_view` (R, C) are the cells that the map's frames show: shade may be followed beyond
        them. Without it none is. Raises `ValueError` as `observed` does.
        """
        state, _ = self.without_forecast(state, shade, settings, in_view)
        sun = self.forecast(state, settings)
        return with_hindcast(state, sun, settings), sun

    def without_forecast(
        self,
        state: ForecastState,
        shade: ShadeMap,
        settings: ForecastSettings,
        in_view: MaskMap | None = None,
    ) -> tuple[ForecastState, None]:
        """Return the state after a map as `after` does, with no forecast made or compared."""
        return self.observed(replace(state, in_view=in_view), shade, settings), None
