"""Where a photo's pixels lie on level ground: a homography by camera, pose and ground.

The camera has no distortion here: survey cameras correct it, and a mask's pixels are larger than
what is left of it.
"""

from dataclasses import dataclass
from math import radians, tan

import cv2
import numpy as np
import numpy.typing as npt

from recon.model.arrays import FloatArray
from recon.model.geo import GroundGrid
from recon.product.sun_at import Sunshine

FloatMap = npt.NDArray[np.float32]

LOWEST_PITCH_DEG = -30.0
"""A camera that looks up more than this shows ground too far off, or the sky."""
DOWN_DEG = -90.0


@dataclass(frozen=True, slots=True)
class Aim:
    """Where a camera is and looks: east, north and height above the ground in metres; the heading
    of the top of the picture, and the pitch, -90 straight down, in degrees."""

    east_m: float
    north_m: float
    height_m: float
    yaw_deg: float
    pitch_deg: float = DOWN_DEG

    @property
    def rotation(self) -> FloatArray:
        """(3, 3): from the camera's right, down, forward to east, north, up."""
        yaw, pitch = radians(self.yaw_deg), radians(self.pitch_deg)
        ahead = np.array([np.sin(yaw), np.cos(yaw), 0.0])
        right = np.array([np.cos(yaw), -np.sin(yaw), 0.0])
        up = np.array([0.0, 0.0, 1.0])
        forward = np.cos(pitch) * ahead + np.sin(pitch) * up
        down = np.sin(pitch) * ahead - np.cos(pitch) * up
        return np.stack([right, down, forward], axis=1)


@dataclass(frozen=True, slots=True)
class PhotoView:
    """A picture's pose, field of view along its longer side, and size in pixels."""

    aim: Aim
    across_deg: float
    cols: int
    rows: int

    @property
    def homography(self) -> FloatArray:
        """H (3, 3): (east, north, 1) ~ H (col, row, 1), pixels counted from the middle of the upper
        left one."""
        aim, cols, rows = self.aim, self.cols, self.rows
        focal_px = max(cols, rows) / 2.0 / tan(radians(self.across_deg) / 2.0)
        rays = aim.rotation @ np.array(
            [[1.0 / focal_px, 0.0, -(cols - 1) / 2.0 / focal_px],
             [0.0, 1.0 / focal_px, -(rows - 1) / 2.0 / focal_px],
             [0.0, 0.0, 1.0]]
        )  # fmt: skip
        place = np.array(
            [[aim.height_m, 0.0, -aim.east_m], [0.0, aim.height_m, -aim.north_m], [0.0, 0.0, -1.0]]
        )
        homography: FloatArray = place @ rays
        return homography

    @property
    def corners_m(self) -> FloatArray:
        """The footprint's corners (4, 2), east and north, clockwise from the upper left one."""
        return projected(self.homography, self._corners_px)

    @property
    def shows_sky(self) -> bool:
        """Return whether a corner looks up: then the corners do not bound the ground shown."""
        third = np.column_stack([self._corners_px, np.ones(4)]) @ self.homography[2]
        return bool((third <= 0.0).any())

    @property
    def _corners_px(self) -> FloatArray:
        right, low = self.cols - 0.5, self.rows - 0.5
        return np.array([[-0.5, -0.5], [right, -0.5], [right, low], [-0.5, low]])


def projected(homography: FloatArray, points: FloatArray) -> FloatArray:
    """Return points (N, 2) behind a homography."""
    found = np.column_stack([points, np.ones(len(points))]) @ homography.T
    result: FloatArray = found[:, :2] / found[:, 2:]
    return result


def sun_on_photo(sun: Sunshine, grid: GroundGrid, view: PhotoView) -> Sunshine:
    """Return the sun on the pixels of a picture, (rows, cols)."""
    cells = np.array(
        [
            [1.0 / grid.cell_m, 0.0, -grid.west_m / grid.cell_m - 0.5],
            [0.0, -1.0 / grid.cell_m, grid.north_m / grid.cell_m - 0.5],
            [0.0, 0.0, 1.0],
        ]
    )
    to_cells = cells @ view.homography
    how = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP

    def on_photo(values: FloatMap) -> FloatMap:
        found = cv2.warpPerspective(values, to_cells, (view.cols, view.rows), flags=how)
        return found.astype(np.float32, copy=False)

    is_known = (sun.confidence > 0.0).astype(np.float32)
    share = on_photo(is_known)
    divisor = np.where(share > 0.0, share, np.float32(1.0))
    known = share >= 0.5
    transmittance = on_photo(sun.transmittance * is_known) / divisor
    confidence = np.where(known, on_photo(sun.confidence * is_known) / divisor, 0.0)
    return Sunshine(transmittance.astype(np.float32), confidence.astype(np.float32))
