"""Frames laid on the ground: east-north rasters seen straight from above.

For each cell of the grid the pixel that sees it is computed on a coarse lattice and interpolated
bilinearly (the lattice is as fine as the camera's height asks, so that this costs under 0.1 px),
then `cv2.remap` fetches the colours. The ground is the plane at the frame's origin height: terrain
that rises above it by h is seen displaced outwards by h tan(angle from the vertical).

Callers that bound their threads call `cv2.setNumThreads(1)` once; the result does not depend on it.
"""

from collections import OrderedDict
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from recon.camera.decode import decode_frame
from recon.camera.errors import PoseError
from recon.camera.image_circle import ImageCircle, find_image_circle
from recon.camera.omnidirectional import OmnidirectionalCamera
from recon.model.geo import GroundGrid
from recon.model.imagery import CameraPose, Frame, GroundImage, Registration, RgbImage

FloatArray = npt.NDArray[np.float64]
MapArray = npt.NDArray[np.float32]
MaskArray = npt.NDArray[np.uint8]

LARGEST_LATTICE_STEP = 16
"""In cells. Coarser saves nothing more: remap dominates."""
INTERPOLATION_BUDGET_PX = 0.08
"""What bilinear interpolation may miss; the test's bound is 0.1 px."""
BENDING = 1.2
"""|d2 u / ds2| <= BENDING f / h^2 along the ground, f in px/rad, h the height; 0.65 for a lens of
constant f that looks straight down, more when tilted; held by the test over random poses."""
LEAST_HEIGHT_M = 1.0
"""Under this a camera is on the ground and sees no field."""
MOST_SIZES_KEPT = 4
MOST_CIRCLE_SEARCHES = 5
"""Frames of one size searched for the lit circle: a first frame may be dark or half received."""
ROWS_AT_ONCE = 128
"""Rows of a mask computed together: bounds the memory, which is large at 3840 x 2160."""


@dataclass(frozen=True, slots=True, eq=False)
class _Source:
    """What is known of frames of one size: the camera there and which pixels show something."""

    camera: OmnidirectionalCamera
    mask: MaskArray
    """(rows, cols): 255 where a pixel lies in the image circle, else 0."""
    searches_left: int
    """How many more frames are searched for the lit circle; 0 once it is known."""


class GroundProjector:
    """Lays frames of one camera on one grid.

    `circle` is the lens's lit circle at the model's size; without it, it is looked for in the first
    frames of each size, and the same frames in the same order give the same ground images. Nothing
    but a few frame sizes' masks is kept from one call to the next.
    """

    def __init__(
        self, grid: GroundGrid, camera: OmnidirectionalCamera, circle: ImageCircle | None = None
    ) -> None:
        self.grid = grid
        self.camera = camera
        self._circle = circle
        self._sources: OrderedDict[tuple[int, int], _Source] = OrderedDict()

    def lay(self, frame: Frame, pose: CameraPose) -> GroundImage:
        """Return the frame on the ground.

        Raises `FrameDecodeError` for an unreadable frame, `FrameSizeError` for one of another
        aspect ratio than the camera's, `PoseError` for a camera that is not above the ground.
        """
        rgb, valid = self.lay_pixels(decode_frame(frame), pose)
        return GroundImage(
            grid=self.grid,
            frame_id=frame.id,
            captured_at_ns=frame.captured_at_ns,
            rgb=rgb,
            valid=valid,
            pose=pose,
            registration=Registration.UNREGISTERED,
        )

    def lay_pixels(self, rgb: RgbImage, pose: CameraPose) -> tuple[RgbImage, npt.NDArray[np.bool_]]:
        """Return (R, C, 3) colours, black where invalid, and (R, C) validity; raises as `lay`."""
        source = self._source(rgb)
        col_map, row_map = ground_maps(self.grid, source.camera, pose)
        seen = cv2.remap(source.mask, col_map, row_map, cv2.INTER_NEAREST)
        laid = cv2.remap(rgb, col_map, row_map, cv2.INTER_LINEAR)
        shown = cv2.bitwise_and(laid, laid, mask=seen)
        return shown.astype(np.uint8, copy=False), seen > 0

    def _source(self, rgb: RgbImage) -> _Source:
        size = (rgb.shape[0], rgb.shape[1])
        source = self._sources.get(size)
        if source is None or source.searches_left > 0:
            searches = MOST_CIRCLE_SEARCHES if source is None else source.searches_left
            source = self._sources[size] = self._searched_source(rgb, searches)
            if len(self._sources) > MOST_SIZES_KEPT:
                self._sources.popitem(last=False)
        return source

    def _searched_source(self, rgb: RgbImage, searches: int) -> _Source:
        camera = self.camera.scaled_to(rgb.shape[0], rgb.shape[1])
        if self._circle is not None:
            known = self._circle.scaled(camera.cols / self.camera.cols)
            return _Source(camera, source_mask(camera, known), searches_left=0)
        found = find_image_circle(rgb, camera)
        searches_left = searches - 1 if found is None else 0
        return _Source(camera, source_mask(camera, found), searches_left)


