"""Forecast the sun: from shade maps to the velocity of the shadows and the light to come.

Run: uv run python examples/08_forecast_the_sun.py
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.shade import SUNLIT_TRANSMITTANCE, ShadeMap
from recon.model.units import seconds_to_ns
from recon.score import load_scenario
from recon.score.scenario_sky import sky_of

SCENARIO = Path(__file__).parents[1] / "scenarios/cumulus-40.toml"
LEAD_S = 30.0


def main() -> None:
    """Observe two minutes of shade maps, and compare a forecast with the sky half a minute on."""
    scenario = load_scenario(SCENARIO)
    assert scenario.site.ground_grid is not None
    grid = replace(scenario.site.ground_grid, cell_m=4.0, rows=136, cols=136)
    sky = sky_of(scenario, seed=7)
    known = np.ones((grid.rows, grid.cols), dtype=np.bool_)

    forecaster, settings = FORECASTERS["advection"], ForecastSettings()
    state = ForecastState()
    for second in range(0, 126, 5):
        light, sure = sky.on_grid(grid, second).astype(np.float32), known.astype(np.float32)
        shade = ShadeMap(grid, seconds_to_ns(second), ("IMAGER",), light, known, sure, sure)
        state = forecaster.observed(state, shade, settings)
    sun = forecaster.forecast(state, settings)
    if sun.velocity_mps is not None:
        east_mps, north_mps = sun.velocity_mps
        print(f"shadows move {east_mps:.1f} m/s east, {north_mps:.1f} m/s north")

    probability = sun.sun_probability[sun.lead_s.tolist().index(LEAD_S)] / 255.0
    comes = sky.on_grid(grid, second + LEAD_S) >= SUNLIT_TRANSMITTANCE
    stays = light >= SUNLIT_TRANSMITTANCE
    brier, unchanged = ((probability - comes) ** 2).mean(), (stays ^ comes).mean()
    print(f"in {LEAD_S:g} s: Brier score {brier:.3f}, if nothing changed {unchanged:.3f}")


if __name__ == "__main__":
    main()
