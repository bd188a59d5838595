"""The lens: rays of pixels on a coarse lattice, and the light that reaches the rim."""

from dataclasses import dataclass
from functools import cached_property
from math import ceil, floor

import cv2
import numpy as np

from recon.camera import ImageCircle, OmnidirectionalCamera
from recon.sim.camera.settings import LensSettings
from recon.sim.land.noise import FloatImage

LATTICE_PX = 4
"""Ground places are worked out for blocks of so many pixels, and interpolated between."""


@dataclass(frozen=True)
class Lens:
    """What does not depend on the pose."""

    camera: OmnidirectionalCamera
    image_circle: ImageCircle | None
    settings: LensSettings

    @cached_property
    def window(self) -> tuple[slice, slice]:
        """Rows and columns that can be lit: the frame's part around the image circle."""
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
        """Of a pixel's step in the middle of the picture."""
        return 1.0 / abs(float(self.camera.profile.depth_px(np.zeros(1))[0]))

    @cached_property
    def vignette(self) -> FloatImage:
        """Light's share over the window: falling outwards, none outside the circle."""
        camera = self.camera
        rows, cols = self.window
        col, row = np.meshgrid(np.arange(cols.start, cols.stop), np.arange(rows.start, rows.stop))
        circle = self.image_circle or ImageCircle(
            camera.centre_col_px, camera.centre_row_px, float(np.hypot(camera.rows, camera.cols))
        )
        radius = np.hypot(col - circle.centre_col_px, row - circle.centre_row_px)
        rim = (
            circle.radius_px + 0.5 * self.settings.soft_rim_px - radius
        ) / self.settings.soft_rim_px
        share = radius / min(circle.radius_px, max(camera.rows, camera.cols) / 2.0)
        light = np.clip(rim, 0.0, 1.0) * (1.0 - self.settings.rim_falloff * share**4)
        return np.clip(light, 0.0, 1.0).astype(np.float32)

    @cached_property
    def is_lit(self) -> FloatImage:
        """1 in the image circle, 0 outside: what is dark, the video link's encoder smooths."""
        return (self.vignette > 0.0).astype(np.float32)

    def full(self, lattice: FloatImage) -> FloatImage:
        """Interpolate lattice values to every pixel of the window."""
        rows, cols = lattice.shape[0] * LATTICE_PX, lattice.shape[1] * LATTICE_PX
        image = cv2.resize(lattice, (cols, rows), interpolation=cv2.INTER_LINEAR)
        height, width = (part.stop - part.start for part in self.window)
        return image[:height, :width].astype(np.float32, copy=False)


def _between(low: float, high: float, size: int) -> slice:
    return slice(max(0, floor(low)), min(size, ceil(high) + 1))
