"""The pixel that sees each cell of a ground grid.

Pixels are computed on a coarse lattice and interpolated bilinearly. The lattice spacing follows
from the camera's height, so that the error stays under 0.1 px.
"""

import cv2
import numpy as np
import numpy.typing as npt

from recon.camera.errors import PoseError
from recon.camera.omnidirectional import OmnidirectionalCamera
from recon.model.geo import GroundGrid
from recon.model.imagery import CameraPose

FloatArray = npt.NDArray[np.float64]
MapArray = npt.NDArray[np.float32]

LARGEST_LATTICE_STEP = 16
"""In cells. Coarser saves nothing: `cv2.remap` dominates."""
INTERPOLATION_BUDGET_PX = 0.09
"""Allowed error of the interpolation; the test's bound is 0.1 px."""
BENDING = 0.85
"""Bound of the maps' second derivative along the ground, in units of f / h^2 (f in px/rad, h the
height): 0.46 measured for a camera pointing straight down, 0.77 for a tilt of 60 degrees; a test
over random poses checks it."""
LEAST_HEIGHT_M = 1.0
"""Lower, the camera is on the ground and sees no field."""


class MapScratch:
    """Buffers for one pair of maps, reused from frame to frame.

    Allocating megabytes for each frame takes longer than computing the maps: the kernel maps new
    memory page by page.
    """

    def __init__(self) -> None:
        self._planes: tuple[MapArray, MapArray] | None = None

    def planes(self, rows: int, cols: int) -> tuple[MapArray, MapArray]:
        """Return two uninitialised (rows, cols) float32 arrays, the same ones for the same size."""
        if self._planes is None or self._planes[0].shape != (rows, cols):
            shape = (rows, cols)
            self._planes = np.empty(shape, dtype=np.float32), np.empty(shape, dtype=np.float32)
        return self._planes


def ground_maps(
    grid: GroundGrid,
    camera: OmnidirectionalCamera,
    pose: CameraPose,
    scratch: MapScratch | None = None,
) -> tuple[MapArray, MapArray]:
    """Return the pixel column and row, each (R, C) float32, that see each cell's centre.

    Beyond the lens's range the values continue smoothly and are meaningless: mask them. With
    `scratch` the arrays are views of it, valid until its next use. Raises `PoseError` for a camera
    that is not above the ground.
    """
    height_m = float(pose.position_enu_m[2])
    # NaN compares as false everywhere below: refuse it here with a message.
    numbers = (*pose.rotation_enu_camera.ravel(), *pose.position_enu_m)
    if not np.isfinite(numbers).all() or not height_m >= LEAST_HEIGHT_M:
        raise PoseError(
            f"expected a camera at least {LEAST_HEIGHT_M:g} m above the ground plane, got "
            f"{height_m:.2f} m; no ground image is made on the ground"
        )
    step = lattice_step(grid, camera, height_m)
    # cv2.resize by `step` takes its input as the middles of blocks of cells: place the nodes there,
    # with one more block on each side, so that no cell lies outside the lattice.
    east = grid.west_m + (_lattice(grid.cols, step) + 0.5) * grid.cell_m
    north = grid.north_m - (_lattice(grid.rows, step) + 0.5) * grid.cell_m
    nodes = _pixels_seeing(camera, pose, east, north)
    planes = (scratch or MapScratch()).planes(len(north) * step, len(east) * step)
    for axis, plane in enumerate(planes):
        coarse = nodes[..., axis].astype(np.float32)
        cv2.resize(coarse, plane.shape[::-1], dst=plane, interpolation=cv2.INTER_LINEAR)
    inner = np.s_[step : step + grid.rows, step : step + grid.cols]
    return planes[0][inner], planes[1][inner]


def lattice_step(grid: GroundGrid, camera: OmnidirectionalCamera, height_m: float) -> int:
    """Return the lattice spacing in cells that keeps the interpolation error within its budget.

    The error of bilinear interpolation is at most step^2 / 8 times the second derivative per axis.
    """
    bending = BENDING * camera.profile.steepest_px_per_rad() / height_m**2
    step_m = np.sqrt(4.0 * INTERPOLATION_BUDGET_PX / bending)
    return int(np.clip(step_m / grid.cell_m, 1, LARGEST_LATTICE_STEP))


def _lattice(cells: int, step: int) -> FloatArray:
    blocks = -(-cells // step) + 2
    nodes: FloatArray = (np.arange(blocks, dtype=np.float64) - 0.5) * step - 0.5
    return nodes


def _pixels_seeing(
    camera: OmnidirectionalCamera, pose: CameraPose, east_m: FloatArray, north_m: FloatArray
) -> FloatArray:
    """Return (N, M, 2) pixels that see the ground plane at N norths and M easts."""
    rotation, position = pose.rotation_enu_camera, pose.position_enu_m
    # The ray's camera components are sums of a term by column, one by row and a constant.
    by_col = np.multiply.outer(east_m - position[0], rotation[0])
    by_row = np.multiply.outer(north_m - position[1], rotation[1])
    rays = by_col[np.newaxis] + by_row[:, np.newaxis] - position[2] * rotation[2]
    return camera.project_beyond_range(rays, fast=True)
