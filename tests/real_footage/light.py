"""Levels of the real frames as light, and the light that shade leaves.

One frame shows cloud shadow: the lower right of becker-1, over crop and over bare soil. The tone
curve is fitted so that both surfaces lose the same share of light there (crop: levels 133, 171, 131
in sun and 63, 108, 96 in shade; soil: 207, 216, 202 and 107, 131, 140).
"""

import numpy as np

WHITE = 256.0
CURVE_POWER, CURVE_SHOULDER = 2.09, 0.15
"""level / 256 = (1 - exp(-k u)) / (1 - exp(-k)) with u = light^(1 / power) and k the shoulder."""
SHADE_OVER_SUN = np.array([0.21, 0.36, 0.50], dtype=np.float32)
"""Light in deep shade over light in sun, in red, green, blue."""


def light_of(levels: np.ndarray) -> np.ndarray:
    """Return the light, 0 to 1, of levels of any shape; the middle of level 255 is just below 1."""
    return _light_of_level()[levels]


def _light_of_level() -> np.ndarray:
    share = (np.arange(256) + 0.5) / WHITE
    root = -np.log(1.0 - share * (1.0 - np.exp(-CURVE_SHOULDER))) / CURVE_SHOULDER
    return (root**CURVE_POWER).astype(np.float32)


def levels_of(light: np.ndarray) -> np.ndarray:
    """Return uint8 levels of light; more than 1 saturates."""
    root = np.clip(light, 0.0, 1.0) ** (1.0 / CURVE_POWER)
    share = (1.0 - np.exp(-CURVE_SHOULDER * root)) / (1.0 - np.exp(-CURVE_SHOULDER))
    return np.clip(share * WHITE, 0.0, 255.0).astype(np.uint8)


def relit(sunlit: np.ndarray, transmittance: np.ndarray, hot: np.ndarray) -> np.ndarray:
    """Return light (..., 3) of ground under clouds, from that in sun without a hot spot (..., 3).

    `transmittance` (...) is the direct beam's share; `hot` (..., 3) the gain of the beam by the hot
    spot opposite the sun, which shade does not have.
    """
    beam = (1.0 - SHADE_OVER_SUN) * (1.0 + hot)
    return sunlit * (SHADE_OVER_SUN + beam * transmittance[..., np.newaxis])


def sunlit_base(light: np.ndarray, hot: np.ndarray) -> np.ndarray:
    """Return light (..., 3) in sun without its hot spot: the inverse of `relit` in full sun."""
    return light / (1.0 + (1.0 - SHADE_OVER_SUN) * hot)
