"""Exposure and white balance that the camera sets by itself.

A camera's exposure depends on what it saw before. Here that is asked of the sky again for the
moments before, so that exposure is a function of time and place, whatever was rendered.
"""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from recon.model.imagery import CameraPose
from recon.sim.camera.settings import ExposureSettings
from recon.sim.world.keyframes import FloatArray, gaussian

EXPOSURE, RED, BLUE = 130, 131, 132
"""Streams of the eye's random numbers."""

Metered = Callable[[npt.ArrayLike, npt.ArrayLike, float], float]
"""(east (N,), north (N,), time_s) -> mean light on the ground there over the reference's."""

METERED_ACROSS = 5
METERED_REACH = 0.8
"""Of the height: the middle of the picture counts, as in most cameras."""
LOOKS_BACK = 5
LEAST_LIGHT = 1e-4
LARGEST_DEVIATION = 3.0
"""Drifts are held within three standard deviations: a camera's drift is bounded."""


def exposure_stops(
    settings: ExposureSettings, seed: int, pose: CameraPose, time_s: float, metered: Metered
) -> float:
    """Return by how many stops the exposure differs from that of full sun."""
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
    """Return the light beneath the camera, the last moments weighing as the lag has it."""
    reach_m = METERED_REACH * max(1.0, float(pose.position_enu_m[2]))
    steps = np.linspace(-reach_m, reach_m, METERED_ACROSS)
    east, north = (grid.ravel() for grid in np.meshgrid(steps, steps))
    east, north = east + pose.position_enu_m[0], north + pose.position_enu_m[1]
    # The quantiles of an exponential: each moment stands for an equal part of its weight.
    parts = (np.arange(LOOKS_BACK) + 0.5) / LOOKS_BACK
    ages_s = -settings.lag_s * np.log(1.0 - parts)
    return float(np.mean([metered(east, north, time_s - float(age)) for age in ages_s]))


def _drift(stream: tuple[int, ...], time_s: float, lifetime_s: float) -> float:
    value = float(gaussian(stream, np.array([time_s]), lifetime_s)[0])
    return max(-LARGEST_DEVIATION, min(LARGEST_DEVIATION, value))
