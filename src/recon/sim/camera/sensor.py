"""From light to pixel values: noise, and the curve of a screen.

Pixel values are light to the power 1/2.2; 1.0 of light is white.
"""

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from recon.sim.camera.settings import SensorSettings
from recon.sim.land.noise import FloatImage

DISPLAY_GAMMA = 2.2
STEPS = 65_535
"""Of light: dark pixel values are 1 to 2 apart only with so many."""
NOISE_STREAM = 140


@lru_cache(maxsize=1)
def light_of_value() -> FloatImage:
    """Return the light (256,) of each pixel value."""
    values = np.arange(256, dtype=np.float64) / 255.0
    return (values**DISPLAY_GAMMA).astype(np.float32)


@lru_cache(maxsize=1)
def value_of_light() -> npt.NDArray[np.uint8]:
    """Return the pixel value (65536,) of each step of light."""
    light = np.arange(STEPS + 1, dtype=np.float64) / STEPS
    return np.rint(255.0 * light ** (1.0 / DISPLAY_GAMMA)).astype(np.uint8)


def read_out(
    light: FloatImage, noise: FloatImage, settings: SensorSettings
) -> npt.NDArray[np.uint8]:
    """Return the pixel values of one channel's light (N, M); overwrites both arrays.

    `noise` is of mean 0 and deviation 1; where it is 0 there is none.
    """
    noise *= np.sqrt(
        np.float32(settings.read_noise**2) + light * np.float32(1.0 / settings.full_well)
    )
    light += noise
    light *= np.float32(STEPS)
    np.clip(light, 0.0, STEPS, out=light)
    pixels: npt.NDArray[np.uint8] = value_of_light()[light.astype(np.uint16)]
    return pixels


def noise_of(seed: int, number: int, shape: tuple[int, ...]) -> FloatImage:
    """Return a picture's noise of mean 0 and deviation 1: a function of its number."""
    random = np.random.Generator(np.random.SFC64((seed, NOISE_STREAM, number)))
    return random.standard_normal(shape, dtype=np.float32)
