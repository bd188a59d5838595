"""Noise has the statistics of electrons, and pixel values the curve of a screen."""

import numpy as np
import pytest

from recon.sim.camera import ImageSensorSettings, ToneSettings
from recon.sim.camera.development import noise_of, read_out
from recon.sim.camera.tone import light_at_level, light_of_value, value_of_light

SHAPE = (400, 400)
PLAIN = ToneSettings()


def read(light: float, settings: ImageSensorSettings, number: int = 0) -> np.ndarray:
    return read_out(np.full(SHAPE, light, np.float32), noise_of(1, number, SHAPE), settings, PLAIN)


@pytest.mark.parametrize("light", [0.05, 0.2, 0.6])
def test_noise_is_shot_and_read_noise(light: float) -> None:
    settings = ImageSensorSettings(full_well=400.0, read_noise=0.01)
    found = light_of_value()[read(light, settings)].astype(float)
    assert found.mean() == pytest.approx(light, rel=0.02)
    expected = np.sqrt(0.01**2 + light / 400.0)
    assert found.std() == pytest.approx(expected, rel=0.05)


def test_noise_is_a_function_of_the_frame_number() -> None:
    first, again, second = noise_of(1, 5, SHAPE), noise_of(1, 5, SHAPE), noise_of(1, 6, SHAPE)
    assert np.array_equal(first, again)
    assert abs(np.corrcoef(first.ravel(), second.ravel())[0, 1]) < 0.01
    assert first.mean() == pytest.approx(0.0, abs=0.01)
    assert first.std() == pytest.approx(1.0, abs=0.01)


def test_without_noise_values_come_back() -> None:
    quiet = ImageSensorSettings(full_well=1e12, read_noise=0.0)
    values = np.arange(256, dtype=np.uint8)
    light = light_of_value()[values].reshape(1, -1)
    found = read_out(light, np.ones_like(light), quiet, PLAIN)
    assert np.abs(found[0].astype(int) - values)[8:].max() <= 1


def test_light_is_clipped_at_white_and_black() -> None:
    settings = ImageSensorSettings()
    assert (read(7.0, settings) == 255).all()
    assert (read(-7.0, ImageSensorSettings(full_well=1e12)) == 0).all()


@pytest.mark.parametrize("tone", [PLAIN, ToneSettings(0.6, 0.0), ToneSettings(0.8, 0.4)])
def test_each_value_has_its_light(tone: ToneSettings) -> None:
    levels = np.arange(10.0, 250.0, 12.0)
    light = np.array([[light_at_level(tone, level) for level in levels]], np.float32)
    quiet = ImageSensorSettings(full_well=1e12, read_noise=0.0)
    found = read_out(light, np.zeros_like(light), quiet, tone)
    assert np.abs(found[0] - levels).max() <= 1.0
    assert (np.diff(light) > 0.0).all()


def test_a_knee_compresses_highlights_and_leaves_the_rest() -> None:
    light = np.array([[0.3, 0.9, 1.2, 1.8]], np.float32)
    quiet = ImageSensorSettings(full_well=1e12, read_noise=0.0)
    plain, bent = (
        read_out(light.copy(), np.zeros_like(light), quiet, tone)[0]
        for tone in (PLAIN, ToneSettings(knee=0.7))
    )
    assert bent[0] == plain[0]
    assert bent[1] < plain[1]
    assert (plain[2:] == 255).all()
    assert bent[2] < bent[3] < 255


@pytest.mark.parametrize("tone", [PLAIN, ToneSettings(knee=0.7, contrast=0.2)])
def test_dark_values_are_distinct(tone: ToneSettings) -> None:
    steps = np.diff(value_of_light(tone).astype(int))
    assert steps.max() <= 2
    assert steps.min() >= 0
