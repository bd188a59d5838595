"""The light that a sky gives to the ground at a moment."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from recon.sim.land.noise import FloatImage
from recon.sim.world.ground_light import GroundLight, ground_light
from recon.sim.world.relief import Relief
from recon.sim.world.settings import LightSettings
from recon.sim.world.sky import Sky

LEAST_SUN_HEIGHT = 0.08
"""Sine of the lowest sun for which slopes are worked out: 5 degrees."""
GREEN = 1


def light_under(sky: Sky, time_s: float, settings: LightSettings | None = None) -> GroundLight:
    """Return the light of a moment; without clouds nothing brightens the sky."""
    settings = settings or LightSettings()
    if not sky.settings.layers:
        settings = replace(settings, cloud_brightening=1.0)
    return ground_light(sky.sun_at(time_s), settings)


def metered_light(sky: Sky, east_m: npt.ArrayLike, north_m: npt.ArrayLike, time_s: float) -> float:
    """Return the mean light at points, in green, over the reference's full sun."""
    light = light_under(sky, time_s)
    share = float(np.mean(sky.transmittance(east_m, north_m, time_s), dtype=np.float64))
    return float(light.sky[GREEN] + share * light.beam[GREEN])


def beam_share(
    sky: Sky,
    light: GroundLight,
    relief: Relief | None,
    east_m: FloatImage,
    north_m: FloatImage,
    time_s: float,
) -> FloatImage:
    """Return the sun's beam on the ground over that on level ground in clear sky."""
    share = sky.transmittance(east_m, north_m, time_s)
    if relief is None:
        return share
    rise_east, rise_north = relief.slope(east_m, north_m)
    sun_east, sun_north, sun_up = (float(part) for part in light.toward_sun)
    sun_up = max(sun_up, LEAST_SUN_HEIGHT)
    facing = sun_up - rise_east * sun_east - rise_north * sun_north
    facing /= sun_up * np.sqrt(1.0 + rise_east**2 + rise_north**2)
    tilted: FloatImage = (share * np.maximum(facing, 0.0)).astype(np.float32)
    return tilted
