"""The wind: a pure function that grows and turns with height, with gusts of the asked strength."""

import numpy as np
import pytest

from recon.sim.errors import SimulationError
from recon.sim.world import Wind, WindSettings

BREEZE = WindSettings(seed=3, speed_10m_mps=5.0, heading_deg=90.0)


def heading_deg(east_mps: float, north_mps: float) -> float:
    return float(np.degrees(np.arctan2(east_mps, north_mps)))


def test_the_mean_wind_grows_by_its_power_and_turns_right() -> None:
    wind = Wind(BREEZE)
    low, high = wind.mean_mps(10.0), wind.mean_mps(100.0)
    assert np.hypot(*low[:2]) == pytest.approx(5.0)
    assert np.hypot(*high[:2]) == pytest.approx(5.0 * 10.0**0.16)
    assert heading_deg(*low[:2]) == pytest.approx(90.3)
    assert heading_deg(*high[:2]) == pytest.approx(93.0)
    assert wind.mean_mps(-3.0)[:2] != (0.0, 0.0)
    assert wind.mean_mps(5_000.0)[0] == pytest.approx(wind.mean_mps(600.0)[0])


@pytest.mark.flight
def test_gusts_have_the_configured_strength_and_mean_0() -> None:
    wind = Wind(BREEZE)
    found = np.array([wind.at(0.0, 0.0, 10.0, t) for t in np.arange(0.0, 40_000.0, 7.3)])
    gusts = found - np.array(wind.mean_mps(10.0))
    assert gusts.mean(axis=0) == pytest.approx([0.0, 0.0, 0.0], abs=0.1)
    # Heading east: along is east, across is north.
    assert gusts.std(axis=0) == pytest.approx([1.0, 0.8, 0.5], rel=0.1)


def test_gusts_come_and_go_within_seconds_not_at_once() -> None:
    wind = Wind(BREEZE)
    east = np.array([wind.at(0.0, 0.0, 30.0, t)[0] for t in np.arange(0.0, 2_000.0, 0.1)])
    assert np.abs(np.diff(east)).max() < 0.5
    lagged = [np.corrcoef(east[:-k], east[k:])[0, 1] for k in (10, 100, 1_000)]
    assert lagged[0] > 0.9 > lagged[1] > 0.3 > lagged[2]


def test_gusts_drift_downwind() -> None:
    """In a wind of 5 m/s to the east a place 100 m east has the same gust 20 s later."""
    wind = Wind(BREEZE)
    for time_s in (0.0, 12.3, 456.7):
        assert wind.at(100.0, 0.0, 10.0, time_s + 20.0) == pytest.approx(
            wind.at(0.0, 0.0, 10.0, time_s)
        )


def test_the_same_moment_has_the_same_wind_in_any_order() -> None:
    times = np.random.default_rng(0).uniform(-100.0, 5_000.0, 50)
    forth = [Wind(BREEZE).at(3.0, 4.0, 50.0, t) for t in times]
    back = [Wind(BREEZE).at(3.0, 4.0, 50.0, t) for t in times[::-1]]
    assert forth == back[::-1]
    other = Wind(WindSettings(seed=4, speed_10m_mps=5.0, heading_deg=90.0))
    assert forth[0] != other.at(3.0, 4.0, 50.0, times[0])


def test_calm_is_calm() -> None:
    calm = Wind(WindSettings(speed_10m_mps=0.0))
    assert calm.at(10.0, 20.0, 100.0, 33.0) == pytest.approx((0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"speed_10m_mps": -1.0}, "wind: speed_10m_mps: expected 0 to 40, got -1"),
        ({"gust_scale_m": float("inf")}, "wind: gust_scale_m: expected 10 to 1000, got inf"),
        ({"seed": -1}, "wind: expected a seed from 0 upwards, got -1"),
    ],
)
def test_invalid_settings_are_refused(change, expected) -> None:
    with pytest.raises(SimulationError, match=expected):
        WindSettings(**change)
