"""The camera's tone curve: from light on the sensor to pixel values, and back.

Light up to the knee is kept, above it compressed towards white, as cameras do for video; then the
display curve (power 1/2.2) and an S-shaped contrast.
"""

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from recon.model.arrays import FloatArray
from recon.sim.camera.settings import ToneSettings
from recon.sim.world.keyframes import FloatImage

DISPLAY_GAMMA = 2.2
STEPS = 65_535
"""Levels of light in the lookup table: with fewer, dark pixel values would be missing."""
SATURATES_AT = 2.0
"""Light at which the sensor is full, where highlights are compressed; without a knee 1."""


@lru_cache(maxsize=1)
def light_of_value() -> FloatImage:
    """Return the light (256,) of each pixel value of the land's drawing, without a tone curve."""
    values = np.arange(256, dtype=np.float64) / 255.0
    return (values**DISPLAY_GAMMA).astype(np.float32)


def lightest(tone: ToneSettings) -> float:
    """Return the light that fills the sensor."""
    return 1.0 if tone.knee == 1.0 else SATURATES_AT


@lru_cache(maxsize=8)
def value_of_light(tone: ToneSettings) -> npt.NDArray[np.uint8]:
    """Return the pixel value (65536,) of each level of light, from 0 to `lightest`."""
    return np.rint(255.0 * _curve(tone, np.linspace(0.0, lightest(tone), STEPS + 1))).astype(
        np.uint8
    )


def light_at_level(tone: ToneSettings, level: float) -> float:
    """Return the light that gives a pixel value; `lightest` for one that is never reached."""
    light = np.linspace(0.0, lightest(tone), STEPS + 1)
    return float(np.interp(level / 255.0, _curve(tone, light), light))


def _curve(tone: ToneSettings, light: FloatArray) -> FloatArray:
    """Return values from 0 to 1; they rise with the light."""
    room = 1.0 - tone.knee
    kept = np.minimum(light, tone.knee)
    if room > 0.0:
        kept = kept + room * (1.0 - np.exp(-np.maximum(light - tone.knee, 0.0) / room))
    shown = kept ** (1.0 / DISPLAY_GAMMA)
    curve: FloatArray = shown + tone.contrast * (shown**2 * (3.0 - 2.0 * shown) - shown)
    return curve
