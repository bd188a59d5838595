"""Frames in, forecast out: detection's own maps carry the motion."""

import numpy as np
import pytest
from tests.detection.shaded_field import FIELD, FOOTPRINT, DriftingShade, Imager, Land
from tests.forecast.moving_shade import is_sunlit

from recon.detection import DETECTORS, DetectionSettings, DetectionState
from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.shade import ShadeMap, SunForecast

LEADS = ForecastSettings(lead_s=(0.0, 30.0, 60.0))


def line(seed: int, velocity: tuple[float, float]) -> tuple[DriftingShade, dict[str, SunForecast]]:
    """Two minutes of frames, placed a metre off, through detection and each forecaster."""
    land, shade = Land(seed), DriftingShade(seed, cover=0.4, velocity_mps=velocity)
    detection, states = DetectionState(), dict.fromkeys(FORECASTERS, ForecastState())
    told: dict[str, SunForecast] = {}
    wrong_m = np.random.default_rng(seed).normal(0.0, 1.0, (25, 2))
    for i in range(25):
        image = Imager(offset_m=tuple(wrong_m[i])).see(land, shade, 5.0 * i)
        detection, found = DETECTORS["brightness_ratio"](detection, image, DetectionSettings())
        assert isinstance(found, ShadeMap), found
        for method, step in FORECASTERS.items():
            states[method], told[method] = step(states[method], found, LEADS)
    return shade, told


def test_the_motion_is_found_in_what_was_detected_and_helps() -> None:
    scores: dict[str, list[float]] = {method: [] for method in FORECASTERS}
    for seed, velocity in ((800, (4.0, -2.0)), (801, (-3.0, -4.0)), (802, (0.5, 5.0))):
        shade, told = line(seed, velocity)
        assert told["global_shift"].grid == FIELD
        assert told["global_shift"].velocity_mps == pytest.approx(velocity, abs=0.7)
        truth = is_sunlit(shade, 120.0 + 30.0)
        foreseen = FOOTPRINT & (told["global_shift"].horizon_s >= 30.0)
        for method, forecast in told.items():
            chances = forecast.sun_probability[1] / 255.0
            scores[method].append(float(((chances - truth) ** 2)[foreseen].mean()))
    assert np.mean(scores["global_shift"]) < 0.6 * np.mean(scores["persistence"]), scores
