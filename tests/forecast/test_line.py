"""Frames in, forecast out: the maps of a detector are good enough for the motion."""

import numpy as np
import pytest
from tests.detection.shaded_field import FIELD, FOOTPRINT, DriftingShade, Imager, Land
from tests.forecast.moving_shade import is_sunlit, step

from recon.detection import DETECTORS, DetectionSettings, DetectionState
from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.shade import ShadeMap, SunForecast

LEADS = ForecastSettings(lead_s=(0.0, 30.0, 60.0))


def line(seed: int, velocity: tuple[float, float]) -> tuple[DriftingShade, dict[str, SunForecast]]:
    """Pass two minutes of frames, positioned a metre off, through detection and each forecaster."""
    land, shade = Land(seed), DriftingShade(seed, cover=0.4, velocity_mps=velocity)
    detection, states = DetectionState(), dict.fromkeys(FORECASTERS, ForecastState())
    latest: dict[str, SunForecast] = {}
    wrong_m = np.random.default_rng(seed).normal(0.0, 1.0, (25, 2))
    for i in range(25):
        image = Imager(offset_m=tuple(wrong_m[i])).see(land, shade, 5.0 * i)
        detection, found = DETECTORS["brightness_ratio"](detection, image, DetectionSettings())
        assert isinstance(found, ShadeMap), found
        for method in FORECASTERS:
            states[method], latest[method] = step(method, states[method], found, LEADS)
    return shade, latest


@pytest.mark.flight
def test_the_motion_is_found_in_detected_maps_and_helps() -> None:
    scores: dict[str, list[float]] = {method: [] for method in FORECASTERS}
    for seed, velocity in ((800, (4.0, -2.0)), (801, (-3.0, -4.0)), (802, (0.5, 5.0))):
        shade, latest = line(seed, velocity)
        assert latest["advection"].grid == FIELD
        assert latest["advection"].velocity_mps == pytest.approx(velocity, abs=0.7)
        truth = is_sunlit(shade, 120.0 + 30.0)
        within_horizon = FOOTPRINT & (latest["advection"].horizon_s >= 30.0)
        for method, forecast in latest.items():
            probability = forecast.sun_probability[1] / 255.0
            scores[method].append(float(((probability - truth) ** 2)[within_horizon].mean()))
    assert np.mean(scores["advection"]) < 0.6 * np.mean(scores["persistence"]), scores
