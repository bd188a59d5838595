"""From the land's colours to pixel values: light, haze, exposure, sensor noise, display curve.

For each channel: colour of the land (undone display curve) x light on the ground x transmission of
the air, plus haze; x exposure and white balance; plus shot and read noise; display curve. Pixel
values are light to the power 1/2.2; 1.0 of light is white.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
import numpy.typing as npt

from recon.model.imagery import CameraPose, RgbImage
from recon.sim.camera.lens import GroundRays, Lens
from recon.sim.camera.settings import CameraSettings, ExposureSettings, ImageSensorSettings
from recon.sim.land.land_tiles import LandImage
from recon.sim.world.keyframes import FloatArray, FloatImage, gaussian
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
    """Exposure and white balance (3,)."""
    number: int


def develop(lens: Lens, imager: CameraSettings, scene: Scene) -> RgbImage:
    """Return the pixel values of the lens's window, (rows, cols, 3)."""
    beam = lens.full(scene.beam * _hot_spot(imager, scene))
    beam *= light_free_of_shadow(scene.land[:, :, 3])
    clear = np.exp(-scene.rays.distance_m / np.float32(imager.haze_m)) * scene.rays.sees_ground
    clear_share = lens.full(clear.astype(np.float32))
    air = (1.0 - clear_share) * lens.vignette
    clear_share *= lens.vignette
    far_light = scene.light.at(np.array(_mean_beam(scene), dtype=np.float32))
    # All three channels in one draw: the noise of a frame is a function of its number.
    noise = noise_of(imager.seed, scene.number, (3, *beam.shape))
    # Channel by channel: planes of float32 stay in the cache, (rows, cols, 3) would not.
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


DISPLAY_GAMMA = 2.2
STEPS = 65_535
"""Levels of light in the lookup table: with fewer, dark pixel values would be missing."""
NOISE_STREAM = 140


@lru_cache(maxsize=1)
def light_of_value() -> FloatImage:
    """Return the light (256,) of each pixel value."""
    values = np.arange(256, dtype=np.float64) / 255.0
    return (values**DISPLAY_GAMMA).astype(np.float32)


@lru_cache(maxsize=1)
def value_of_light() -> npt.NDArray[np.uint8]:
    """Return the pixel value (65536,) of each level of light."""
    light = np.arange(STEPS + 1, dtype=np.float64) / STEPS
    return np.rint(255.0 * light ** (1.0 / DISPLAY_GAMMA)).astype(np.uint8)


def read_out(
    light: FloatImage, noise: FloatImage, settings: ImageSensorSettings
) -> npt.NDArray[np.uint8]:
    """Return the pixel values of one channel's light (N, M); overwrites both arrays.

    `noise` has mean 0 and standard deviation 1; 0 outside the image circle.
    """
    # Shot noise grows with the root of the light, read noise is constant.
    noise *= np.sqrt(
        np.float32(settings.read_noise**2) + light * np.float32(1.0 / settings.full_well)
    )
    light += noise
    light *= np.float32(STEPS)
    np.clip(light, 0.0, STEPS, out=light)
    pixels: npt.NDArray[np.uint8] = value_of_light()[light.astype(np.uint16)]
    return pixels


def noise_of(seed: int, number: int, shape: tuple[int, ...]) -> FloatImage:
    """Return the noise of a frame, mean 0 and standard deviation 1: a function of its number."""
    random = np.random.Generator(np.random.SFC64((seed, NOISE_STREAM, number)))
    return random.standard_normal(shape, dtype=np.float32)
