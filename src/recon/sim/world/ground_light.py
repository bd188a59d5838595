"""Light on the ground by colour: the sun's beam, and the sky's that shade leaves, which is bluer.

Light is over that of a bright summer day's full sun, in which a camera sees white as white.
"""

from dataclasses import dataclass
from math import cos, radians, sin

import numpy as np

from recon.sim.land.noise import FloatImage
from recon.sim.world.keyframes import FloatArray
from recon.sim.world.light import clear_sky_light
from recon.sim.world.settings import LightSettings
from recon.sim.world.sun import SunPosition

REFERENCE_W_M2 = 850.0
"""Full sun on level ground in which the land's colours are what they are drawn with."""
SKY_COLOUR = (0.72, 0.95, 1.33)
"""A clear sky's light over the sun's, red, green, blue, of mean 1: 12 000 K beside 5 500 K."""


@dataclass(frozen=True, slots=True, eq=False)
class GroundLight:
    """Light on level ground in red, green, blue (3,)."""

    beam: FloatArray
    """Of the sun, unclouded."""
    sky: FloatArray
    """Of the sky and the clouds."""
    toward_sun: FloatArray
    """Unit vector, east, north, up."""

    def at(self, transmittance: FloatImage) -> FloatImage:
        """Return light (..., 3) where this share of the beam comes through."""
        share = np.asarray(transmittance, dtype=np.float32)[..., np.newaxis]
        light: FloatImage = self.sky.astype(np.float32) + share * self.beam.astype(np.float32)
        return light


def ground_light(
    sun: SunPosition, settings: LightSettings, reference_w_m2: float = REFERENCE_W_M2
) -> GroundLight:
    """Return the light under broken clouds; in the mean of the colours it is `light.index`.

    What clouds add to the sky's light is white.
    """
    clear = clear_sky_light(sun, settings)
    strength = clear.global_w_m2 / reference_w_m2
    blue_sky = clear.diffuse_share * np.array(SKY_COLOUR)
    beam = np.maximum(1.0 - blue_sky, 0.0) if clear.direct_w_m2 > 0.0 else np.zeros(3)
    from_clouds = (settings.cloud_brightening - 1.0) * clear.diffuse_share
    return GroundLight(strength * beam, strength * (blue_sky + from_clouds), toward(sun))


def toward(sun: SunPosition) -> FloatArray:
    """Return the unit vector to the sun, east, north, up."""
    azimuth, elevation = radians(sun.azimuth_deg), radians(sun.elevation_deg)
    level = cos(elevation)
    return np.array([level * sin(azimuth), level * cos(azimuth), sin(elevation)])
