"""Exposure follows the light with a lag and in part; drifts are bounded."""

import numpy as np
import pytest

from recon.sim.camera import ExposureSettings
from recon.sim.camera.exposure import LARGEST_DEVIATION, exposure_stops, white_balance
from recon.sim.world import LayerSettings, Sky, SkySettings
from recon.sim.world.light import metered_light

FOLLOWING = ExposureSettings(follows=0.5, lag_s=2.0, drift_stops=0.0)
DRIFTING = ExposureSettings(follows=0.0, drift_stops=0.1, drift_s=10.0)


def stops_after(pose, seconds: float, settings: ExposureSettings = FOLLOWING) -> float:
    """Return the exposure some time after the light fell to a quarter."""
    return exposure_stops(
        settings, 0, pose(), seconds, lambda _east, _north, t: 1.0 if t < 0.0 else 0.25
    )


def test_half_of_a_drop_by_two_stops_is_compensated_gradually(pose) -> None:
    assert stops_after(pose, -0.1) == 0.0
    assert stops_after(pose, 60.0) == pytest.approx(1.0)
    rising = [stops_after(pose, 0.25 * step) for step in range(40)]
    assert rising == sorted(rising)
    assert 0.2 < stops_after(pose, FOLLOWING.lag_s) < 0.8


def test_exposure_stays_within_its_bounds(pose) -> None:
    dark = exposure_stops(ExposureSettings(), 0, pose(), 5.0, lambda *_: 0.0)
    bright = exposure_stops(ExposureSettings(), 0, pose(), 5.0, lambda *_: 1e6)
    assert (dark, bright) == (2.5, -2.5)


def test_drift_has_its_deviation_and_is_bounded(pose) -> None:
    drifts = np.array(
        [exposure_stops(DRIFTING, 4, pose(), 5.0 * n, lambda *_: 0.3) for n in range(4_000)]
    )
    assert drifts.std() == pytest.approx(0.1, rel=0.1)
    assert np.abs(drifts).max() <= LARGEST_DEVIATION * 0.1
    slow = np.diff(
        [exposure_stops(DRIFTING, 4, pose(), 0.1 * n, lambda *_: 1.0) for n in range(999)]
    )
    assert np.abs(slow).max() < 0.01


def test_white_balance_drifts_in_red_and_blue_apart(pose) -> None:
    settings = ExposureSettings(white_balance=0.05, white_balance_s=10.0)
    gains = np.array([white_balance(settings, 2, 6.0 * n) for n in range(3_000)])
    assert (gains[:, 1] == 1.0).all()
    assert gains[:, [0, 2]].std(axis=0) == pytest.approx([0.05, 0.05], rel=0.12)
    assert np.abs(gains - 1.0).max() <= LARGEST_DEVIATION * 0.05 + 1e-12
    assert abs(np.corrcoef(gains[:, 0], gains[:, 2])[0, 1]) < 0.1


def test_a_cloud_over_the_view_opens_the_exposure(pose) -> None:
    sky = Sky(SkySettings(3, layers=(LayerSettings(cover=0.5, outer_scale_m=800.0),)))
    settings = ExposureSettings(follows=0.7, drift_stops=0.0)

    def metered(east, north, time_s: float) -> float:
        return metered_light(sky, east, north, time_s)

    times = np.arange(0.0, 900.0, 15.0)
    stops = np.array([exposure_stops(settings, 0, pose(), t, metered) for t in times])
    beneath = np.meshgrid(np.linspace(-96, 96, 9), np.linspace(-96, 96, 9))
    light = np.array([metered(*beneath, t) for t in times])
    assert np.ptp(stops) > 0.4
    assert np.corrcoef(stops, np.log2(light))[0, 1] < -0.9
