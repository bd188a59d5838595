"""Light and colour of each cell of a frame."""

from dataclasses import dataclass

import cv2
import numpy as np

from recon.detection.cells import box_means, light_of_levels
from recon.detection.settings import DetectionSettings
from recon.model.geo import GroundGrid
from recon.model.imagery import GroundImage
from recon.model.shade import FloatMap, MaskMap

COARSE = 2
"""Field cells across a coarse cell: shadow edges are tens of metres wide, noise is not."""


@dataclass(frozen=True, slots=True, eq=False)
class CellColour:
    """`light` and `colour` (R, C), NaN where not `seen`."""

    light: FloatMap
    colour: FloatMap
    seen: MaskMap
    brightest: FloatMap
    """Linear light of the brightest channel, of the sensor's most: near 1 it shows no detail."""

    def coarse(self) -> "CellColour":
        """Return means over blocks of cells, rows and columns cut to whole blocks."""
        light, colour = block_means(self.light), block_means(self.colour)
        return CellColour(light, colour, np.isfinite(light), block_means(self.brightest))


def cell_colour(image: GroundImage, grid: GroundGrid, settings: DetectionSettings) -> CellColour:
    """Return a frame's light and colour on `grid`, from linear light averaged over each cell."""
    shown = image.valid.astype(np.float32)
    light = cv2.LUT(image.rgb, light_of_levels(settings.gamma))
    stacked = cv2.merge([*cv2.split(light * shown[..., np.newaxis]), shown])
    means = box_means(np.asarray(stacked, dtype=np.float32), image.grid, grid)
    share = means[..., 3]
    seen: MaskMap = share >= settings.least_seen
    darkest = np.float32(light_of_levels(settings.gamma)[0])
    rgb = np.maximum(means[..., :3] / np.maximum(share, 1e-6)[..., np.newaxis], darkest)
    red, green, blue = (np.where(seen, np.log(rgb[..., i]), np.nan) for i in range(3))
    brightest = np.where(seen, rgb.max(axis=-1), np.nan).astype(np.float32)
    return CellColour(green.astype(np.float32), (blue - red).astype(np.float32), seen, brightest)


def block_means(values: FloatMap) -> FloatMap:
    """Return the means of what is seen in COARSE x COARSE blocks; NaN where less than half is."""
    rows, cols = (size // COARSE for size in values.shape)
    cut = values[: rows * COARSE, : cols * COARSE]
    blocks = cut.reshape(rows, COARSE, cols, COARSE)
    shown = np.isfinite(blocks)
    count = np.count_nonzero(shown, axis=(1, 3))
    total = np.where(shown, blocks, np.float32(0.0)).sum(axis=(1, 3))
    means = np.where(2 * count >= COARSE**2, total / np.maximum(count, 1), np.nan)
    return means.astype(np.float32)


def upsampled(values: FloatMap, shape: tuple[int, ...]) -> FloatMap:
    """Return coarse values interpolated on the field grid of `shape`, a cell beyond their rim."""
    rows, cols = values.shape
    size = cols * COARSE, rows * COARSE
    fine = cv2.resize(_with_rim(values), size, interpolation=cv2.INTER_LINEAR)
    missing = (0, shape[0] - rows * COARSE, 0, shape[1] - cols * COARSE)
    # An odd last row or column repeats its neighbour.
    whole = cv2.copyMakeBorder(fine, *missing, cv2.BORDER_REPLICATE)
    return np.asarray(whole, dtype=np.float32)


def _with_rim(values: FloatMap) -> FloatMap:
    """Return values whose neighbours without one have the mean of those around them."""
    for _ in range(2):  # interpolation needs one cell more than is wanted
        known = np.isfinite(values)
        share = cv2.blur(known.astype(np.float32), (3, 3))
        mean = cv2.blur(np.where(known, values, np.float32(0.0)), (3, 3))
        filled = np.where(share > 0.0, mean / np.maximum(share, 1e-6), np.nan)
        values = np.where(known, values, filled).astype(np.float32)
    return values
