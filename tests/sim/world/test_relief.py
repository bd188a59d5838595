"""Rolling ground: heights and slopes belong together."""

import numpy as np
import pytest

from recon.sim.errors import SimulationError
from recon.sim.world.relief import Relief, ReliefSettings


def test_the_origin_lies_at_zero_and_heights_have_their_deviation() -> None:
    east, north = np.meshgrid(np.linspace(-2e4, 2e4, 300), np.linspace(-2e4, 2e4, 300))
    relief = Relief(ReliefSettings(5, height_m=7.0))
    assert relief.height_m(0.0, 0.0) == pytest.approx(0.0, abs=1e-9)
    assert relief.height_m(east, north).std() == pytest.approx(7.0, rel=0.05)


def test_slopes_are_the_heights_differences() -> None:
    relief = Relief(ReliefSettings(2))
    places = np.random.default_rng(1).uniform(-3e3, 3e3, (2, 50))
    rises = relief.slope(*places)
    for axis in (0, 1):
        step = np.zeros((2, 1))
        step[axis] = 1.0
        there, back = relief.height_m(*(places + step)), relief.height_m(*(places - step))
        assert rises[axis] == pytest.approx((there - back) / 2.0, abs=1e-3)


def test_gentle_relief_is_gentle() -> None:
    east, north = np.meshgrid(np.linspace(-2e3, 2e3, 200), np.linspace(-2e3, 2e3, 200))
    rises = Relief(ReliefSettings(1)).slope(east, north)
    assert 0.01 < np.hypot(*rises).max() < 0.15


@pytest.mark.parametrize(
    "wrong", [{"height_m": -1.0}, {"shortest_m": 2_000.0}, {"longest_m": float("nan")}]
)
def test_invalid_relief_is_refused(wrong) -> None:
    with pytest.raises(SimulationError, match=r"relief: .*expected"):
        ReliefSettings(**wrong)
