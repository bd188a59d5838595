"""The image circle of a fisheye lens: outside it a frame is black.

The calibration does not contain it (its polynomial continues), so it comes from the site's file, or
is found in a frame: a circle is fitted to the first clearly lit pixel from outside, in each of 180
directions.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from recon.camera.omnidirectional import OmnidirectionalCamera
from recon.model.arrays import FloatArray
from recon.model.imagery import RgbImage

DIRECTIONS = 180
LIT_LEVEL = 32
"""Level of 255. Stray light outside the circle is below about 15 in real frames."""
LEAST_HIT_SHARE = 0.4
"""Share of directions with an edge; fewer: the lens fills the frame, or the frame is dark."""
LARGEST_SPREAD_SHARE = 0.02
"""Share of the radius: edges farther than this from one circle are the scene's, not the rim's."""
RIM_SHARE = 0.02
"""Outer part of the radius that is excluded: it is dark and blurred."""


@dataclass(frozen=True, slots=True)
class ImageCircle:
    """The image circle of frames of one size, in pixels."""

    centre_col_px: float
    centre_row_px: float
    radius_px: float

    def contains(self, col_px: FloatArray, row_px: FloatArray) -> npt.NDArray[np.bool_]:
        """Return whether pixels lie within the circle; shapes broadcast."""
        across_squared = (col_px - self.centre_col_px) ** 2 + (row_px - self.centre_row_px) ** 2
        is_inside: npt.NDArray[np.bool_] = across_squared <= self.radius_px**2
        return is_inside

    def scaled(self, scale: float) -> "ImageCircle":
        """Return the circle in frames `scale` times as large (pixel centres, as `scaled_to`)."""
        return ImageCircle(
            (self.centre_col_px + 0.5) * scale - 0.5,
            (self.centre_row_px + 0.5) * scale - 0.5,
            self.radius_px * scale,
        )


def find_image_circle(rgb: RgbImage, camera: OmnidirectionalCamera) -> ImageCircle | None:
    """Return the image circle of a frame (rows, cols, 3), or None without one.

    `camera` is the model at the frame's size; its centre is the start of the search.
    """
    edge = _outermost_lit(rgb.max(axis=2) >= LIT_LEVEL, camera)
    if len(edge) < LEAST_HIT_SHARE * DIRECTIONS:
        return None
    circle = _circle_through(edge)
    # Three rounds of rejecting outliers: bright scenery and dark sectors pull the first fit.
    for _ in range(3):
        misses = np.abs(np.hypot(edge[:, 0] - circle[0], edge[:, 1] - circle[1]) - circle[2])
        kept = edge[misses <= max(2.0 * float(np.median(misses)), 1.0)]
        if len(kept) < 3:
            return None
        circle = _circle_through(kept)
    if not float(np.median(misses)) <= LARGEST_SPREAD_SHARE * circle[2]:
        return None
    return ImageCircle(circle[0], circle[1], circle[2] * (1.0 - RIM_SHARE))


def _outermost_lit(is_lit: npt.NDArray[np.bool_], camera: OmnidirectionalCamera) -> FloatArray:
    """Return (N, 2) col, row of the outermost lit pixel in each direction with a dark rim."""
    # From outside inwards: dark scenery inside the circle must not count as its edge.
    angles = np.arange(DIRECTIONS) * (2.0 * np.pi / DIRECTIONS)
    radii = np.arange(1.0, np.hypot(camera.rows, camera.cols))
    cols = camera.centre_col_px + np.outer(np.cos(angles), radii)
    rows = camera.centre_row_px + np.outer(np.sin(angles), radii)
    col_indices, row_indices = np.rint(cols).astype(int), np.rint(rows).astype(int)
    is_inside = (col_indices >= 0) & (col_indices < camera.cols)
    is_inside &= (row_indices >= 0) & (row_indices < camera.rows)
    lit = is_lit[np.where(is_inside, row_indices, 0), np.where(is_inside, col_indices, 0)]
    lit &= is_inside
    last_lit = lit.shape[1] - 1 - np.argmax(lit[:, ::-1], axis=1)
    last_inside = is_inside.sum(axis=1) - 1
    # A direction that is lit up to the frame's edge shows no rim: the frame cuts the circle.
    has_rim = lit.any(axis=1) & (last_lit < last_inside - 2)
    chosen = np.flatnonzero(has_rim)
    return np.stack([cols[chosen, last_lit[chosen]], rows[chosen, last_lit[chosen]]], axis=1)


def _circle_through(points: FloatArray) -> tuple[float, float, float]:
    """Return centre col, row and radius of the least-squares circle (Kasa 1976) through (N, 2)."""
    middle = points.mean(axis=0)
    x, y = (points - middle).T
    design = np.stack([x, y, np.ones_like(x)], axis=1)
    (a, b, c), *_ = np.linalg.lstsq(design, x * x + y * y, rcond=None)
    radius_squared = c + (a * a + b * b) / 4.0
    return (
        float(middle[0] + a / 2.0),
        float(middle[1] + b / 2.0),
        float(np.sqrt(max(radius_squared, 0.0))),
    )
