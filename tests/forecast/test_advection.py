"""Advection: motion from all pairs together, and what the nearest seen shade shows elsewhere."""

from dataclasses import replace
from itertools import pairwise
from math import hypot
from pathlib import Path

import numpy as np
import pytest
from tests.detection.shaded_field import FIELD, DriftingShade, centres
from tests.forecast.moving_shade import SEEN, drawn_velocity, forecasts, noisy_map, shade_map

from recon.forecast import ForecastSettings, ForecastState
from recon.forecast.spatial_correlation import shade_scale_m, soft_edge_share, with_correlation
from recon.forecast.state import with_map
from recon.model.geo import GroundGrid
from recon.model.shade import SUNLIT_TRANSMITTANCE, ShadeMap
from recon.score import load_scenario
from recon.score.interval import log_ratio
from recon.score.scenario_sky import sky_of

SCENARIOS = Path(__file__).parents[2] / "scenarios"
LEADS_S = (15.0, 30.0, 60.0, 120.0, 300.0)
SETTINGS = ForecastSettings(lead_s=(0.0, *LEADS_S))
EAST_M, NORTH_M = centres(FIELD)


@pytest.mark.parametrize("seed", range(940, 946))
def test_the_motion_is_found_in_half_a_field(seed: int) -> None:
    velocity = drawn_velocity(seed, 3.0, 8.0)
    shade = DriftingShade(seed, cover=0.4, velocity_mps=velocity)
    half = SEEN & (EAST_M > 0.0)
    maps = [
        shade_map(shade.transmittance(FIELD, at_s), at_s, half)
        for at_s in np.arange(0.0, 60.0, 5.0)
    ]
    found = forecasts("advection", maps, SETTINGS)[-1].velocity_mps
    assert found is not None
    assert hypot(found[0] - velocity[0], found[1] - velocity[1]) < 0.7


def test_a_field_nearly_clear_is_enough() -> None:
    """One small shadow; each pair of maps alone is too faint."""
    maps = []
    for at_s in np.arange(0.0, 60.0, 5.0):
        spot = np.exp(-(np.hypot(EAST_M + 100.0 - 4.0 * at_s, NORTH_M - 30.0) ** 2) / 900.0)
        maps.append(shade_map(1.0 - 0.6 * spot, at_s))
    found = forecasts("advection", maps, SETTINGS)[-1].velocity_mps
    assert found == pytest.approx((4.0, 0.0), abs=0.4)


def test_without_contrast_no_motion_is_claimed() -> None:
    flat = np.ones(EAST_M.shape)
    rng = np.random.default_rng(5)
    maps = [shade_map(flat - rng.random(flat.shape) * 0.05, 5.0 * i) for i in range(15)]
    last = forecasts("advection", maps, SETTINGS)[-1]
    assert last.velocity_mps is None
    assert (last.horizon_s[SEEN] == 0.0).all()
    assert np.isnan(last.horizon_s[~SEEN]).all()
    # In sun, and less surely so with the lead.
    sunny = last.sun_probability[:, SEEN] / 255.0
    assert (np.diff(sunny.mean(axis=1)) < 0.0).all()
    assert sunny.min() > last.prior_sunlit


def with_standing_pattern(shade: np.ndarray | float, at_s: float, seed: int) -> ShadeMap:
    """The map of a detector through which the ground's pattern shows."""
    pattern = np.kron(np.random.default_rng(seed).normal(0.0, 0.06, (32, 32)), np.ones((4, 4)))
    noise = np.random.default_rng([seed, round(at_s)]).normal(0.0, 0.02, EAST_M.shape)
    return shade_map(np.clip(shade - 0.1 + pattern + noise, 0.0, 1.0), at_s)


@pytest.mark.parametrize("seed", range(950, 954))
def test_a_pattern_that_stands_still_is_no_motion(seed: int) -> None:
    """A clear sky: nothing that comes is in view, so nothing is predicted beyond the present."""
    times_s = np.arange(0.0, 90.0, 5.0)
    maps = [with_standing_pattern(1.0, at_s, seed) for at_s in times_s]
    last = forecasts("advection", maps, SETTINGS)[-1]
    assert last.velocity_mps is None
    assert (last.horizon_s[SEEN] == 0.0).all()


