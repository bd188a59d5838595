"""From the land's colours to light on the sensor: beam, sky, haze, lens and exposure."""

from dataclasses import dataclass

import cv2
import numpy as np

from recon.model.imagery import RgbImage
from recon.sim.camera.lens import Lens
from recon.sim.camera.look import Look
from recon.sim.camera.sensor import light_of_value, noise_of, read_out
from recon.sim.camera.settings import ImagerSettings
from recon.sim.land.land_tiles import LandImage
from recon.sim.land.noise import FloatImage
from recon.sim.world.ground_light import GroundLight
from recon.sim.world.keyframes import FloatArray

HAZE = (0.48, 0.55, 0.61)
"""Light of far air over white in full sun, red, green, blue: what the horizon fades to."""


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What falls on the sensor of one picture."""

    seen: Look
    land: LandImage
    light: GroundLight
    beam: FloatImage
    """Share of the sun's beam at the lattice's points, what the ground's tilt does included."""
    gains: FloatArray
    """Exposure and white balance (3,)."""
    number: int


def develop(lens: Lens, imager: ImagerSettings, scene: Scene) -> RgbImage:
    """Return the pixel values of the lens's window, (rows, cols, 3)."""
    beam = lens.full(scene.beam * _hot_spot(imager, scene))
    beam *= light_free_of_shadow(scene.land[:, :, 3])
    clear = np.exp(-scene.seen.distance_m / np.float32(imager.haze_m)) * scene.seen.sees_ground
    clear_share = lens.full(clear.astype(np.float32))
    air = (1.0 - clear_share) * lens.vignette
    clear_share *= lens.vignette
    far_light = scene.light.at(np.array(_mean_beam(scene), dtype=np.float32))
    noise = noise_of(imager.seed, scene.number, (3, *beam.shape))
    channels = []
    for number in range(3):
        light = beam * np.float32(scene.light.beam[number])
        light += np.float32(scene.light.sky[number])
        light *= cv2.LUT(np.ascontiguousarray(scene.land[:, :, number]), light_of_value())
        light *= clear_share
        light += air * np.float32(HAZE[number] * far_light[number])
        light *= np.float32(scene.gains[number])
        noise[number] *= lens.is_lit
        channels.append(read_out(light, noise[number], imager.sensor))
    return cv2.merge(channels).astype(np.uint8, copy=False)


def light_free_of_shadow(shadow: LandImage) -> FloatImage:
    """Return the beam's share beside trees and roofs, from shadows of 0 to 255."""
    share: FloatImage = 1.0 - shadow.astype(np.float32) * np.float32(1.0 / 255.0)
    return share


def _hot_spot(imager: ImagerSettings, scene: Scene) -> FloatImage:
    """Return the beam's factor by the angle between looking and shining (Hapke's opposition)."""
    # A ray that goes where the light goes sees what the sun sees.
    cosine = -(scene.seen.rays @ scene.light.toward_sun.astype(np.float32))
    angle_deg = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    factor: FloatImage = 1.0 + np.float32(imager.hot_spot) * np.exp(
        -angle_deg / np.float32(imager.hot_spot_deg)
    )
    return factor


def _mean_beam(scene: Scene) -> float:
    """Return the beam's share on the ground in view: haze is lit like the land around."""
    return float(np.mean(scene.beam, dtype=np.float64))
