"""Speed of one shade map's forecast, beside plain numpy shifts; the bound asserted.

uv run python -m pytest benches/forecast -s
"""

from dataclasses import replace
from time import process_time

import cv2
import numpy as np
import pytest
from tests.detection.shaded_field import FIELD, DriftingShade
from tests.forecast.moving_shade import noisy_map, shade_map, step

from recon.forecast import FORECASTERS, ForecastSettings, ForecastState, next_change
from recon.forecast.next_change import MEMBERS
from recon.model.shade import SunForecast

MOST_MS = 30.0


@pytest.mark.parametrize("speed_mps", [1.0, 8.0])
@pytest.mark.parametrize("method", sorted(FORECASTERS))
def test_a_map_of_128_by_128_takes_under_30_ms(
    method: str, speed_mps: float, capsys: pytest.CaptureFixture[str]
) -> None:
    """512 m in cells of 4 m, 21 leads; every map is compared with three others."""
    cv2.setNumThreads(1)
    shade = DriftingShade(2, cover=0.4, velocity_mps=(speed_mps, 0.0))
    maps = [noisy_map(shade, 5.0 * i) for i in range(40)]
    settings, state = ForecastSettings(), ForecastState()
    taken_ms, naive_ms = [], []
    for one in maps:
        start = process_time()
        state, _ = step(method, state, one, settings)
        taken_ms.append((process_time() - start) * 1e3)
        start = process_time()
        for lead_s in settings.lead_s:
            np.roll(one.transmittance, round(lead_s * speed_mps / FIELD.cell_m), axis=1)
        naive_ms.append((process_time() - start) * 1e3)
    full_ms = np.array(taken_ms[15:])
    with capsys.disabled():
        print(
            f"\n{method} at {speed_mps:g} m/s, 128x128 map, {len(settings.lead_s)} leads: "
            f"{np.median(full_ms):.2f} ms (worst of {len(full_ms)} {full_ms.max():.2f}); "
            f"{np.median(full_ms) / np.median(naive_ms):.1f}x one np.roll a lead "
            f"({np.median(naive_ms):.2f} ms)",
            flush=True,
        )
    assert np.median(full_ms) < MOST_MS


def test_the_next_change_of_150_by_150_cells(capsys: pytest.CaptureFixture[str]) -> None:
    """By all members, with the whole map in view for two minutes."""
    cv2.setNumThreads(1)
    cells_m = 150 * FIELD.cell_m
    grid = replace(FIELD, west_m=-cells_m / 2, north_m=cells_m / 2, rows=150, cols=150)
    shade = DriftingShade(2, cover=0.4, velocity_mps=(5.0, 0.0))
    seen = np.ones((150, 150), np.bool_)
    one = shade_map(shade.transmittance(grid, 0.0), 0.0, seen, grid=grid)
    level, horizon_s = np.zeros((1, 150, 150), np.uint8), np.full((150, 150), 120.0, np.float32)
    sun = SunForecast(grid, 0, np.zeros(1), level, horizon_s, 0.5, "drawn", velocity_mps=(5.0, 0.0))
    cells = np.argwhere(seen)
    taken_s = []
    for _ in range(5):
        start = process_time()
        change = next_change(one, sun, cells, ForecastSettings())
        taken_s.append(process_time() - start)
    with capsys.disabled():
        print(f"\nnext change, {MEMBERS} members, 150x150 cells, 120 s: {np.median(taken_s):.2f} s")
    assert change.is_predicted.any()
