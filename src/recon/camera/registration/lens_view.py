"""What registration needs of a lens, for frames of one size: the window, its rays, its mask.

The window is the box around the image circle in a frame shrunk to the working width; all pixels in
this room are of the window. `warp_map` gives the pixels of one pose that see the same ground as
those of another: between two poses over a plane, rays are related by a homography,

    ray' = R'^T (R - (t - t') n^T R / h) ray,    n up, h the height of the first pose,

(Hartley and Zisserman, Multiple View Geometry, 13.1), which holds on the whole unit sphere.
"""

from dataclasses import dataclass
from math import ceil

import cv2
import numpy as np
import numpy.typing as npt

from recon.camera.ground import source_mask
from recon.camera.image_circle import ImageCircle
from recon.camera.omnidirectional import OmnidirectionalCamera
from recon.camera.registration.settings import RegistrationSettings
from recon.model.arrays import FloatArray
from recon.model.imagery import CameraPose, RgbImage

GreyImage = npt.NDArray[np.uint8]
MapArray = npt.NDArray[np.float32]

LATTICE_PX = 8
"""Maps are computed at blocks of this many pixels and interpolated: 0.02 px off at most."""


@dataclass(frozen=True, slots=True, eq=False)
class LensView:
    """A lens at the working size, cut to the box around what it shows."""

    settings: RegistrationSettings
    camera: OmnidirectionalCamera
    window: tuple[slice, slice]
    """Rows and columns of the working frame."""
    mask: GreyImage
    """255 where a pixel of the window shows the scene, else 0."""
    inner_mask: GreyImage
    """255 where a feature may lie: the patch around it is in the scene."""
    mask_scale: MapArray
    """Factor from a mean over the contrast window to the mean of its visible pixels."""
    lattice_rays: FloatArray
    """Unit rays (r, c, 3) at the lattice's nodes."""

    def grey(self, rgb: RgbImage) -> GreyImage:
        """Return the window of a frame (rows, cols, 3) of the lens's aspect ratio, in grey."""
        size = (self.camera.cols, self.camera.rows)
        grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
        if grey.shape[::-1] != size:
            grey = cv2.resize(grey, size, interpolation=cv2.INTER_AREA)
        return np.ascontiguousarray(grey[self.window], dtype=np.uint8)

    def rays(self, pixels: FloatArray) -> FloatArray:
        """Return unit rays (N, 3) of pixels (N, 2) of the window; NaN beyond the lens's range."""
        return self.camera.unproject(pixels + self._corner)

    def pixels(self, rays: FloatArray) -> FloatArray:
        """Return pixels (..., 2) of the window that see rays (..., 3), continued beyond."""
        return self.camera.project_beyond_range(rays, fast=True) - self._corner

    def warp_map(self, homography: FloatArray) -> tuple[MapArray, MapArray]:
        """Return columns and rows, each (rows, cols) float32, seen by the transformed rays."""
        nodes = self.pixels(self.lattice_rays @ homography.T).astype(np.float32)
        rows, cols = self.mask.shape
        size = (nodes.shape[1] * LATTICE_PX, nodes.shape[0] * LATTICE_PX)
        planes = (cv2.resize(nodes[..., axis], size) for axis in (0, 1))
        col, row = (plane[:rows, :cols].astype(np.float32, copy=False) for plane in planes)
        return col, row

    @property
    def px_per_rad(self) -> float:
        """Pixels of one radian where the lens is steepest."""
        return self.camera.profile.steepest_px_per_rad()

    @property
    def _corner(self) -> FloatArray:
        return np.array([self.window[1].start, self.window[0].start], dtype=np.float64)


def view_of(
    camera: OmnidirectionalCamera, circle: ImageCircle | None, settings: RegistrationSettings
) -> LensView:
    """Return the view of a lens; `circle` is at the camera's size, None: none is known."""
    scale = min(1.0, settings.working_cols / camera.cols)
    working = camera.scaled_to(round(camera.rows * scale), round(camera.cols * scale))
    mask = source_mask(working, None if circle is None else circle.scaled(scale))
    rows, cols = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    window = slice(int(rows[0]), int(rows[-1]) + 1), slice(int(cols[0]), int(cols[-1]) + 1)
    shown = np.ascontiguousarray(mask[window])
    side = (settings.contrast_px, settings.contrast_px)
    weight = cv2.boxFilter(shown.astype(np.float32) / 255.0, cv2.CV_32F, side)
    rim = np.ones((2 * settings.rim_px + 1, 2 * settings.rim_px + 1), dtype=np.uint8)
    return LensView(
        settings,
        working,
        window,
        shown,
        cv2.erode(shown, rim).astype(np.uint8, copy=False),
        (1.0 / np.maximum(weight, 0.01)).astype(np.float32),
        _lattice_rays(working, window),
    )


def homography(pose: CameraPose, other: CameraPose) -> FloatArray:
    """Return (3, 3): rays of `pose` to rays of `other` that meet the ground at the same place."""
    rotation, height_m = pose.rotation_enu_camera, float(pose.position_enu_m[2])
    apart_m = pose.position_enu_m - other.position_enu_m
    plane = rotation - np.outer(apart_m, rotation[2]) / height_m
    related: FloatArray = other.rotation_enu_camera.T @ plane
    return related


def _lattice_rays(camera: OmnidirectionalCamera, window: tuple[slice, slice]) -> FloatArray:
    middle = (LATTICE_PX - 1) / 2.0
    rows, cols = (
        part.start + middle + LATTICE_PX * np.arange(ceil((part.stop - part.start) / LATTICE_PX))
        for part in window
    )
    col, row = np.meshgrid(cols, rows)
    rays = camera.unproject(np.stack([col.ravel(), row.ravel()], axis=1))
    # Beyond the range the value is not used: any ray will do.
    shown: FloatArray = np.where(np.isfinite(rays), rays, (0.0, 0.0, 1.0))
    return shown.reshape(*col.shape, 3)
