"""Exposure and white balance of the imaging drone's camera.

Automatic: they follow the light below with a lag, and drift. Locked: they stay as they were set.
"""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from recon.model.arrays import FloatArray
from recon.model.imagery import CameraPose
from recon.sim.camera.settings import ExposureSettings, ToneSettings
from recon.sim.camera.tone import light_at_level, light_of_value
from recon.sim.land.land_tiles import LandSquare
from recon.sim.world.keyframes import gaussian

EXPOSURE, RED, BLUE = 130, 131, 132
"""Random streams of the imaging drone's camera."""

Metered = Callable[[npt.ArrayLike, npt.ArrayLike, float], float]
"""(east (N,), north (N,), time_s) -> mean light on the ground there over the reference's."""

METERED_ACROSS = 5
METERED_REACH = 0.8
"""Half width of the metered area, relative to the height: centre-weighted, as in most cameras."""
LOOKS_BACK = 5
LEAST_LIGHT = 1e-4
LARGEST_DEVIATION = 3.0
"""Drifts are clipped to three standard deviations: a camera's drift is bounded."""


def exposure_stops(
    settings: ExposureSettings, seed: int, pose: CameraPose, time_s: float, metered: Metered
) -> float:
    """Return the exposure in stops relative to that of full sun.

    A camera's exposure depends on earlier light. Here the sky is evaluated again for the moments
    before, so that exposure is a function of time and place, whatever was rendered before.
    """
    stops = settings.drift_stops * _drift((seed, EXPOSURE), time_s, settings.drift_s)
    if settings.follows > 0.0:
        seen = _followed_light(settings, pose, time_s, metered)
        stops -= settings.follows * float(np.log2(max(seen, LEAST_LIGHT)))
    return float(np.clip(stops, -settings.most_stops, settings.most_stops))


def white_balance(settings: ExposureSettings, seed: int, time_s: float) -> FloatArray:
    """Return the gains (3,) of red, green and blue; green's is 1."""
    red, blue = (
        1.0 + settings.white_balance * _drift((seed, stream), time_s, settings.white_balance_s)
        for stream in (RED, BLUE)
    )
    return np.array([red, 1.0, blue])


def _followed_light(
    settings: ExposureSettings, pose: CameraPose, time_s: float, metered: Metered
) -> float:
    """Return the light below the camera, averaged over the last moments (exponential lag)."""
    reach_m = METERED_REACH * max(1.0, float(pose.position_enu_m[2]))
    steps = np.linspace(-reach_m, reach_m, METERED_ACROSS)
    east, north = (grid.ravel() for grid in np.meshgrid(steps, steps))
    east, north = east + pose.position_enu_m[0], north + pose.position_enu_m[1]
    # Quantiles of the exponential distribution: all moments have equal weight.
    parts = (np.arange(LOOKS_BACK) + 0.5) / LOOKS_BACK
    ages_s = -settings.lag_s * np.log(1.0 - parts)
    return float(np.mean([metered(east, north, time_s - float(age)) for age in ages_s]))


def _drift(stream: tuple[int, ...], time_s: float, lifetime_s: float) -> float:
    value = float(gaussian(stream, np.array([time_s]), lifetime_s)[0])
    return max(-LARGEST_DEVIATION, min(LARGEST_DEVIATION, value))


HIGHLIGHTS_PERCENT = 99.0
HIGHLIGHTS_REACH_M = 512.0
GREEN = 1


def highlight_gain(
    level: float, tone: ToneSettings, follows: float, land: LandSquare, sun_light: float
) -> float:
    """Return the gain that puts the land's highlights at a pixel value under a clear sky.

    `sun_light` is the light of full sun relative to the reference. The land is that around the
    origin; its highlights are the brightest hundredth: roads, dry soil, roofs.
    """
    middle, reach = len(land.pixels) // 2, round(HIGHLIGHTS_REACH_M / land.cell_m)
    around = land.pixels[middle - reach : middle + reach, middle - reach : middle + reach, GREEN]
    drawn = int(np.percentile(around, HIGHLIGHTS_PERCENT, method="nearest"))
    # Auto exposure has compensated its part of a low sun already.
    seen = float(light_of_value()[drawn]) * float(sun_light ** (1.0 - follows))
    return light_at_level(tone, level) / max(seen, LEAST_LIGHT)
