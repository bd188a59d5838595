"""The farmland as a fisheye lens sees it, with the shadows of clouds: pictures for a demonstration.

The ground is flat and lies at height 0 of the rig's frame. Ground places are found on a coarse
lattice of pixels and interpolated between, so that a picture costs a few remaps.
"""

from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from math import ceil, floor
from threading import Lock

import cv2
import numpy as np

from recon.camera import ImageCircle, OmnidirectionalCamera
from recon.model.imagery import CameraPose, RgbImage
from recon.sim.camera_feed import View
from recon.sim.errors import FrameSourceError
from recon.sim.farmland import lay_out
from recon.sim.farmland_raster import Raster, draw
from recon.sim.noise import FloatImage
from recon.sim.world import LightSettings, Sky
from recon.sim.world.light import clear_sky_light

LATTICE_PX = 4
LEVELS = ((2048, 0.5), (2048, 2.0), (1536, 8.0))
"""Sizes and cells: the finest serves the middle of the picture, the coarsest the horizon."""
HAZE = (186.0, 196.0, 202.0)
HAZE_M = 7_000.0
DISPLAY_GAMMA = 2.2
"""The land's colours are a screen's, not light's: a quarter of the light is half as bright."""
STEEPEST_TANGENT = 60.0
"""Rays flatter than 1 in 60 count as horizon."""


@lru_cache(maxsize=2)
def _rasters(seed: int) -> tuple[Raster, ...]:
    land = lay_out(seed)
    return tuple(draw(land, size, cell_m, seed) for size, cell_m in LEVELS)


@dataclass(slots=True)
class FieldFrames:
    """Renders views of the land; needs views with a pose."""

    camera: OmnidirectionalCamera
    image_circle: ImageCircle | None = None
    seed: int = 0
    sky: Sky | None = None
    _lens: "_Lens | None" = field(default=None, init=False)
    _preparing: Lock = field(default_factory=Lock, init=False)

    def render(self, view: View) -> RgbImage:
        """Return the picture (rows, cols, 3)."""
        if view.pose is None:
            raise FrameSourceError("expected a camera pose to render a field from, got none")
        lens, rasters = self._scene()
        look = _look(lens, view.pose)
        picture = _with_haze(lens, look, _ground_picture(lens, look, rasters))
        frame = np.zeros((self.camera.rows, self.camera.cols, 3), dtype=np.uint8)
        frame[lens.window] = _lit(lens, look, picture, self.sky, view.elapsed_s)
        return frame

    def prepare(self) -> None:
        """Draw the land, and the clouds of the first moment."""
        self._scene()
        if self.sky is not None:
            self.sky.transmittance(0.0, 0.0, 0.0)

    def _scene(self) -> "tuple[_Lens, tuple[Raster, ...]]":
        """Return lens and land, made at the first call; several threads may call this at once."""
        with self._preparing:
            if self._lens is None:
                self._lens = _Lens(self.camera, self.image_circle)
            return self._lens, _rasters(self.seed)


@dataclass(frozen=True)
class _Lens:
    """What does not depend on the pose."""

    camera: OmnidirectionalCamera
    image_circle: ImageCircle | None

    @cached_property
    def window(self) -> tuple[slice, slice]:
        """Rows and columns that can be lit: the frame's part around the image circle."""
        rows, cols, circle = self.camera.rows, self.camera.cols, self.image_circle
        if circle is None:
            return slice(0, rows), slice(0, cols)
        reach = circle.radius_px + 1.0
        return (
            _between(circle.centre_row_px - reach, circle.centre_row_px + reach, rows),
            _between(circle.centre_col_px - reach, circle.centre_col_px + reach, cols),
        )

    @cached_property
    def rays(self) -> FloatImage:
        """Unit rays (r, c, 3) of the lattice; point (i, j) is the centre of its block of pixels."""
        middle = (LATTICE_PX - 1) / 2.0
        rows, cols = self.window
        col, row = np.meshgrid(
            np.arange(cols.start, cols.stop, LATTICE_PX) + middle,
            np.arange(rows.start, rows.stop, LATTICE_PX) + middle,
        )
        rays = self.camera.unproject(np.stack([col.ravel(), row.ravel()], axis=1))
        return np.nan_to_num(rays).reshape(*col.shape, 3).astype(np.float32)

    @cached_property
    def vignette(self) -> FloatImage:
        """Light's share over the window by the lens: falling outwards, none outside the circle."""
        camera = self.camera
        rows, cols = self.window
        col, row = np.meshgrid(np.arange(cols.start, cols.stop), np.arange(rows.start, rows.stop))
        circle = self.image_circle or ImageCircle(
            camera.centre_col_px, camera.centre_row_px, float(np.hypot(camera.rows, camera.cols))
        )
        radius = np.hypot(col - circle.centre_col_px, row - circle.centre_row_px)
        edge = np.clip(circle.radius_px + 0.5 - radius, 0.0, 1.0)
        share = radius / min(circle.radius_px, max(camera.rows, camera.cols) / 2.0)
        light: FloatImage = (edge * (1.0 - 0.22 * share**4)).astype(np.float32)
        return np.clip(light, 0.0, 1.0)

    def full(self, lattice: FloatImage) -> FloatImage:
        """Interpolate lattice values to every pixel of the window."""
        rows, cols = lattice.shape[0] * LATTICE_PX, lattice.shape[1] * LATTICE_PX
        image = cv2.resize(lattice, (cols, rows), interpolation=cv2.INTER_LINEAR)
        height, width = (part.stop - part.start for part in self.window)
        return image[:height, :width].astype(np.float32, copy=False)


