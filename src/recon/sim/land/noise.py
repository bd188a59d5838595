"""Seeded noise that repeats seamlessly: one tile serves an endless ground or sky."""

import numpy as np
import numpy.typing as npt

FloatImage = npt.NDArray[np.float32]


def tileable_noise(size: int, seed: int, smallest_cells: float, slope: float) -> FloatImage:
    """Return (size, size) noise of mean 0 and standard deviation 1, periodic in both directions.

    Its spectrum falls with the wave number to the power `-slope` and ends at details of
    `smallest_cells` cells.
    """
    spectrum = np.fft.rfft2(np.random.default_rng(seed).standard_normal((size, size)))
    waves = np.hypot(np.fft.fftfreq(size)[:, np.newaxis], np.fft.rfftfreq(size)[np.newaxis, :])
    waves[0, 0] = 1.0
    spectrum *= waves**-slope * np.exp(-((waves * smallest_cells) ** 2))
    spectrum[0, 0] = 0.0
    noise = np.fft.irfft2(spectrum, (size, size))
    unit: FloatImage = (noise / noise.std()).astype(np.float32)
    return unit
