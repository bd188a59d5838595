"""What holds of every method, on maps of any content."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.detection.shaded_field import FIELD, DriftingShade
from tests.forecast.moving_shade import SEEN, forecasts, noisy_map, shade_map

from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.geo import GroundGrid
from recon.model.shade import ShadeMap, SunForecast

GRID = GroundGrid(FIELD.frame, 0.0, 0.0, 8.0, 20, 24)
SETTINGS = ForecastSettings(lead_s=(0.0, 20.0, 60.0, 400.0))

methods = pytest.mark.parametrize("method", sorted(FORECASTERS))


def drawn_maps(seed: int) -> list[ShadeMap]:
    """Any transmittance and confidence, any cells seen, at any moments in order."""
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


def check(told: SunForecast, shade: ShadeMap) -> None:
    leads = len(SETTINGS.lead_s)
    assert told.grid == shade.grid
    assert told.issued_at_ns == shade.captured_at_ns
    assert tuple(told.lead_s) == SETTINGS.lead_s
    assert told.sun_probability.shape == (leads, GRID.rows, GRID.cols)
    assert told.sun_probability.dtype == np.uint8
    assert told.horizon_s.dtype == np.float32
    assert 0.0 < told.prior_sunlit < 1.0
    assert (told.horizon_s >= 0.0).all()
    assert (told.horizon_s[~shade.valid] == 0.0).all()
    unknown = told.horizon_s[np.newaxis] < told.lead_s[:, np.newaxis, np.newaxis]
    unknown |= ~shade.valid
    assert (told.sun_probability[unknown] == round(told.prior_sunlit * 255.0)).all()


@methods
@settings(max_examples=30)
@given(seed=st.integers(0, 2**32))
def test_whatever_comes_forecasts_are_sound_and_runs_are_repeatable(method: str, seed: int) -> None:
    one, other = (forecasts(method, drawn_maps(seed), SETTINGS) for _ in range(2))
    for told, again, shade in zip(one, other, drawn_maps(seed), strict=True):
        check(told, shade)
        assert np.array_equal(told.sun_probability, again.sun_probability)
        assert np.array_equal(told.horizon_s, again.horizon_s)
        assert (told.method, told.velocity_mps) == (again.method, again.velocity_mps)


@methods
def test_a_map_that_is_not_newer_is_an_error(method: str) -> None:
    step = FORECASTERS[method]
    state, _ = step(ForecastState(), noisy_map(DriftingShade(1), 10.0), SETTINGS)
    for at_s in (10.0, 9.0):
        with pytest.raises(ValueError, match="expected a newer shade map"):
            step(state, noisy_map(DriftingShade(1), at_s), SETTINGS)


@methods
def test_now_is_what_the_map_says_where_it_is_sure(method: str) -> None:
    maps = [noisy_map(DriftingShade(2, cover=0.4), 5.0 * i) for i in range(12)]
    told = forecasts(method, maps, SETTINGS)[-1]
    is_likely = told.sun_probability[0] > 127
    assert np.mean(is_likely[SEEN] == maps[-1].is_sunlit[SEEN]) > 0.95


@methods
def test_the_less_sure_the_map_the_nearer_to_the_prior(method: str) -> None:
    direct = DriftingShade(3, cover=0.4).transmittance(FIELD, 0.0)
    far = []
    for confidence in (0.0, 0.3, 0.9):
        (told,) = forecasts(method, [shade_map(direct, 0.0, SEEN, confidence)], SETTINGS)
        far.append(float(np.abs(told.sun_probability[0] / 255.0 - told.prior_sunlit)[SEEN].mean()))
    assert far[0] < 0.003
    assert far[0] < far[1] < far[2]


@methods
def test_the_prior_is_the_share_in_sun_of_late(method: str) -> None:
    state, settings_ = ForecastState(), ForecastSettings(lead_s=(0.0,))
    sunny = np.arange(GRID.cols) < 18
    direct = np.broadcast_to(sunny, (GRID.rows, GRID.cols)).astype(float)
    priors = []
    for i in range(240):
        seen = np.ones(direct.shape, bool)
        state, told = FORECASTERS[method](
            state, shade_map(direct, 5.0 * i, seen, 0.9, GRID), settings_
        )
        priors.append(told.prior_sunlit)
    assert priors[0] == pytest.approx(0.5)
    assert priors[-1] == pytest.approx(0.75, abs=0.04)
    assert all(one <= other + 1e-9 for one, other in pairwise(priors))


@methods
def test_memory_is_bounded(method: str) -> None:
    state, shade = ForecastState(), DriftingShade(4, cover=0.4)
    for i in range(150):
        state, _ = FORECASTERS[method](state, noisy_map(shade, 2.0 * i), SETTINGS)
        assert len(state.kept) <= 10
        assert len(state.velocities) <= 3 * 13


def test_persistence_forgets_at_the_pace_of_its_settings() -> None:
    settings_ = ForecastSettings(lead_s=(0.0, 150.0, 300.0, 301.0), persistence_memory_s=150.0)
    direct = np.where(np.arange(GRID.cols) < 12, 1.0, 0.0) * np.ones((GRID.rows, 1))
    seen = np.ones(direct.shape, bool)
    (told,) = forecasts("persistence", [shade_map(direct, 0.0, seen, 1.0, GRID)], settings_)
    sunny = told.sun_probability[:, 0, 0] / 255.0
    surest = settings_.surest
    expected = [0.5 + (surest - 0.5) * left for left in (1.0, np.exp(-1.0), np.exp(-2.0), 0.0)]
    assert sunny == pytest.approx(expected, abs=0.003)
    assert (told.horizon_s == 300.0).all()
