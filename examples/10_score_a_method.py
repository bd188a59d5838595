"""Score a forecast of one's own against the usual baselines, under simulated skies.

Run: uv run python examples/10_score_a_method.py

`recon score --forecast half_persistence` flies surveys with it: docs/how-to/bring-a-method.md.
"""

import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).parent / "own_method"))
from own_method import HALF_PERSISTENCE

from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.forecast.forecaster import Forecaster
from recon.model.shade import SUNLIT_TRANSMITTANCE, ShadeMap
from recon.model.units import seconds_to_ns
from recon.score import load_scenario
from recon.score.scenario_sky import sky_of

SCENARIO = Path(__file__).parents[1] / "scenarios/cumulus-40.toml"
METHODS: Mapping[str, Forecaster] = {
    "half_persistence": HALF_PERSISTENCE,
    "persistence": FORECASTERS["persistence"],
    "climatology": FORECASTERS["climatology"],
}
LEADS_S = (30.0, 60.0, 120.0)
SEEDS = (7, 10, 11)


def brier_scores(method: Forecaster, seed: int) -> list[float]:
    """Return the Brier score at each lead, of forecasts once a minute for five minutes."""
    scenario = load_scenario(SCENARIO)
    assert scenario.site.ground_grid is not None
    grid = replace(scenario.site.ground_grid, cell_m=8.0, rows=68, cols=68)
    sky, known = sky_of(scenario, seed), np.ones((grid.rows, grid.cols), dtype=np.bool_)
    settings, state, errors = ForecastSettings(lead_s=LEADS_S), ForecastState(), []
    for second in range(0, 301, 10):
        light, sure = sky.on_grid(grid, second).astype(np.float32), known.astype(np.float32)
        shade = ShadeMap(grid, seconds_to_ns(second), ("IMAGER",), light, known, sure, sure)
        state = method.observed(state, shade, settings)
        if second % 60 == 0:
            probability = method.forecast(state, settings).sun_probability / 255.0
            comes = [sky.on_grid(grid, second + lead) >= SUNLIT_TRANSMITTANCE for lead in LEADS_S]
            errors.append(((probability - np.array(comes)) ** 2).mean(axis=(1, 2)))
    return np.mean(errors, axis=0).tolist()


def main() -> None:
    """Print the mean Brier score of each method by lead; 0 is perfect."""
    print("method           " + "".join(f"{lead_s:8.0f} s" for lead_s in LEADS_S))
    for name, method in METHODS.items():
        mean = np.mean([brier_scores(method, seed) for seed in SEEDS], axis=0)
        print(f"{name:17}" + "".join(f"{score:10.3f}" for score in mean))


if __name__ == "__main__":
    main()
