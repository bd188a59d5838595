"""Sampling of a frame on the field grid: mean light of each cell."""

from dataclasses import dataclass
from functools import lru_cache
from math import ceil
from typing import Protocol

import cv2
import numpy as np
import numpy.typing as npt

from recon.detection.settings import DetectionSettings
from recon.model.geo import GroundGrid
from recon.model.imagery import GroundImage
from recon.model.shade import FloatMap, MaskMap

GREEN = 1
"""Channel used: white balance changes red and blue against green, and shade is bluer than sun."""


@dataclass(frozen=True, slots=True, eq=False)
class CellLight:
    """One frame on the field's grid: `light` (R, C) in (0, 1], NaN where not `seen`."""

    light: FloatMap
    seen: MaskMap


class CellSamples(Protocol):
    """One frame on the field's grid: `light` (R, C), NaN where not `seen`."""

    @property
    def light(self) -> FloatMap:
        """Light, in any unit that tells two frames apart."""
        ...

    @property
    def seen(self) -> MaskMap:
        """Whether the frame shows the cell."""
        ...


def field_grid(image_grid: GroundGrid, settings: DetectionSettings) -> GroundGrid:
    """Return the grid of all shade maps of a flight."""
    if settings.grid is not None:
        return settings.grid
    # Never finer than the image: interpolated cells would pretend to a resolution.
    cell_m = max(settings.cell_m, image_grid.cell_m)
    rows, cols = (
        # Less a rounding error, so that an exact multiple does not get one more cell.
        ceil(cells * image_grid.cell_m / cell_m - 1e-6)
        for cells in (image_grid.rows, image_grid.cols)
    )
    return GroundGrid(image_grid.frame, image_grid.west_m, image_grid.north_m, cell_m, rows, cols)


def cell_light(image: GroundImage, grid: GroundGrid, settings: DetectionSettings) -> CellLight:
    """Return a frame's mean light over each cell of `grid`.

    Both grids are of one local frame and may be offset by any amount. Light is linear (gamma
    removed); invalid pixels do not count.
    """
    # LUT before averaging: the mean of levels is not the level of the mean light.
    levels = np.ascontiguousarray(image.rgb[..., GREEN])
    shown = image.valid.astype(np.float32)
    light = cv2.LUT(levels, light_of_levels(settings.gamma)) * shown
    both = box_means(np.dstack([light, shown]), image.grid, grid)
    seen = both[..., 1] >= settings.least_seen
    # Divide by the visible share: cells cut by the edge of the frame keep their brightness.
    mean = np.where(seen, both[..., 0] / np.maximum(both[..., 1], 1e-6), np.nan)
    return CellLight(mean.astype(np.float32), seen)


def box_means(
    values: npt.NDArray[np.float32], projected: GroundGrid, grid: GroundGrid
) -> npt.NDArray[np.float32]:
    """Return (R, C, K) means of (r, c, K) values over boxes as large as a cell of `grid`.

    Exact where the cells' edges coincide, else interpolated between boxes. Outside counts as 0.
    """
    ratio = grid.cell_m / projected.cell_m
    box = max(1, round(ratio))
    means = cv2.blur(values, (box, box), borderType=cv2.BORDER_CONSTANT)
    # OpenCV writes the mean of an even box half a pixel after the middle of the box.
    middle = -0.5 + (0.5 if box % 2 == 0 else 0.0)
    first_col = (grid.west_m - projected.west_m) / projected.cell_m + ratio / 2.0 + middle
    first_row = (projected.north_m - grid.north_m) / projected.cell_m + ratio / 2.0 + middle
    to_projected = np.array([[ratio, 0.0, first_col], [0.0, ratio, first_row]])
    sampled = cv2.warpAffine(
        means,
        to_projected,
        (grid.cols, grid.rows),
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_CONSTANT,
    )
    return sampled.astype(np.float32, copy=False)


@lru_cache(maxsize=4)
def light_of_levels(gamma: float) -> npt.NDArray[np.float32]:
    """Return the light (256,) of each level; level 0 counts as 0.5, so that ratios are finite."""
    levels = np.maximum(np.arange(256), 0.5) / 255.0
    light: npt.NDArray[np.float32] = (levels**gamma).astype(np.float32)
    return light
