"""Cameras: the frames of the imaging drone, and the photos of survey drones.

The imaging drone's frames come from files, from a real field, or are rendered from the land under
the simulated sky, with the effects of lens, sensor, haze and hover. Each effect is a pure function
of the seed, the time and the frame number.
"""

from recon.sim.camera.settings import (
    CameraSettings,
    ExposureSettings,
    HoverSettings,
    ImageSensorSettings,
    LensSettings,
    ToneSettings,
)
