"""The lens: rays of pixels on a coarse lattice, where they meet the ground, vignetting."""

from dataclasses import dataclass
from functools import cached_property
from math import ceil, floor

import cv2
import numpy as np

from recon.camera import ImageCircle, OmnidirectionalCamera
from recon.model.arrays import FloatArray
from recon.model.imagery import CameraPose
from recon.sim.camera.settings import LensSettings
from recon.sim.world.keyframes import FloatImage
from recon.sim.world.relief import Relief

LATTICE_PX = 4
"""Ground points are computed for blocks of this many pixels and interpolated."""
RIM_COLOUR_POWER = 3.0
"""Power of the radius: in real frames of this lens class colour changes mostly near the rim."""


@dataclass(frozen=True)
class Lens:
    """Everything about the lens that does not depend on the pose."""

    camera: OmnidirectionalCamera
    image_circle: ImageCircle | None
    settings: LensSettings

    @cached_property
    def window(self) -> tuple[slice, slice]:
        """Rows and columns that can be lit: the box around the image circle."""
        rows, cols, circle = self.camera.rows, self.camera.cols, self.image_circle
        if circle is None:
            return slice(0, rows), slice(0, cols)
        reach = circle.radius_px + self.settings.soft_rim_px
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
    def radians_per_px(self) -> float:
        """Angle of one pixel in the middle of the frame."""
        return 1.0 / abs(float(self.camera.profile.depth_px(np.zeros(1))[0]))

    @cached_property
    def transmission(self) -> tuple[FloatImage, FloatImage, FloatImage]:
        """Relative light over the window in red, green and blue, 0 outside the image circle.

        Towards the rim it falls, and red falls more than blue.
        """
        # Red loses what blue gains: the lens's colour leaves the brightness as it is.
        bluer = np.exp(
            0.5 * np.log(self.settings.rim_blue_over_red) * self._share**RIM_COLOUR_POWER
        )
        red, blue = self.vignette / bluer, self.vignette * bluer
        return red.astype(np.float32), self.vignette, blue.astype(np.float32)

    @cached_property
    def vignette(self) -> FloatImage:
        """Relative light over the window: falls towards the rim, 0 outside the image circle."""
        circle, soft_px = self._circle, self.settings.soft_rim_px
        rim = (circle.radius_px + 0.5 * soft_px - self._radius_px) / soft_px
        light = np.clip(rim, 0.0, 1.0) * (1.0 - self.settings.rim_falloff * self._share**4)
        return np.clip(light, 0.0, 1.0).astype(np.float32)

    @cached_property
    def _circle(self) -> ImageCircle:
        camera = self.camera
        return self.image_circle or ImageCircle(
            camera.centre_col_px, camera.centre_row_px, float(np.hypot(camera.rows, camera.cols))
        )

    @cached_property
    def _radius_px(self) -> FloatArray:
        """Distance of the window's pixels from the image circle's centre."""
        rows, cols = self.window
        col, row = np.meshgrid(np.arange(cols.start, cols.stop), np.arange(rows.start, rows.stop))
        return np.hypot(col - self._circle.centre_col_px, row - self._circle.centre_row_px)

    @cached_property
    def _share(self) -> FloatArray:
        """The same, of the radius."""
        camera = self.camera
        return self._radius_px / min(self._circle.radius_px, max(camera.rows, camera.cols) / 2.0)

    @cached_property
    def is_lit(self) -> FloatImage:
        """1 in the image circle, 0 outside: the video encoder smooths noise where it is dark."""
        return (self.vignette > 0.0).astype(np.float32)

    def full(self, lattice: FloatImage) -> FloatImage:
        """Interpolate lattice values to every pixel of the window."""
        rows, cols = lattice.shape[0] * LATTICE_PX, lattice.shape[1] * LATTICE_PX
        image = cv2.resize(lattice, (cols, rows), interpolation=cv2.INTER_LINEAR)
        height, width = (part.stop - part.start for part in self.window)
        return image[:height, :width].astype(np.float32, copy=False)


def _between(low: float, high: float, size: int) -> slice:
    return slice(max(0, floor(low)), min(size, ceil(high) + 1))


STEEPEST_TANGENT = 60.0
"""Rays flatter than 1 in 60 show haze only."""
LEAST_HEIGHT_M = 0.1
"""Lowest camera height used."""
RELIEF_STEPS = 4
"""Iterations from the level plane to the relief: slopes are gentle, so few are enough."""
RELIEF_TANGENT = 8.0
"""Flatter rays use level ground: hills would hide each other there."""


@dataclass(frozen=True, slots=True, eq=False)
class GroundRays:
    """Where the lattice's rays meet the ground, (r, c) each."""

    east_m: FloatImage
    north_m: FloatImage
    distance_m: FloatImage
    """Distance along the ray; infinite where there is no ground."""
    footprint_m: FloatImage
    """Length of a pixel's footprint on the ground, along its longer direction."""
    directions: FloatImage
    """Unit vectors (r, c, 3), east, north, up."""

    @property
    def sees_ground(self) -> FloatImage:
        """1 where there is ground, 0 above the horizon."""
        return np.isfinite(self.distance_m).astype(np.float32)


def ground_rays(lens: Lens, pose: CameraPose, relief: Relief | None) -> GroundRays:
    """Return where the lens's lattice meets the ground from a pose."""
    rays = lens.rays @ pose.rotation_enu_camera.T.astype(np.float32)
    across = np.hypot(rays[:, :, 0], rays[:, :, 1])
    tangent = np.where(rays[:, :, 2] < -1e-6, across / np.maximum(-rays[:, :, 2], 1e-6), np.inf)
    is_ground = tangent < STEEPEST_TANGENT
    tangent = np.minimum(tangent, STEEPEST_TANGENT).astype(np.float32)
    towards = (rays[:, :, :2] / np.maximum(across, 1e-9)[:, :, np.newaxis]).astype(np.float32)
    # Directions and tangents are computed once; relief only changes the height above ground.
    height_m = _heights_m(pose, tangent, towards, relief)
    level_m = height_m * tangent
    east, north = _places(pose, level_m, towards)
    distance_m = np.where(is_ground, height_m * np.hypot(1.0, tangent), np.inf)
    return GroundRays(
        east,
        north,
        distance_m.astype(np.float32),
        (height_m * (1.0 + tangent**2) * lens.radians_per_px).astype(np.float32),
        rays,
    )


def _places(
    pose: CameraPose, level_m: FloatImage, towards: FloatImage
) -> tuple[FloatImage, FloatImage]:
    east = pose.position_enu_m[0] + towards[:, :, 0] * level_m
    north = pose.position_enu_m[1] + towards[:, :, 1] * level_m
    return east.astype(np.float32), north.astype(np.float32)


def _heights_m(
    pose: CameraPose, tangent: FloatImage, towards: FloatImage, relief: Relief | None
) -> FloatImage:
    """Return the camera's height above the ground point of each ray."""
    above_m = np.full_like(tangent, max(float(pose.position_enu_m[2]), LEAST_HEIGHT_M))
    if relief is None:
        return above_m
    height_m = above_m
    # Fixed-point iteration: height above the ground point found with the last height.
    for _ in range(RELIEF_STEPS):
        ground_m = relief.height_m(*_places(pose, height_m * tangent, towards))
        height_m = np.maximum(above_m - ground_m, LEAST_HEIGHT_M).astype(np.float32)
    return np.where(tangent < RELIEF_TANGENT, height_m, above_m).astype(np.float32)
