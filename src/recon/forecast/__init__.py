"""Sun forecast: shade maps in, probability of sun by cell and lead time out.

A method is a file of its own, chosen by name in `FORECASTERS`; adding one needs that file, a line
in the registry and a row in docs/detection-and-forecast.md. Installed packages add theirs as entry
points (docs/how-to/bring-a-method.md). Its `SunForecast` is on the map's grid:
the probability of sun per cell and lead, and each cell's horizon, up to which the clouds that will
shade it are in view now.
"""

from recon.forecast.advection import ADVECTION
from recon.forecast.forecaster import Forecaster
from recon.forecast.hindcast import right_shares
from recon.forecast.moved_on import moved_on
from recon.forecast.next_change import NextChange, next_change
from recon.forecast.persistence import CLIMATOLOGY, PERSISTENCE
from recon.forecast.settings import ForecastSettings
from recon.forecast.state import ForecastState
from recon.model.methods import MethodRegistry

FORECASTERS: MethodRegistry[Forecaster] = MethodRegistry(
    "recon.forecasters",
    {
        "advection": ADVECTION,
        "persistence": PERSISTENCE,
        "climatology": CLIMATOLOGY,
    },
    lambda method: isinstance(method, Forecaster),
)
"""The methods by name."""