def _between(low: float, high: float, size: int) -> slice:
    return slice(max(0, floor(low)), min(size, ceil(high) + 1))


@dataclass(frozen=True, slots=True, eq=False)
class _Look:
    """Where the lattice's rays meet the ground."""

    east_m: FloatImage
    north_m: FloatImage
    distance_m: FloatImage
    footprint_m: FloatImage
    """Length on the ground of one pixel's step, along the steeper direction."""


def _look(lens: _Lens, pose: CameraPose) -> _Look:
    rays = lens.rays @ pose.rotation_enu_camera.T.astype(np.float32)
    height_m = float(pose.position_enu_m[2])
    if height_m <= 0.0:
        height_m = 0.1
    across = np.hypot(rays[:, :, 0], rays[:, :, 1])
    tangent = np.where(rays[:, :, 2] < -1e-6, across / np.maximum(-rays[:, :, 2], 1e-6), np.inf)
    tangent = np.minimum(tangent, STEEPEST_TANGENT)
    share = height_m * tangent / np.maximum(across, 1e-9)
    radians_per_px = 1.0 / lens.camera.profile.depth_px(np.zeros(1))[0]
    return _Look(
        (pose.position_enu_m[0] + rays[:, :, 0] * share).astype(np.float32),
        (pose.position_enu_m[1] + rays[:, :, 1] * share).astype(np.float32),
        (height_m * np.hypot(1.0, tangent)).astype(np.float32),
        (height_m * (1.0 + tangent**2) * abs(radians_per_px)).astype(np.float32),
    )


def _ground_picture(lens: _Lens, look: _Look, rasters: tuple[Raster, ...]) -> RgbImage:
    """Sample the rasters, from coarse to fine, each where its resolution is called for."""
    east, north = lens.full(look.east_m), lens.full(look.north_m)
    picture = _sample(rasters[-1], east, north)
    for raster, coarser in zip(rasters[-2::-1], rasters[:0:-1], strict=True):
        wanted = np.clip(
            (coarser.cell_m - look.footprint_m) / (coarser.cell_m - raster.cell_m), 0.0, 1.0
        )
        reach = np.maximum(np.abs(look.east_m), np.abs(look.north_m))
        covered = np.clip((raster.half_width_m - reach) / 40.0, 0.0, 1.0)
        weight = lens.full((wanted * covered).astype(np.float32))
        fine = _sample(raster, east, north)
        picture = cv2.blendLinear(fine, picture, weight, 1.0 - weight).astype(np.uint8, copy=False)
    return picture


def _sample(raster: Raster, east_m: FloatImage, north_m: FloatImage) -> RgbImage:
    half_m, cell_m = raster.half_width_m, raster.cell_m
    cols = (east_m + half_m) / cell_m - np.float32(0.5)
    rows = (half_m - north_m) / cell_m - np.float32(0.5)
    return cv2.remap(
        raster.rgb, cols, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT_101
    ).astype(np.uint8, copy=False)


def _with_haze(lens: _Lens, look: _Look, picture: RgbImage) -> RgbImage:
    share = lens.full((1.0 - np.exp(-look.distance_m / HAZE_M)).astype(np.float32))
    haze = np.empty_like(picture)
    haze[:] = HAZE
    return cv2.blendLinear(picture, haze, 1.0 - share, share).astype(np.uint8, copy=False)


def _lit(lens: _Lens, look: _Look, picture: RgbImage, sky: Sky | None, time_s: float) -> RgbImage:
    """Apply the lens's light and the clouds' shadows; skylight keeps shadows a little blue."""
    if sky is None:
        light = [lens.vignette] * 3
    else:
        shade = lens.full(_brightness(sky, look, time_s))
        light = [lens.vignette * (1.0 - (1.0 - shade) * part) for part in (1.0, 0.97, 0.88)]
    scale = cv2.merge([(255.0 * channel).astype(np.uint8) for channel in light])
    return cv2.multiply(picture, scale, scale=1.0 / 255.0).astype(np.uint8, copy=False)


def _brightness(sky: Sky, look: _Look, time_s: float) -> FloatImage:
    """Return pixel values over those in full sun, for the lattice's points."""
    settings = LightSettings()
    light = clear_sky_light(sky.sun_at(time_s), settings)
    index = light.index(
        sky.transmittance(look.east_m, look.north_m, time_s), settings.cloud_brightening
    )
    in_sun = light.index(np.ones(1, dtype=np.float32), settings.cloud_brightening)
    brightness: FloatImage = np.power(index / in_sun, np.float32(1.0 / DISPLAY_GAMMA))
    return brightness
