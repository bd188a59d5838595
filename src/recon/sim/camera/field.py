"""Renders the farmland as rays by the imaging drone's camera, under a sky of clouds.

A frame is a function of its view (pose, time, number) and the settings, to the bit. Ground points
and light are computed on a coarse lattice of pixels and interpolated.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import cv2
import numpy as np
import numpy.typing as npt

from recon.camera import ImageCircle, OmnidirectionalCamera
from recon.model.arrays import FloatArray
from recon.model.imagery import CameraPose, RgbImage
from recon.sim.camera.development import Scene, develop
from recon.sim.camera.exposure import GREEN, exposure_stops, highlight_gain, white_balance
from recon.sim.camera.frames import CameraView
from recon.sim.camera.lens import LATTICE_PX, GroundRays, Lens, ground_rays
from recon.sim.camera.rig import true_pose
from recon.sim.camera.settings import CameraSettings
from recon.sim.errors import FrameSourceError
from recon.sim.land.land_tiles import CELLS_M, LandImage, LandSquare, land_of
from recon.sim.land.plants import add_plants
from recon.sim.world import LightSettings, Sky, SkySettings
from recon.sim.world.keyframes import FloatImage
from recon.sim.world.light import beam_share, light_under, metered_light
from recon.sim.world.relief import Relief

HIGHLIGHTS_LAND_LEVEL = 2
"""Land level of 4 m: a road still covers its pixels, and a square covers kilometres."""


def _clear_sky() -> Sky:
    return Sky(SkySettings(layers=()))


@dataclass(slots=True)
class FieldRenderer:
    """Renders views of the land; each view needs a pose.

    Height 0 of the ground is that of the pose's local frame; relief varies about it.
    """

    camera: OmnidirectionalCamera
    image_circle: ImageCircle | None = None
    seed: int = 0
    sky: Sky = field(default_factory=_clear_sky)
    imager: CameraSettings = field(default_factory=CameraSettings)
    relief: Relief | None = None
    light: LightSettings = field(default_factory=LightSettings)
    shows_plants: bool = False
    """Whether the ground has detail finer than the land's tiles: for photos from low."""
    _highlight_gain: float | None = field(default=None, init=False)
    _lens: Lens | None = field(default=None, init=False)

    def render(self, view: CameraView) -> RgbImage:
        """Return the frame (rows, cols, 3) uint8 RGB; thread-safe."""
        pose, time_s = self.true_pose(view), view.elapsed_s
        lens, land, sun = self.lens, land_of(self.seed), self.sky.sun_at(time_s)
        rays = ground_rays(lens, pose, self.relief)
        light = light_under(self.sky, time_s, self.light)
        east_m, north_m = (float(part) for part in pose.position_enu_m[:2])
        picture = land_picture(lens, rays, lambda level: land.square(level, east_m, north_m, sun))
        if self.shows_plants:
            pixel_m = float(rays.footprint_m.min())
            add_plants(picture, lens.full(rays.east_m), lens.full(rays.north_m), pixel_m, self.seed)
        scene = Scene(
            rays,
            picture,
            light,
            beam_share(self.sky, light, self.relief, rays.east_m, rays.north_m, time_s),
            self._gains(pose, time_s),
            view.number,
        )
        frame = np.zeros((self.camera.rows, self.camera.cols, 3), dtype=np.uint8)
        frame[lens.window] = develop(lens, self.imager, scene)
        return frame

    def prepare(self) -> None:
        """Draw the land around the origin and the first clouds, so that the first frame is fast."""
        for level in range(len(CELLS_M)):
            land_of(self.seed).square(level, 0.0, 0.0, self.sky.sun_at(0.0))
        self.sky.transmittance(0.0, 0.0, 0.0)

    def true_pose(self, view: CameraView) -> CameraPose:
        """Return the camera's true pose; raises `FrameSourceError` for a view without a pose."""
        if view.pose is None:
            raise FrameSourceError("expected a camera pose to render a field from, got none")
        return true_pose(view.pose, self.imager.hover, self.imager.seed, view.elapsed_s)

    def gains(self, view: CameraView) -> FloatArray:
        """Return exposure, white balance and tint of a view, factors (3,)."""
        return self._gains(self.true_pose(view), view.elapsed_s)

    @property
    def lens(self) -> Lens:
        """The lens, computed at the first call."""
        if self._lens is None:
            self._lens = Lens(self.camera, self.image_circle, self.imager.lens)
        return self._lens

    def _gains(self, pose: CameraPose, time_s: float) -> FloatArray:
        exposure, seed = self.imager.exposure, self.imager.seed
        stops = exposure_stops(
            exposure,
            seed,
            pose,
            time_s,
            lambda e, n, t: metered_light(self.sky, e, n, t, self.light),
        )
        base = self._base_gain() * np.array(self.imager.tint)
        gains: FloatArray = base * 2.0**stops * white_balance(exposure, seed, time_s)
        return gains

    def _base_gain(self) -> float:
        """Return the gain for the highlights; the first call draws a square of land."""
        exposure = self.imager.exposure
        if exposure.highlight_level is None:
            return 1.0
        if self._highlight_gain is None:
            sun, light = self.sky.sun_at(0.0), light_under(self.sky, 0.0, self.light)
            land = land_of(self.seed).square(HIGHLIGHTS_LAND_LEVEL, 0.0, 0.0, sun)
            in_sun = float(light.beam[GREEN] + light.sky[GREEN])
            self._highlight_gain = highlight_gain(
                exposure.highlight_level, self.imager.tone, exposure.follows, land, in_sun
            )
        return self._highlight_gain