def source_mask(camera: OmnidirectionalCamera, circle: ImageCircle | None) -> MaskArray:
    """Return (rows, cols) uint8: 255 for pixels in the lens's valid range and lit circle, else 0.

    The frame's outermost pixels are left out: interpolation there would reach outside.
    """
    mask = np.zeros((camera.rows, camera.cols), dtype=np.uint8)
    cols = np.arange(1, camera.cols - 1, dtype=np.float64)
    for first in range(1, camera.rows - 1, ROWS_AT_ONCE):
        rows = np.arange(first, min(first + ROWS_AT_ONCE, camera.rows - 1), dtype=np.float64)
        col, row = np.meshgrid(cols, rows)
        is_shown = camera.is_in_range(np.stack([col, row], axis=-1))
        if circle is not None:
            is_shown &= circle.contains(col, row)
        mask[first : first + len(rows), 1:-1] = np.where(is_shown, np.uint8(255), np.uint8(0))
    return mask


def ground_maps(
    grid: GroundGrid, camera: OmnidirectionalCamera, pose: CameraPose
) -> tuple[MapArray, MapArray]:
    """Return the pixel column and row, each (R, C) float32, that see each cell's centre.

    Beyond the lens's range the numbers go on smoothly and mean nothing: mask them. Raises
    `PoseError` for a camera that is not above the ground.
    """
    height_m = float(pose.position_enu_m[2])
    numbers = (*pose.rotation_enu_camera.ravel(), *pose.position_enu_m)
    if not np.isfinite(numbers).all() or not height_m >= LEAST_HEIGHT_M:
        raise PoseError(
            f"expected a camera at least {LEAST_HEIGHT_M:g} m above the ground plane, got "
            f"{height_m:.2f} m; no ground image is made on the ground"
        )
    step = lattice_step(grid, camera, height_m)
    # Lattice nodes lie where cv2.resize by `step` expects them: in the middle of blocks of cells,
    # with one block more on each side, so that no cell lies outside the lattice.
    east = grid.west_m + (_lattice(grid.cols, step) + 0.5) * grid.cell_m
    north = grid.north_m - (_lattice(grid.rows, step) + 0.5) * grid.cell_m
    nodes = _pixels_seeing(camera, pose, east, north).astype(np.float32)
    wide = (nodes.shape[1] * step, nodes.shape[0] * step)
    fine = cv2.resize(nodes, wide, interpolation=cv2.INTER_LINEAR) if step > 1 else nodes
    inner = fine[step : step + grid.rows, step : step + grid.cols]
    col_map, row_map = cv2.split(inner)
    return col_map.astype(np.float32, copy=False), row_map.astype(np.float32, copy=False)


def lattice_step(grid: GroundGrid, camera: OmnidirectionalCamera, height_m: float) -> int:
    """Return the lattice's spacing in cells that keeps the interpolation inside its budget.

    Bilinear interpolation misses at most step^2 / 8 times the bending along each of two axes.
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
