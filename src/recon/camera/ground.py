"""Orthorectification: frames projected onto an east-north grid on the ground plane.

`recon.camera.ground` gives the pixel that sees each cell, `cv2.remap` samples the colours. The
ground is the plane at the local frame's origin height: terrain that rises above it by h appears
displaced outwards by h tan(angle from the vertical).

Callers that limit threads call `cv2.setNumThreads(1)` once; the result does not depend on it.

The pixel that sees each cell is computed on a coarse lattice and interpolated bilinearly. The
lattice spacing follows from the camera's height, so that the error stays under 0.1 px.
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
from recon.camera.sight import COARSEST_M, farthest_sight_m, sight2_m2
from recon.model.arrays import FloatArray
from recon.model.geo import GroundGrid
from recon.model.imagery import CameraPose, Frame, GroundImage, Registration, RgbImage

MapArray = npt.NDArray[np.float32]

LARGEST_LATTICE_STEP = 16
"""Largest step in cells. Coarser saves nothing: `cv2.remap` dominates."""
INTERPOLATION_BUDGET_PX = 0.09
"""Allowed error of the interpolation; the test's bound is 0.1 px."""
BENDING = 0.85
"""Bound of the maps' second derivative along the ground, in units of f / h^2 (f in px/rad, h the
height): 0.46 measured for a camera pointing straight down, 0.77 for a tilt of 60 degrees; a test
over random poses checks it."""
LEAST_HEIGHT_M = 1.0
"""Least height: below it the camera is on the ground and sees no field."""


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


MaskArray = npt.NDArray[np.uint8]

MOST_SIZES_KEPT = 4
MOST_CIRCLE_SEARCHES = 5
"""Frames of one size searched for the image circle: a first frame may be dark or incomplete."""
ROWS_AT_ONCE = 128
"""Rows of a mask computed together, to bound memory at 3840 x 2160."""


@dataclass(frozen=True, slots=True, eq=False)
class _Source:
    """Camera model and valid pixels for frames of one size."""

    camera: OmnidirectionalCamera
    circle: ImageCircle | None
    mask: MaskArray
    """(rows, cols): 255 where a pixel lies in the image circle, else 0."""
    searches_left: int
    """How many more frames are searched for the image circle; 0 once it is known."""


class GroundProjector:
    """Projects frames of one camera onto one grid.

    `circle` is the image circle at the model's size; None: it is searched for in the first frames
    of each size, and the same frames in the same order give the same ground images. Only the masks
    of a few frame sizes are kept between calls. Not thread-safe.
    """

    def __init__(
        self, grid: GroundGrid, camera: OmnidirectionalCamera, circle: ImageCircle | None = None
    ) -> None:
        self.grid = grid
        self.camera = camera
        self._circle = circle
        self._sources: OrderedDict[tuple[int, int], _Source] = OrderedDict()
        # Buffers reused from frame to frame; returned arrays are always new.
        self._scratch = MapScratch()
        self._whole: cv2.typing.MatLike | None = None
        self._fraction: cv2.typing.MatLike | None = None
        self._projected: cv2.typing.MatLike | None = None

    def project(self, frame: Frame, pose: CameraPose) -> GroundImage:
        """Return the frame as a ground image, marked as unregistered.

        Raises `FrameDecodeError` for an unreadable frame, `FrameSizeError` for another aspect ratio
        than the camera's, `PoseError` for a camera that is not above the ground.
        """
        return self.project_decoded(frame, decode_frame(frame), pose)

    def project_decoded(self, frame: Frame, pixels: RgbImage, pose: CameraPose) -> GroundImage:
        """Return `project` of a frame whose pixels (rows, cols, 3) are decoded already."""
        rgb, valid = self.project_pixels(pixels, pose)
        return GroundImage(
            grid=self.grid,
            frame_id=frame.id,
            captured_at_ns=frame.captured_at_ns,
            rgb=rgb,
            valid=valid,
            pose=pose,
            registration=Registration.UNREGISTERED,
            serial=frame.serial,
            pixels_per_radian=self.camera.pixels_per_radian,
        )

    def project_pixels(
        self, rgb: RgbImage, pose: CameraPose
    ) -> tuple[RgbImage, npt.NDArray[np.bool_]]:
        """Return (R, C, 3) RGB, black where invalid, and (R, C) validity; raises as `project`."""
        source = self._source(rgb)
        maps = ground_maps(self.grid, source.camera, pose, self._scratch)
        # Fixed-point maps (1/32 px) are twice as fast as float maps, conversion included.
        self._whole, self._fraction = cv2.convertMaps(
            *maps, cv2.CV_16SC2, dstmap1=self._whole, dstmap2=self._fraction
        )
        seen = cv2.remap(source.mask, *maps, cv2.INTER_NEAREST)
        seen[self._is_too_far(pose)] = 0
        self._projected = cv2.remap(
            rgb, self._whole, self._fraction, cv2.INTER_LINEAR, dst=self._projected
        )
        # remap samples meaningless pixels beyond the lens: blacken them.
        shown = cv2.bitwise_and(self._projected, self._projected, mask=seen)
        return shown.astype(np.uint8, copy=False), seen > 0

    def _is_too_far(self, pose: CameraPose) -> npt.NDArray[np.bool_]:
        """(R, C): the cells at which a pixel shows too much ground."""
        height_m = float(pose.position_enu_m[2])
        most_m = farthest_sight_m(height_m, self.camera.pixels_per_radian, COARSEST_M)
        too_far: npt.NDArray[np.bool_] = sight2_m2(self.grid, pose.position_enu_m) > most_m**2
        return too_far

    def lens_of(self, rgb: RgbImage) -> tuple[OmnidirectionalCamera, ImageCircle | None] | None:
        """Return lens and image circle for frames like this one; None while it is searched for."""
        source = self._source(rgb)
        return None if source.searches_left > 0 else (source.camera, source.circle)

    def _source(self, rgb: RgbImage) -> _Source:
        size = (rgb.shape[0], rgb.shape[1])
        source = self._sources.get(size)
        if source is None or source.searches_left > 0:
            searches = MOST_CIRCLE_SEARCHES if source is None else source.searches_left
            source = self._sources[size] = self._searched_source(rgb, searches)
            # The oldest size goes: an app may change its resolution, but hardly ever back and
            # forth.
            if len(self._sources) > MOST_SIZES_KEPT:
                self._sources.popitem(last=False)
        return source

    def _searched_source(self, rgb: RgbImage, searches: int) -> _Source:
        camera = self.camera.scaled_to(rgb.shape[0], rgb.shape[1])
        if self._circle is not None:
            known = self._circle.scaled(camera.cols / self.camera.cols)
            return _Source(camera, known, source_mask(camera, known), searches_left=0)
        found = find_image_circle(rgb, camera)
        searches_left = searches - 1 if found is None else 0
        return _Source(camera, found, source_mask(camera, found), searches_left)


def source_mask(camera: OmnidirectionalCamera, circle: ImageCircle | None) -> MaskArray:
    """Return (rows, cols) uint8: 255 for pixels in the lens's valid range and image circle, else 0.

    The frame's outermost pixels are excluded: interpolation there would reach outside.
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
