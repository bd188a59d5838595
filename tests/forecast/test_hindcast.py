"""How often earlier forecasts were right: by hand, and kept within bounds."""

import numpy as np
import pytest
from tests.detection.shaded_field import FIELD
from tests.forecast.moving_shade import SEEN, shade_map, step

from recon.forecast import ForecastSettings, ForecastState, right_shares
from recon.model.geo import GroundGrid
from recon.model.shade import ShadeMap

SETTINGS = ForecastSettings(lead_s=(0.0, 15.0, 30.0, 60.0, 120.0, 300.0))
GRID = GroundGrid(FIELD.frame, 0.0, 40.0, 8.0, 5, 4)
WEST = np.arange(GRID.cols) < 1


def after(maps: list[ShadeMap], method: str = "persistence") -> ForecastState:
    state = ForecastState()
    for one in maps:
        state, _issued = step(method, state, one, SETTINGS)
    return state


def lit(share: np.ndarray, at_s: float, seen: np.ndarray | None = None) -> ShadeMap:
    direct = np.broadcast_to(share, (GRID.rows, GRID.cols)).astype(float)
    every = np.ones(direct.shape, dtype=np.bool_) if seen is None else seen
    return shade_map(direct, at_s, every, 0.9, GRID)


def test_a_sky_that_stays_is_called_rightly_and_one_that_changes_is_not() -> None:
    same = [lit(WEST, 5.0 * i) for i in range(30)]
    assert right_shares(after(same)) == {15.0: 1.0, 30.0: 1.0, 60.0: 1.0, 120.0: 1.0}
    # Persistence is wrong in a quarter of the cells at 15 s, once all turn in one moment.
    turned = [lit(WEST if i < 4 else np.ones(GRID.cols), 5.0 * i) for i in range(5)]
    found = right_shares(after(turned))
    assert found[15.0] == pytest.approx((1.0 + 0.25) / 2.0, abs=0.01)


def test_only_cells_known_then_and_now_count() -> None:
    none = np.zeros((GRID.rows, GRID.cols), dtype=np.bool_)
    blind = [lit(WEST, 5.0 * i, none) for i in range(10)]
    assert right_shares(after(blind)) == {}
    half = none.copy()
    half[:, :2] = True
    some = after([lit(WEST, 5.0 * i, half) for i in range(4)])
    assert some.compared[15.0].cells == half.sum()


def test_old_comparisons_fade() -> None:
    wrong = [lit(np.full(GRID.cols, i // 3 % 2), 5.0 * i) for i in range(60)]
    right = [lit(WEST, 300.0 + 5.0 * i) for i in range(240)]
    early, late = right_shares(after(wrong)), right_shares(after([*wrong, *right]))
    assert early[15.0] < 0.2
    assert late[15.0] > early[15.0] + 0.5


def test_what_is_kept_is_bounded_and_another_grid_begins_anew() -> None:
    state = after([lit(WEST, 2.0 * i) for i in range(300)])
    assert len(state.issued) <= 62
    other = shade_map(np.ones(SEEN.shape), 700.0)
    state, _issued = step("persistence", state, other, SETTINGS)
    assert len(state.issued) == 1


def test_maps_at_odd_times_are_compared_within_half_a_step() -> None:
    maps = [lit(WEST, at_s) for at_s in (0.0, 7.3, 14.0, 21.9, 40.0)]
    assert right_shares(after(maps)) == {15.0: 1.0}
