"""The world to fly in: sun, clouds, wind and light as pure functions of seed and time."""

from recon.sim.world.settings import (
    LayerSettings,
    LightSettings,
    SkySettings,
    SunSettings,
    WindSettings,
    WindShift,
)
from recon.sim.world.sky import Sky
from recon.sim.world.sun import SunPosition, sun_position
from recon.sim.world.wind import Wind

__all__ = [
    "LayerSettings",
    "LightSettings",
    "Sky",
    "SkySettings",
    "SunPosition",
    "SunSettings",
    "Wind",
    "WindSettings",
    "WindShift",
    "sun_position",
]
