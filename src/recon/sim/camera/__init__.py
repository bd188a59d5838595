"""The eye's camera: what it sees of the land, and what lens, sensor, air and hover do to that.

Every effect is a pure function of the settings' seed, the time and the picture's number.
"""

from recon.sim.camera.settings import (
    ExposureSettings,
    HoverSettings,
    ImagerSettings,
    LensSettings,
    SensorSettings,
)

__all__ = ["ExposureSettings", "HoverSettings", "ImagerSettings", "LensSettings", "SensorSettings"]
