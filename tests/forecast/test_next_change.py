"""Time to shade and time to sun: known shadows with a known motion, and what is not known."""

import numpy as np
import pytest
from tests.detection.shaded_field import FIELD, DriftingShade
from tests.forecast.moving_shade import SEEN, is_sunlit, shade_map

from recon.forecast import (
    FORECASTERS,
    ForecastSettings,
    ForecastState,
    NextChange,
    next_change,
)
from recon.forecast.next_change import MEMBERS, STEP_S
from recon.model.shade import ShadeMap, SunForecast

SETTINGS = ForecastSettings()
SPEED_MPS = 6.0
"""Eastward."""

ROWS, COLS = np.nonzero(SEEN)
CELLS = np.stack([ROWS, COLS], axis=1)
EAST_M = (COLS - FIELD.cols // 2) * FIELD.cell_m


def band(west_m: float, east_m: float, at_s: float = 0.0) -> ShadeMap:
    """Shade between two eastings, sun on both sides."""
    east = (np.arange(FIELD.cols) - FIELD.cols // 2) * FIELD.cell_m - SPEED_MPS * at_s
    direct = np.where((east >= west_m) & (east <= east_m), 0.0, 1.0)
    return shade_map(np.broadcast_to(direct, (FIELD.rows, FIELD.cols)), at_s)


def forecast(shade: ShadeMap, velocity_mps: tuple[float, float] | None) -> SunForecast:
    horizon_s = np.where(shade.valid, np.float32(60.0), np.float32(np.nan))
    level = np.zeros((1, FIELD.rows, FIELD.cols), np.uint8)
    return SunForecast(
        FIELD, 0, np.zeros(1), level, horizon_s, 0.5, "drawn", velocity_mps=velocity_mps
    )


def found(shade: ShadeMap, velocity_mps: tuple[float, float] | None) -> NextChange:
    return next_change(shade, forecast(shade, velocity_mps), CELLS, SETTINGS)


def test_shade_comes_when_its_edge_has_moved_so_far_and_sun_when_it_has_passed() -> None:
    change = found(band(-120.0, -60.0), (SPEED_MPS, 0.0))
    assert (change.is_sunlit == ((EAST_M < -120.0) | (EAST_M > -60.0))).all()
    ahead_m = np.where(change.is_sunlit, EAST_M + 60.0, EAST_M + 120.0)
    true_s = ahead_m / SPEED_MPS
    coming = (EAST_M > -120.0) & (true_s < 55.0)
    assert change.is_predicted[coming].all()
    assert np.abs(change.after_s - true_s)[coming].max() <= 1.5 * STEP_S
    assert (change.early_s <= change.after_s)[coming].all()
    assert (change.after_s <= change.late_s)[coming].all()
    # West of the shade nothing but sun comes, and what is farther off comes later than is seen.
    never = (EAST_M < -130.0) | (ahead_m / (SPEED_MPS + 1.0) > 60.0)
    assert (change.chance[never] == 0.0).all()
    assert np.isnan(change.after_s[never]).all()


def test_the_farther_off_an_edge_is_the_wider_is_its_time() -> None:
    change = found(band(-120.0, -60.0), (SPEED_MPS, 0.0))
    width_s = change.late_s - change.early_s
    near, far = ((m < EAST_M + 60.0) & (m + 40.0 > EAST_M + 60.0) for m in (20.0, 200.0))
    assert width_s[near].mean() < width_s[far].mean()


def test_the_chance_is_the_share_of_members_that_see_a_change() -> None:
    """An edge that reaches a cell just at its horizon is seen in time by the faster half."""
    change = found(band(-220.0, -160.0), (SPEED_MPS, 0.0))
    at_horizon = np.abs(EAST_M + 160.0 - 60.0 * SPEED_MPS) < FIELD.cell_m
    assert at_horizon.any()
    share = change.chance[at_horizon]
    assert ((share > 0.2) & (share < 0.8)).all()
    assert np.allclose(share * MEMBERS, np.rint(share * MEMBERS))


@pytest.mark.parametrize(
    ("shade", "velocity_mps"),
    [
        (band(-120.0, -60.0), None),
        (shade_map(np.ones((FIELD.rows, FIELD.cols)), 0.0), (SPEED_MPS, 0.0)),
        (shade_map(np.ones((FIELD.rows, FIELD.cols)), 0.0, np.zeros_like(SEEN)), (SPEED_MPS, 0.0)),
    ],
    ids=["no motion", "a clear view", "nothing seen"],
)
def test_nothing_is_predicted(shade: ShadeMap, velocity_mps: tuple[float, float] | None) -> None:
    change = found(shade, velocity_mps)
    assert not change.is_predicted.any()
    assert (change.chance == 0.0).all()


def test_off_the_map_nothing_is_known() -> None:
    shade = band(-120.0, -60.0)
    away = np.array([(-1, 5), (FIELD.rows, 5), (5, FIELD.cols), (2_000_000, -7)])
    change = next_change(shade, forecast(shade, (SPEED_MPS, 0.0)), away, SETTINGS)
    assert not change.is_sunlit.any()
    assert (change.horizon_s == 0.0).all()
    assert not change.is_predicted.any()


@pytest.mark.parametrize("seed", range(4))
def test_it_follows_from_a_methods_own_forecast(seed: int) -> None:
    """With the motion that the method found in a minute of maps, against the shade that comes."""
    drawn, state = DriftingShade(seed, velocity_mps=(5.0, 2.0)), ForecastState()
    for at_s in range(0, 65, 5):
        state, sun = FORECASTERS["advection"].after(
            state, shade_map(drawn.transmittance(FIELD, at_s), at_s), SETTINGS
        )
    change = next_change(state.newest, sun, CELLS, SETTINGS)
    true_s = np.full(len(CELLS), np.inf)
    for lead_s in np.arange(STEP_S, 60.0, STEP_S).tolist():
        differs = is_sunlit(drawn, 60.0 + lead_s)[SEEN] != change.is_sunlit
        true_s[np.isinf(true_s) & differs] = lead_s
    came = np.isfinite(true_s) & (true_s <= change.horizon_s)
    assert came.sum() > 1_000
    assert change.is_predicted[came].mean() > 0.9
    assert np.median(np.abs(change.after_s - true_s)[came & change.is_predicted]) <= STEP_S
    false = change.is_predicted & (true_s > change.horizon_s + 15.0)
    assert false.sum() < 0.1 * change.is_predicted.sum()
