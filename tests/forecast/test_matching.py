"""No motion rather than a false one: what a velocity explains of the maps' changes."""

from math import hypot

import numpy as np
import pytest
from tests.detection.shaded_field import FRAME, DriftingShade

from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.forecast.matching import Explained, matched_map, mismatch_by_velocity
from recon.forecast.phase_correlation import between
from recon.light.points import LightPoints
from recon.model.geo import GroundGrid
from recon.score.point_maps import PointMaps

WIDE = GroundGrid(FRAME, -1_000.0, 1_000.0, 8.0, 250, 250)
SETTINGS = ForecastSettings()
SENSORS = 50


def sparse(seed: int, velocity: tuple[float, float]) -> PointMaps:
    """Four minutes of fifty sensors over two kilometres, under shadows of 250 m."""
    rng = np.random.default_rng(seed)
    east_m, north_m = rng.uniform(-950.0, 950.0, (2, SENSORS))
    drawn = DriftingShade(seed, 0.45, velocity, size_m=250.0)
    cells = (
        np.floor((WIDE.north_m - north_m) / WIDE.cell_m).astype(int),
        np.floor((east_m - WIDE.west_m) / WIDE.cell_m).astype(int),
    )
    times_s = np.arange(0.0, 240.0, 5.0)
    light = 0.25 + 0.75 * np.stack([drawn.transmittance(WIDE, at_s)[cells] for at_s in times_s])
    times_ns = (times_s * 1e9).astype(np.int64)
    names = tuple(map(str, range(SENSORS)))
    return PointMaps(LightPoints(names, times_ns, light, east_m, north_m, None))


@pytest.mark.parametrize(("seed", "velocity"), [(1, (0.0, 20.0)), (2, (-14.0, 12.0))])
def test_over_sparse_maps_a_fast_motion_is_found_or_none(
    seed: int, velocity: tuple[float, float]
) -> None:
    """Maps between a few places carry the places' own pattern, which stands still."""
    state, found = ForecastState(), []
    for shade in sparse(seed, velocity).each():
        state = FORECASTERS["advection"].observed(state, shade, SETTINGS)
        found.append(FORECASTERS["advection"].forecast(state, SETTINGS).velocity_mps)
    claimed = [each for each in found if each is not None]
    off = [hypot(east - velocity[0], north - velocity[1]) for east, north in claimed]
    assert max(off) < 3.0, np.round(claimed, 1)
    assert found[-1] is not None


def test_what_a_velocity_explains_is_that_of_the_maps_moved() -> None:
    first, second = list(sparse(3, (12.0, -6.0)).each([0, 6]))
    sums = mismatch_by_velocity(matched_map(first), matched_map(second), SETTINGS)
    explained = Explained.of(sums, SETTINGS)
    best = explained.best
    assert best is not None
    assert (best.east_mps, best.north_mps) == pytest.approx((12.0, -6.0), abs=2.0)
    assert explained.has(best, 0.9)
    assert explained.at_rest > 2.0 * explained.left.min()


def test_between_three_values_a_peak_is_at_most_half_a_step_off() -> None:
    assert between(np.array([3.0, 2.9, 2.7], np.float32), 1) == -0.5
    assert between(np.array([1.0, 2.0, 1.0], np.float32), 1) == 0.0
