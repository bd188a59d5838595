"""Conditions are drawn within their ranges, differ between seeds and are the seed's alone."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from recon.sim.app.camera_feed import ImageFormat
from recon.sim.camera.exposure import LARGEST_DEVIATION
from recon.sim.conditions import (
    LIMITS,
    ConditionRanges,
    Conditions,
    Range,
    draw_conditions,
)
from recon.sim.errors import SimulationError

SEEDS = range(200)
RANGES = ConditionRanges(sun_elevation_deg=Range(25.0, 60.0))
DRAWN = [draw_conditions(RANGES, seed) for seed in SEEDS]

FOUND: dict[str, Callable[[Conditions], float]] = {
    "sun_elevation_deg": lambda c: c.sun_elevation_deg or 0.0,
    "shade_green": lambda c: c.light.shade.green if c.light.shade else 0.0,
    "shade_blue_over_red": lambda c: c.light.shade.blue_over_red if c.light.shade else 0.0,
    "highlight_level": lambda c: c.camera.exposure.highlight_level or 0.0,
    "knee": lambda c: c.camera.tone.knee,
    "contrast": lambda c: c.camera.tone.contrast,
    "exposure_follows": lambda c: c.camera.exposure.follows,
    "exposure_lag_s": lambda c: c.camera.exposure.lag_s,
    "exposure_drift_stops": lambda c: c.camera.exposure.drift_stops,
    "white_balance": lambda c: c.camera.exposure.white_balance * LARGEST_DEVIATION,
    "tint_red": lambda c: c.camera.tint[0],
    "tint_blue": lambda c: c.camera.tint[2],
    "lens_blue_over_red": lambda c: c.camera.lens.rim_blue_over_red,
    "rim_falloff": lambda c: c.camera.lens.rim_falloff,
    "hot_spot": lambda c: c.camera.hot_spot,
    "hot_spot_deg": lambda c: c.camera.hot_spot_deg,
    "yaw_error_deg": lambda c: abs(c.yaw_error_deg),
    "relief_m": lambda c: c.relief_m,
    "period_s": lambda c: 1.0 / c.feed.largest_fps_hz,
    "jpeg_quality": lambda c: c.feed.jpeg_quality,
}


def test_every_range_is_drawn_from() -> None:
    assert FOUND.keys() == LIMITS.keys() - {"jpeg_share"}


@pytest.mark.parametrize("name", FOUND)
def test_values_fill_their_range_and_differ_between_seeds(name: str) -> None:
    values, within = np.array([FOUND[name](one) for one in DRAWN]), getattr(RANGES, name)
    width = within.high - within.low
    assert within.low - 1e-9 <= values.min() < within.low + 0.1 * width
    assert within.high - 0.1 * width < values.max() <= within.high + 1e-9
    least_distinct = 15 if name == "jpeg_quality" else len(SEEDS)
    assert len(set(values.tolist())) >= least_distinct
    assert values.mean() == pytest.approx((within.low + within.high) / 2.0, abs=0.1 * width)


def test_half_of_the_flights_have_jpeg_mornings_and_yaw_errors_to_the_right() -> None:
    jpeg = np.mean([one.feed.image_format is ImageFormat.JPEG for one in DRAWN])
    mornings = np.mean([one.is_morning for one in DRAWN])
    right = np.mean([one.yaw_error_deg > 0.0 for one in DRAWN])
    assert np.abs(np.array([jpeg, mornings, right]) - 0.5).max() < 0.12


def test_values_do_not_depend_on_each_other() -> None:
    table = np.array([[find(one) for find in FOUND.values()] for one in DRAWN])
    apart = np.corrcoef(table.T) - np.eye(len(FOUND))
    assert np.abs(apart).max() < 0.3


def test_a_seed_repeats_and_another_range_leaves_the_other_values() -> None:
    assert draw_conditions(RANGES, 7) == DRAWN[7]
    pinned = draw_conditions(replace(RANGES, hot_spot=Range(0.3, 0.3)), 7)
    assert pinned.camera == replace(DRAWN[7].camera, hot_spot=0.3)


def test_a_locked_exposure_neither_follows_nor_drifts() -> None:
    locked = draw_conditions(replace(RANGES, exposure_locked=True), 7).camera.exposure
    assert (locked.follows, locked.drift_stops, locked.white_balance) == (0.0, 0.0, 0.0)
    assert locked.highlight_level == DRAWN[7].camera.exposure.highlight_level


def test_impossible_ranges_are_refused() -> None:
    with pytest.raises(SimulationError, match="hot_spot: expected 0 to 2, got 9"):
        ConditionRanges(hot_spot=Range(0.1, 9.0))
    for low, high in ((0.5, 0.4), (float("nan"), 1.0)):
        with pytest.raises(SimulationError, match="expected the lower value first, got"):
            Range(low, high)
