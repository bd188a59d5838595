"""Dense flow: motions that differ from place to place, and what it does where nothing moves."""

import numpy as np
import pytest
from tests.detection.shaded_field import FIELD, DriftingShade
from tests.forecast.moving_shade import SEEN, forecasts, shade_map

from recon.forecast import ForecastSettings
from recon.model.geo import GroundGrid
from recon.model.shade import SUNLIT_TRANSMITTANCE, SURE, ShadeMap, SunForecast

SETTINGS = ForecastSettings(lead_s=(0.0, 15.0, 30.0))
TIMES_S = [5.0 * i for i in range(9)]
IS_NORTH = np.arange(FIELD.rows)[:, np.newaxis] < FIELD.rows // 2


def two_motions(seed: int, at_s: float) -> np.ndarray:
    """Shadows go east in the north of the field, and west in the south."""
    east, west = (DriftingShade(seed, 0.4, (speed, 0.0)) for speed in (5.0, -5.0))
    return np.where(IS_NORTH, east.transmittance(FIELD, at_s), west.transmittance(FIELD, at_s))


def brier(forecast: SunForecast, lead: int, truth: np.ndarray) -> float:
    is_seen = SEEN & (forecast.horizon_s >= SETTINGS.lead_s[lead])
    chances = forecast.sun_probability[lead] / SURE
    return float(((chances - (truth >= SUNLIT_TRANSMITTANCE)) ** 2)[is_seen].mean())


@pytest.mark.parametrize("seed", range(4))
def test_it_follows_shadows_that_go_two_ways(seed: int) -> None:
    maps = [shade_map(two_motions(seed, at_s), at_s) for at_s in TIMES_S]
    truth = two_motions(seed, TIMES_S[-1] + 15.0)
    dense, shift, still = (
        brier(forecasts(method, maps, SETTINGS)[-1], 1, truth)
        for method in ("dense_flow", "global_shift", "persistence")
    )
    assert dense < 0.7 * still
    assert dense < shift


def test_its_horizon_ends_where_the_way_upwind_leaves_the_view() -> None:
    drawn = DriftingShade(3, 0.4, (6.0, 0.0))
    maps = [shade_map(drawn.transmittance(FIELD, at_s), at_s) for at_s in TIMES_S]
    (found,) = forecasts("dense_flow", maps, SETTINGS)[-1:]
    assert found.method == "dense_flow"
    middle = FIELD.rows // 2
    horizon_s = found.horizon_s[middle]
    inside = np.flatnonzero(SEEN[middle])
    upwind, downwind = horizon_s[inside[:5]], horizon_s[inside[-30:]]
    assert (upwind < 30.0).all()
    assert (downwind == 30.0).all()
    assert np.isnan(horizon_s[~SEEN[middle]]).all()


def even(at_s: float) -> ShadeMap:
    return shade_map(np.ones((FIELD.rows, FIELD.cols)), at_s)


def small(at_s: float) -> ShadeMap:
    grid = GroundGrid(FIELD.frame, 0.0, 0.0, 4.0, 8, 8)
    direct = np.roll(np.eye(8), round(at_s / 5.0), axis=1)
    return shade_map(direct, at_s, np.ones((8, 8), np.bool_), grid=grid)


@pytest.mark.parametrize("drawn", [even, small], ids=["a uniform sky", "a small map"])
def test_without_a_motion_it_is_persistence(drawn) -> None:
    maps = [drawn(at_s) for at_s in TIMES_S]
    found, still = (forecasts(m, maps, SETTINGS)[-1] for m in ("dense_flow", "persistence"))
    assert found.method == "persistence"
    assert (found.sun_probability == still.sun_probability).all()
