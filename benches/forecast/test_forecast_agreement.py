"""Brier scores by lead on drawn shadows that drift, method beside method and beside a coin.

uv run python -m pytest benches/forecast/test_forecast_agreement.py -s
"""

import numpy as np
import pytest
from tests.detection.shaded_field import DriftingShade
from tests.forecast.moving_shade import SEEN, drawn_velocity, forecasts, is_sunlit, noisy_map

from recon.forecast import FORECASTERS, ForecastSettings

SEEDS = range(21_000, 21_016)
SETTINGS = ForecastSettings(lead_s=(0.0, 15.0, 30.0, 60.0, 120.0))


def test_brier_by_lead(capsys: pytest.CaptureFixture[str]) -> None:
    leads = len(SETTINGS.lead_s)
    scores = {(m, part): [[] for _ in range(leads)] for m in FORECASTERS for part in (0, 1)}
    horizon_share: list[list[float]] = [[] for _ in range(leads)]
    for seed in SEEDS:
        shade = DriftingShade(seed, cover=0.4, velocity_mps=drawn_velocity(seed))
        maps = [noisy_map(shade, 5.0 * i) for i in range(20)]
        issued = {method: forecasts(method, maps, SETTINGS)[-1] for method in FORECASTERS}
        for lead, lead_s in enumerate(SETTINGS.lead_s):
            truth = is_sunlit(shade, 95.0 + lead_s)
            near = SEEN & (issued["advection"].horizon_s >= lead_s)
            horizon_share[lead].append(near.sum() / SEEN.sum())
            for method, forecast in issued.items():
                wrong = (forecast.sun_probability[lead] / 255.0 - truth) ** 2
                for part, where in enumerate((near, SEEN)):
                    if where.any():
                        scores[method, part][lead].append(float(wrong[where].mean()))
    with capsys.disabled():
        print(f"\nBrier over {len(SEEDS)} seeds, 2 to 8 m/s; a coin has 0.25")
        for lead, lead_s in enumerate(SETTINGS.lead_s):
            summary = ", ".join(
                f"{method} {np.mean(scores[method, 0][lead]):.3f} in horizon "
                f"{np.mean(scores[method, 1][lead]):.3f} all"
                for method in FORECASTERS
            )
            print(f"  {lead_s:3.0f} s, {np.mean(horizon_share[lead]):4.0%} in horizon: {summary}")
    at_30 = {m: np.mean(scores[m, 0][2]) for m in FORECASTERS}
    assert at_30["advection"] < 0.5 * at_30["persistence"]