@pytest.mark.parametrize("seed", range(955, 959))
def test_moving_shade_is_followed_over_a_pattern_that_stands_still(seed: int) -> None:
    velocity = drawn_velocity(seed, 4.0, 9.0)
    shade = DriftingShade(seed, cover=0.4, velocity_mps=velocity)
    maps = [
        with_standing_pattern(shade.transmittance(FIELD, at_s), at_s, seed)
        for at_s in np.arange(0.0, 90.0, 5.0)
    ]
    found = forecasts("advection", maps, SETTINGS)[-1].velocity_mps
    assert found is not None
    assert hypot(found[0] - velocity[0], found[1] - velocity[1]) < 0.7


def test_unrelated_maps_have_no_motion() -> None:
    claimed = 0
    for seed in range(8):
        maps = [
            noisy_map(DriftingShade(100 * seed + i, cover=0.4, velocity_mps=(0.0, 0.0)), 5.0 * i)
            for i in range(15)
        ]
        claimed += forecasts("advection", maps, SETTINGS)[-1].velocity_mps is not None
    assert claimed <= 2


def test_what_lies_upwind_of_the_view_is_shown_by_its_rim() -> None:
    """Shadows come from the west, where the view's rim is in shade: so it stays for a while."""
    stripes = DriftingShade(947, cover=0.5, velocity_mps=(6.0, 0.0))
    maps = []
    for at_s in np.arange(0.0, 80.0, 5.0):
        west = -150.0 + 6.0 * (at_s - 75.0) > EAST_M
        maps.append(shade_map(np.where(west, 0.0, stripes.transmittance(FIELD, at_s)), at_s))
    last = forecasts("advection", maps, SETTINGS)[-1]
    assert last.velocity_mps == pytest.approx((6.0, 0.0), abs=0.6)
    rim = SEEN & (EAST_M < -150.0)
    chances = [float((level[rim] / 255.0).mean()) for level in last.sun_probability]
    assert chances[0] < 0.1
    assert all(one < other for one, other in pairwise(chances[1:]))
    assert chances[-1] < last.prior_sunlit


def kept_behind_an_edge(transmittance: float) -> float:
    """Of what the ground behind an edge that crosses the view from the west deviates from the
    prior: the share forecast five minutes later, by the usual scale."""
    settings, maps = replace(SETTINGS, usual_correlation_s=1e6), []
    for at_s in np.arange(0.0, 60.0, 5.0):
        is_behind = 6.0 * (at_s - 20.0) - 0.5 * np.abs(NORTH_M) > EAST_M
        maps.append(shade_map(np.where(is_behind, transmittance, 1.0 - transmittance), at_s))
    last = forecasts("advection", maps, settings)[-1]
    assert last.velocity_mps == pytest.approx((6.0, 0.0), abs=0.6)
    rim = SEEN & (EAST_M < -100.0)
    now, later = (float((last.sun_probability[k][rim] / 255.0).mean()) for k in (0, -1))
    return (later - last.prior_sunlit) / (now - last.prior_sunlit)


def test_shade_shows_less_of_what_is_far_upwind_than_sun_does() -> None:
    assert 0.1 < kept_behind_an_edge(0.0) < 0.6 * kept_behind_an_edge(1.0)


def true_maps(seed: int) -> tuple[list[ShadeMap], dict[float, np.ndarray]]:
    """Two minutes of perfect maps under a scenario's sky, and the truth at each lead after them."""
    scenario = load_scenario(SCENARIOS / "cumulus-40.toml")
    sky = sky_of(scenario, seed)
    grid = GroundGrid(scenario.frame, -256.0, 256.0, 8.0, 64, 64)
    east_m, north_m = centres(grid)
    seen = np.hypot(east_m, north_m) < 250.0
    times_s = np.arange(600.0, 720.0, 5.0)
    maps = [shade_map(sky.on_grid(grid, at_s), at_s, seen, 1.0, grid) for at_s in times_s]
    at_s = float(times_s[-1])
    return maps, {s: sky.on_grid(grid, at_s + s) >= SUNLIT_TRANSMITTANCE for s in LEADS_S}


