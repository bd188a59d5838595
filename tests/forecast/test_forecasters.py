"""Properties of every method in `FORECASTERS`, on maps of any content."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.detection.shaded_field import FIELD, DriftingShade
from tests.examples import examples
from tests.forecast.moving_shade import SEEN, forecasts, noisy_map, shade_map, step

from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.geo import GroundGrid
from recon.model.shade import ShadeMap, SunForecast

GRID = GroundGrid(FIELD.frame, 0.0, 0.0, 8.0, 20, 24)
SETTINGS = ForecastSettings(lead_s=(0.0, 20.0, 60.0, 400.0))

methods = pytest.mark.parametrize("method", sorted(FORECASTERS))
methods_of_cells = pytest.mark.parametrize("method", sorted(set(FORECASTERS) - {"climatology"}))
"""Climatology is the same for all cells."""


def drawn_maps(seed: int) -> list[ShadeMap]:
    """Return maps of any transmittance, confidence and visible cells, in order of time."""
    rng = np.random.default_rng(seed)
    at_s, maps = 0.0, []
    moves = rng.integers(-2, 3, 2)
    direct = rng.random((GRID.rows, GRID.cols))
    for _ in range(14):
        at_s += float(rng.choice([0.2, 4.0, 5.0, 90.0]))
        direct = np.roll(direct, moves, (0, 1)) if rng.random() < 0.8 else rng.random(direct.shape)
        seen = rng.random(direct.shape) < rng.choice([0.0, 0.6, 1.0])
        maps.append(shade_map(direct, at_s, seen, float(rng.random()), GRID))
    return maps


def check(forecast: SunForecast, shade: ShadeMap) -> None:
    leads = len(SETTINGS.lead_s)
    assert forecast.grid == shade.grid
    assert forecast.issued_at_ns == shade.captured_at_ns
    assert tuple(forecast.lead_s) == SETTINGS.lead_s
    assert forecast.sun_probability.shape == (leads, GRID.rows, GRID.cols)
    assert forecast.sun_probability.dtype == np.uint8
    assert forecast.horizon_s.dtype == np.float32
    assert 0.0 < forecast.prior_sunlit < 1.0
    assert (forecast.horizon_s[shade.valid] >= 0.0).all()
    assert np.isnan(forecast.horizon_s[~shade.valid]).all()
    if forecast.method != "advection":
        known = forecast.horizon_s[np.newaxis] >= forecast.lead_s[:, np.newaxis, np.newaxis]
        unknown = ~known
        assert (forecast.sun_probability[unknown] == round(forecast.prior_sunlit * 255.0)).all()


@methods
@settings(max_examples=examples(30))
@given(seed=st.integers(0, 2**32))
def test_any_maps_give_sound_and_repeatable_forecasts(method: str, seed: int) -> None:
    one, other = (forecasts(method, drawn_maps(seed), SETTINGS) for _ in range(2))
    for forecast, again, shade in zip(one, other, drawn_maps(seed), strict=True):
        check(forecast, shade)
        assert np.array_equal(forecast.sun_probability, again.sun_probability)
        assert np.array_equal(forecast.horizon_s, again.horizon_s, equal_nan=True)
        assert (forecast.method, forecast.velocity_mps) == (again.method, again.velocity_mps)


@methods
def test_a_map_that_is_not_newer_is_an_error(method: str) -> None:
    state, _ = step(method, ForecastState(), noisy_map(DriftingShade(1), 10.0), SETTINGS)
    for at_s in (10.0, 9.0):
        with pytest.raises(ValueError, match="expected a newer shade map"):
            step(method, state, noisy_map(DriftingShade(1), at_s), SETTINGS)


@methods_of_cells
def test_lead_0_is_the_map_where_its_confidence_is_high(method: str) -> None:
    maps = [noisy_map(DriftingShade(2, cover=0.4), 5.0 * i) for i in range(12)]
    forecast = forecasts(method, maps, SETTINGS)[-1]
    is_likely = forecast.sun_probability[0] > 127
    assert np.mean(is_likely[SEEN] == maps[-1].is_sunlit[SEEN]) > 0.95


@methods_of_cells
def test_low_confidence_is_nearer_to_the_prior(method: str) -> None:
    direct = DriftingShade(3, cover=0.4).transmittance(FIELD, 0.0)
    far = []
    for confidence in (0.0, 0.3, 0.9):
        (forecast,) = forecasts(method, [shade_map(direct, 0.0, SEEN, confidence)], SETTINGS)
        far.append(
            float(np.abs(forecast.sun_probability[0] / 255.0 - forecast.prior_sunlit)[SEEN].mean())
        )
    assert far[0] < 0.003
    assert far[0] < far[1] < far[2]


@methods
def test_the_prior_is_the_recent_share_in_sun(method: str) -> None:
    state, settings_ = ForecastState(), ForecastSettings(lead_s=(0.0,))
    sunny = np.arange(GRID.cols) < 18
    direct = np.broadcast_to(sunny, (GRID.rows, GRID.cols)).astype(float)
    priors = []
    for i in range(240):
        seen = np.ones(direct.shape, bool)
        state, forecast = step(
            method, state, shade_map(direct, 5.0 * i, seen, 0.9, GRID), settings_
        )
        priors.append(forecast.prior_sunlit)
    assert priors[0] == pytest.approx(0.5)
    assert priors[-1] == pytest.approx(0.75, abs=0.04)
    assert all(one <= other + 1e-9 for one, other in pairwise(priors))


@methods
def test_memory_is_bounded(method: str) -> None:
    state, shade = ForecastState(), DriftingShade(4, cover=0.4)
    for i in range(150):
        state, _ = step(method, state, noisy_map(shade, 2.0 * i), SETTINGS)
        assert len(state.kept) <= 10


def test_persistence_decays_with_its_time_constant() -> None:
    settings_ = ForecastSettings(lead_s=(0.0, 150.0, 300.0, 301.0), persistence_memory_s=150.0)
    direct = np.where(np.arange(GRID.cols) < 12, 1.0, 0.0) * np.ones((GRID.rows, 1))
    seen = np.ones(direct.shape, bool)
    (forecast,) = forecasts("persistence", [shade_map(direct, 0.0, seen, 1.0, GRID)], settings_)
    sunny = forecast.sun_probability[:, 0, 0] / 255.0
    surest = settings_.surest
    expected = [0.5 + (surest - 0.5) * left for left in (1.0, np.exp(-1.0), np.exp(-2.0), 0.0)]
    assert sunny == pytest.approx(expected, abs=0.003)
    assert (forecast.horizon_s == 300.0).all()
