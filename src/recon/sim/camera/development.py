"""Conversion of the land's colours to pixels: light, haze, exposure, lens, noise, tone curve.

For each channel: colour of the land (undone display curve) x light on the ground x transmission of
the air, plus haze; x exposure and white balance; x the lens's falloff and colour; plus shot and
read noise; tone curve.
"""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from recon.model.arrays import FloatArray
from recon.model.imagery import RgbImage
from recon.sim.camera.lens import GroundRays, Lens
from recon.sim.camera.settings import CameraSettings, ImageSensorSettings, ToneSettings
from recon.sim.camera.tone import STEPS, light_of_value, lightest, value_of_light
from recon.sim.land.land_tiles import LandImage
from recon.sim.world.keyframes import FloatImage
from recon.sim.world.light import GroundLight

HAZE = (0.48, 0.55, 0.61)
"""Light of distant air in full sun, relative to white: the colour (RGB) of the horizon."""


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """All that determines the light on the sensor for one frame."""

    rays: GroundRays
    land: LandImage
    light: GroundLight
    beam: FloatImage
    """Transmittance of the beam at the lattice's points, times the effect of the ground's slope."""
    gains: FloatArray
    """Exposure, white balance and tint (3,)."""
    number: int


def develop(lens: Lens, imager: CameraSettings, scene: Scene) -> RgbImage:
    """Return the pixel values of the lens's window, (rows, cols, 3)."""
    beam = lens.full(scene.beam * _hot_spot(imager, scene))
    beam *= light_free_of_shadow(scene.land[:, :, 3])
    clear = np.exp(-scene.rays.distance_m / np.float32(imager.haze_m)) * scene.rays.sees_ground
    clear_share = lens.full(clear.astype(np.float32))
    air = 1.0 - clear_share
    far_light = scene.light.at(np.array(_mean_beam(scene), dtype=np.float32))
    # All three channels in one draw: the noise of a frame is a function of its number.
    noise = noise_of(imager.seed, scene.number, (3, *beam.shape))
    # Channel by channel: planes of float32 stay in the cache, (rows, cols, 3) would not.
    channels = []
    for number in range(3):
        gain = scene.gains[number]
        light = beam * np.float32(gain * scene.light.beam[number])
        light += np.float32(gain * scene.light.sky[number])
        light *= cv2.LUT(np.ascontiguousarray(scene.land[:, :, number]), light_of_value())
        light *= clear_share
        light += air * np.float32(gain * HAZE[number] * far_light[number])
        light *= lens.transmission[number]
        noise[number] *= lens.is_lit
        channels.append(read_out(light, noise[number], imager.sensor, imager.tone))
    return cv2.merge(channels).astype(np.uint8, copy=False)


def light_free_of_shadow(shadow: LandImage) -> FloatImage:
    """Return the share of the beam that trees and roofs let pass, from shadows of 0 to 255."""
    share: FloatImage = 1.0 - shadow.astype(np.float32) * np.float32(1.0 / 255.0)
    return share


def _hot_spot(imager: CameraSettings, scene: Scene) -> FloatImage:
    """Return the factor of the opposition effect (Hapke), by the angle between view and beam."""
    # Looking along the sun's rays no shadows between leaves are visible: the hot spot.
    cosine = -(scene.rays.directions @ scene.light.toward_sun.astype(np.float32))
    angle_deg = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    factor: FloatImage = 1.0 + np.float32(imager.hot_spot) * np.exp(
        -angle_deg / np.float32(imager.hot_spot_deg)
    )
    return factor


def _mean_beam(scene: Scene) -> float:
    """Return the mean transmittance in view: haze is lit like the land around."""
    return float(np.mean(scene.beam, dtype=np.float64))


NOISE_STREAM = 140


def read_out(
    light: FloatImage, noise: FloatImage, settings: ImageSensorSettings, tone: ToneSettings
) -> npt.NDArray[np.uint8]:
    """Return the pixel values of one channel's light (N, M); overwrites both arrays.

    `noise` has mean 0 and standard deviation 1; 0 outside the image circle.
    """
    # Shot noise grows with the root of the light, read noise is constant.
    noise *= np.sqrt(
        np.float32(settings.read_noise**2) + light * np.float32(1.0 / settings.full_well)
    )
    light += noise
    light *= np.float32(STEPS / lightest(tone))
    np.clip(light, 0.0, STEPS, out=light)
    pixels: npt.NDArray[np.uint8] = value_of_light(tone)[light.astype(np.uint16)]
    return pixels


def noise_of(seed: int, number: int, shape: tuple[int, ...]) -> FloatImage:
    """Return the noise of a frame, mean 0 and standard deviation 1: a function of its number."""
    random = np.random.Generator(np.random.SFC64((seed, NOISE_STREAM, number)))
    return random.standard_normal(shape, dtype=np.float32)
