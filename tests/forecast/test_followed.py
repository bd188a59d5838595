"""Shade that has left the view: where it is by now, for how long, and how surely."""

from dataclasses import replace
from math import hypot

import numpy as np
import pytest
from tests.detection.shaded_field import FIELD, DriftingShade, centres
from tests.forecast.moving_shade import SEEN, drawn_velocity, shade_map, step

from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.geo import GroundGrid
from recon.model.shade import SUNLIT_TRANSMITTANCE, ShadeMap

SETTINGS = ForecastSettings(lead_s=(0.0, 15.0, 30.0))
EAST_M, NORTH_M = centres(FIELD)


def after(maps: list[ShadeMap], method: str = "advection") -> ForecastState:
    state = ForecastState()
    for one in maps:
        state, _sun = FORECASTERS[method].after(state, one, SETTINGS, one.valid)
    return state


def followed(maps: list[ShadeMap]) -> ShadeMap:
    found = after(maps).followed
    assert found is not None
    return found


def upwind_half(velocity: tuple[float, float]) -> np.ndarray:
    return SEEN & (EAST_M * velocity[0] + NORTH_M * velocity[1] < 0.0)


@pytest.mark.parametrize("seed", range(920, 926))
def test_the_half_downwind_is_right_though_only_the_other_is_seen(seed: int) -> None:
    velocity = drawn_velocity(seed, 4.0, 8.0)
    shade = DriftingShade(seed, cover=0.4, velocity_mps=velocity)
    half = upwind_half(velocity)
    maps = [
        shade_map(shade.transmittance(FIELD, at_s), at_s, half)
        for at_s in np.arange(0.0, 90.0, 2.5)
    ]
    found = followed(maps)
    added = found.valid & ~half
    assert added.sum() > 0.6 * half.sum()
    truth = shade.transmittance(FIELD, maps[-1].captured_at_ns / 1e9) >= SUNLIT_TRANSMITTANCE
    assert (found.is_sunlit == truth)[added].mean() > 0.85


def test_what_is_in_view_stays_as_it_was_seen() -> None:
    shade = DriftingShade(930, cover=0.4, velocity_mps=(6.0, 0.0))
    half = upwind_half((6.0, 0.0))
    maps = [shade_map(shade.transmittance(FIELD, t), t, half) for t in np.arange(0.0, 60.0, 5.0)]
    found, newest = followed(maps), maps[-1]
    for name in ("transmittance", "confidence", "metres_per_pixel"):
        assert (getattr(found, name)[half] == getattr(newest, name)[half]).all()
    assert not newest.valid[~half].any(), "the map itself is not written to"


def test_confidence_falls_the_longer_ago_it_was_seen_and_then_it_is_unknown() -> None:
    """What is farthest downwind was seen longest ago."""
    shade = DriftingShade(931, cover=0.4, velocity_mps=(4.0, 0.0))
    west = SEEN & (EAST_M < -60.0)
    maps = [shade_map(shade.transmittance(FIELD, t), t, west) for t in np.arange(0.0, 180.0, 5.0)]
    found = followed(maps)
    row = FIELD.rows // 2
    sure = found.confidence[row][found.valid[row]]
    assert (np.diff(sure) <= 0.0).all()
    assert sure[-1] < sure[0]
    reach_m = float(EAST_M[row][found.valid[row]].max()) + 60.0
    assert reach_m == pytest.approx(4.0 * SETTINGS.followed_for_s, rel=0.15)


def test_what_is_in_view_and_unknown_stays_unknown() -> None:
    shade = DriftingShade(936, cover=0.4, velocity_mps=(6.0, 0.0))
    half = upwind_half((6.0, 0.0))
    maps = [shade_map(shade.transmittance(FIELD, t), t, half) for t in np.arange(0.0, 60.0, 5.0)]
    state = after(maps)
    gap = half & (np.abs(NORTH_M) < 40.0)
    one = shade_map(shade.transmittance(FIELD, 60.0), 60.0, half & ~gap)
    later, _sun = FORECASTERS["advection"].after(state, one, SETTINGS, half)
    assert later.followed is not None
    assert not later.followed.valid[gap].any()
    assert later.followed.valid[~half].any()
    unsaid, _sun = step("advection", state, one, SETTINGS)
    assert unsaid.followed is one


def test_without_a_motion_nothing_is_followed() -> None:
    half = SEEN & (EAST_M < 0.0)
    maps = [shade_map(np.ones(EAST_M.shape), 5.0 * i, half) for i in range(10)]
    assert (followed(maps).valid == half).all()


def test_another_method_follows_none_and_another_grid_starts_anew() -> None:
    shade = DriftingShade(932, cover=0.4, velocity_mps=(6.0, 0.0))
    half = upwind_half((6.0, 0.0))
    maps = [shade_map(shade.transmittance(FIELD, t), t, half) for t in np.arange(0.0, 60.0, 5.0)]
    state = after(maps)
    coarse = GroundGrid(FIELD.frame, FIELD.west_m, FIELD.north_m, 8.0, 64, 64)
    seen = np.hypot(*centres(coarse)) < 100.0
    one = shade_map(shade.transmittance(coarse, 60.0), 60.0, seen, grid=coarse)
    later, _sun = FORECASTERS["advection"].after(state, one, SETTINGS, one.valid)
    assert later.followed is not None
    assert (later.followed.valid == seen).all()
    other, _sun = step("persistence", state, replace(maps[-1], captured_at_ns=10**12), SETTINGS)
    assert other.followed is None


def test_the_motion_is_not_measured_in_followed_shade() -> None:
    """The wind turns: shade followed by the old motion must not hold the new one back."""
    east = DriftingShade(933, cover=0.4, velocity_mps=(6.0, 0.0))
    north = DriftingShade(934, cover=0.4, velocity_mps=(0.0, 6.0))
    half = SEEN & (EAST_M < 0.0)
    maps = [
        shade_map((east if t < 90.0 else north).transmittance(FIELD, t), t, half)
        for t in np.arange(0.0, 210.0, 5.0)
    ]
    state = after(maps)
    found = FORECASTERS["advection"].forecast(state, SETTINGS).velocity_mps
    assert found is not None
    assert hypot(found[0], found[1] - 6.0) < 0.8


def test_the_forecast_sees_farther_with_it() -> None:
    """Cells out of view, whose clouds passed through it, get a horizon and a better forecast."""
    shade = DriftingShade(935, cover=0.4, velocity_mps=(6.0, 0.0))
    half = upwind_half((6.0, 0.0))
    maps = [shade_map(shade.transmittance(FIELD, t), t, half) for t in np.arange(0.0, 90.0, 5.0)]
    last = FORECASTERS["advection"].forecast(after(maps), SETTINGS)
    downwind = SEEN & ~half & (EAST_M < 150.0)
    assert np.isfinite(last.horizon_s[downwind]).mean() > 0.9
    truth = shade.transmittance(FIELD, 85.0 + 15.0) >= SUNLIT_TRANSMITTANCE
    brier = ((last.sun_probability[1] / 255.0 - truth) ** 2)[downwind].mean()
    assert brier < 0.15