Squares = Callable[[int], LandSquare]
"""Level -> the land's pixels at that level around the camera."""

FADE_M = 20.0
"""Width over which a level fades into the next coarser one at the edge of its square."""


def land_picture(lens: Lens, rays: GroundRays, squares: Squares) -> LandImage:
    """Return red, green, blue and shadow (rows, cols, 4) of the lens's window, before light.

    Levels are blended from coarse to fine, each where the footprint of a pixel asks for it.
    """
    east, north = lens.full(rays.east_m), lens.full(rays.north_m)
    if rays.footprint_m.max() <= CELLS_M[0]:
        finest = squares(0)
        if _weight(rays, finest, CELLS_M[1]).min() >= 1.0:
            return _sample(finest, east, north)
    picture = _sample(squares(len(CELLS_M) - 1), east, north)
    for level in range(len(CELLS_M) - 2, -1, -1):
        if rays.footprint_m.min() >= CELLS_M[level + 1]:
            break
        square = squares(level)
        weight = _weight(rays, square, CELLS_M[level + 1])
        if (box := _box(weight, picture.shape)) is not None:
            fine = _sample(square, east[box], north[box])
            share = np.clip(lens.full(weight)[box], 0.0, 1.0)
            picture[box] = cv2.blendLinear(
                fine, np.ascontiguousarray(picture[box]), share, 1.0 - share
            )
    return picture


def _weight(rays: GroundRays, square: LandSquare, coarser_m: float) -> FloatImage:
    """Return the weight of a level on the lattice: 1 where its pixels are as fine as the lens's."""
    wanted = (coarser_m - rays.footprint_m) / (coarser_m - square.cell_m)
    east_m, north_m = square.centre_m
    reach = np.maximum(np.abs(rays.east_m - east_m), np.abs(rays.north_m - north_m))
    covered = (square.half_width_m - reach) / FADE_M
    weight: FloatImage = np.clip(np.minimum(wanted, covered), 0.0, 1.0).astype(np.float32)
    return weight


def _box(weight: FloatImage, shape: tuple[int, ...]) -> tuple[slice, slice] | None:
    """Return rows and columns of the window where a lattice weight is not 0; None without any."""
    rows, cols = np.flatnonzero(weight.any(axis=1)), np.flatnonzero(weight.any(axis=0))
    if rows.size == 0:
        return None
    # One more block on each side: interpolation reaches into it.
    return (
        slice(max(0, (rows[0] - 1) * LATTICE_PX), min(shape[0], (rows[-1] + 2) * LATTICE_PX)),
        slice(max(0, (cols[0] - 1) * LATTICE_PX), min(shape[1], (cols[-1] + 2) * LATTICE_PX)),
    )


def _sample(square: LandSquare, east_m: FloatImage, north_m: FloatImage) -> npt.NDArray[np.uint8]:
    per_m = np.float32(1.0 / square.cell_m)
    cols = (east_m - np.float32(square.west_m)) * per_m - np.float32(0.5)
    rows = (np.float32(square.north_m) - north_m) * per_m - np.float32(0.5)
    return cv2.remap(
        square.pixels, cols, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT_101
    ).astype(np.uint8, copy=False)
