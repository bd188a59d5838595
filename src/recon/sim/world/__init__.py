"""The world to fly in: sun, clouds, wind, light and relief.

All are pure functions of seed, place and time: the same point at the same time has the same value,
to the bit, whatever was asked before. Nothing here knows of aircraft, cameras or the station.
"""

from recon.sim.world.settings import (
    LayerSettings,
    LightSettings,
    ShadeColour,
    SkySettings,
    SunSettings,
    WindSettings,
    WindShift,
)
from recon.sim.world.sky import Sky
from recon.sim.world.wind import Wind