@pytest.mark.flight
def test_it_is_better_than_every_baseline_under_drawn_skies() -> None:
    """Brier scores of paired seeds that nothing was tuned on; clear and overcast views too."""
    names = ("advection", "persistence", "climatology")
    found: dict[tuple[str, float], list[float]] = {}
    for seed in range(960, 984):
        maps, truth = true_maps(seed)
        for name in names:
            last = forecasts(name, maps, SETTINGS)[-1]
            for number, lead_s in enumerate(LEADS_S, start=1):
                wrong = (last.sun_probability[number] / 255.0 - truth[lead_s])[maps[-1].valid] ** 2
                found.setdefault((name, lead_s), []).append(float(wrong.mean()))
    for lead_s in LEADS_S:
        ours = found["advection", lead_s]
        for other in names[1:]:
            ratio = log_ratio(list(zip(ours, found[other, lead_s], strict=True)))
            assert ratio is not None
            assert ratio.mean < 1.0, (lead_s, other, ratio)
            if lead_s <= 60.0:
                assert ratio.high < 1.0, (lead_s, other, ratio)


def measured_scale_m(period_m: float) -> float:
    """Return the scale measured in ten minutes of bands of shade of a width that pass."""
    state = ForecastState()
    for at_s in np.arange(0.0, 600.0, 5.0):
        bands = (EAST_M - 7.0 * at_s) % period_m < period_m / 2.0
        maps = shade_map(np.where(bands, 0.0, 1.0), at_s)
        state = with_correlation(with_map(state, maps, SETTINGS), maps, SETTINGS)
    return shade_scale_m(state, SETTINGS)


def test_the_scale_is_measured_in_flight() -> None:
    usual_m = shade_scale_m(ForecastState(), SETTINGS)
    assert usual_m == pytest.approx(SETTINGS.shade_scale_m)
    assert measured_scale_m(300.0) < 0.3 * usual_m
    assert measured_scale_m(300.0) < measured_scale_m(1_500.0) < measured_scale_m(6_000.0)
    assert measured_scale_m(6_000.0) > 0.8 * usual_m


def test_a_clear_sky_does_not_change_the_usual_scale_much() -> None:
    state = ForecastState()
    for at_s in np.arange(0.0, 120.0, 5.0):
        clear = shade_map(np.ones(EAST_M.shape), at_s)
        state = with_correlation(with_map(state, clear, SETTINGS), clear, SETTINGS)
    usual_m = shade_scale_m(ForecastState(), SETTINGS)
    assert usual_m <= shade_scale_m(state, SETTINGS) < 3.0 * usual_m
    nothing = shade_map(np.ones(EAST_M.shape), 200.0, np.zeros(EAST_M.shape, dtype=np.bool_))
    after = with_correlation(with_map(state, nothing, SETTINGS), nothing, SETTINGS)
    assert after.correlation is not None
    assert state.correlation is not None
    assert after.correlation.variance_s < state.correlation.variance_s


def after_a_map(transmittance: np.ndarray) -> float:
    """The chance of sun in the middle of a view, two minutes after its first map."""
    (found,) = forecasts("advection", [shade_map(transmittance, 0.0)], SETTINGS)
    middle = np.unravel_index(np.argmin(np.hypot(EAST_M, NORTH_M)), EAST_M.shape)
    return float(found.sun_probability[SETTINGS.lead_s.index(120.0)][middle]) / 255.0


def test_under_thin_even_cloud_what_is_in_sun_stays_so() -> None:
    """Either middle lies in sun by as little; one near an edge, one where all is the same."""
    even = np.full(EAST_M.shape, 0.58)
    edge = np.clip(0.58 + EAST_M / 400.0, 0.0, 1.0)
    assert 0.5 < after_a_map(edge) < 0.57
    assert after_a_map(even) > 0.62
    shaded = np.full(EAST_M.shape, 0.42)
    assert after_a_map(shaded) < 0.42


def test_edges_are_as_soft_as_usual_under_broken_cloud() -> None:
    shares = []
    for seed in range(960, 976):
        state = ForecastState()
        for each in true_maps(seed)[0]:
            state = with_correlation(with_map(state, each, SETTINGS), each, SETTINGS)
        shares.append(soft_edge_share(state, SETTINGS))
    assert soft_edge_share(ForecastState(), SETTINGS) == pytest.approx(1.0)
    assert 0.8 < np.mean(shares) < 1.5
    assert max(shares) < 3.0
