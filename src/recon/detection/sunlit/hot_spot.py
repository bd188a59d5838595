"""The hot spot: opposite the sun, sunlit ground hides its own shadows and is brighter.

In shade it is absent, so it tells a view that is all in sun from one that is all in shade. The
land has bright spots too, but they stand still: the hot spot moves over the land with the sun
(0.25 degrees a minute) and with the drone. Only that motion is used.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import cv2
import numpy as np
import numpy.typing as npt

from recon.detection.sunlit.colour import COARSE, CellColour
from recon.detection.sunlit.land import FloatStack
from recon.model.geo import GroundGrid
from recon.model.imagery import GroundImage
from recon.model.shade import FloatMap, MaskMap

FOLD_DEG = 6.0
"""Angle at which it falls to 1/e: 4 to 8 degrees over crops."""
REACH_DEG = 24.0
"""Cells farther from its middle are not used."""
ALIKE = 6.0
"""Samples that are wrong together: neighbours, and frames of one drift of the drone."""
LEAST_CELLS, LEAST_FRAMES = 20, 4
BRIGHTEST = 0.7
"""Linear light (level 217) above which tone curves flatten: dry soil in full sun hides it."""
WORST_ERROR = 0.04
"""Largest standard error of a strength that is believed: moving edges of shade give larger ones."""
BETWEEN = 0.06
"""The strength that a view in shade stays below, and one in sun above. Crops have 0.2 to 0.6, of
which the coarse cells show half at least, and less where a tone curve flattens; shade shows 0.00 to
0.02."""
ROUNDS, FARTHEST, EVEN = 5, 3.0, 4.0
"""Rounds of the fit; standard deviations at which a sample is cut off; bound of the weights."""
SURE = 3.0
"""Standard errors between the strength and the bound."""


class FlatScene(Enum):
    """What the hot spot shows about a view without an edge of shade."""

    UNKNOWN = "unknown"
    SUN = "sun"
    SHADE = "shade"


@dataclass(frozen=True, slots=True)
class HotSpot:
    """Brightness of the hot spot over its surround, less 1, and its standard error."""

    strength: float
    standard_error: float
    least: float
    most: float
    """Largest of the strengths on each side of its middle: a hot spot has equal ones, moving shade
    has not."""

    @property
    def scene(self) -> FlatScene:
        """Return what it shows."""
        if self.standard_error > WORST_ERROR:
            return FlatScene.UNKNOWN
        margin = SURE * self.standard_error
        if self.strength - margin > BETWEEN and self.least > BETWEEN:
            return FlatScene.SUN
        if self.strength + margin < BETWEEN and self.most < BETWEEN:
            return FlatScene.SHADE
        return FlatScene.UNKNOWN


def shape_of(image: GroundImage, grid: GroundGrid) -> FloatMap | None:
    """Return the hot spot's shape (r, c) on the coarse cells of `grid`, 1 in its middle.

    None without the sun's direction.
    """
    sun = image.toward_sun_enu
    if sun is None or not np.any(sun):
        return None
    cell_m = COARSE * grid.cell_m
    east, north, up = (float(part) for part in image.pose.position_enu_m)
    east_m = grid.west_m + (np.arange(grid.cols // COARSE) + 0.5) * cell_m - east
    north_m = grid.north_m - (np.arange(grid.rows // COARSE) + 0.5) * cell_m - north
    along = np.add.outer(-sun[1] * north_m, -sun[0] * east_m) + sun[2] * up
    cosine = along / np.sqrt(np.add.outer(north_m**2, east_m**2) + up**2)
    angle_deg = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    shape: FloatMap = np.exp(-angle_deg / FOLD_DEG).astype(np.float32)
    return shape


def with_detail(cells: CellColour) -> FloatMap:
    """Return the log light of cells that are not so bright that a hot spot would not show."""
    return np.where(cells.brightest < BRIGHTEST, cells.light, np.float32(np.nan))


def hot_spot(light: FloatStack, shapes: Sequence[FloatMap | None]) -> HotSpot | None:
    """Return the hot spot that moves through frames of log light (K, r, c); None without one.

    Weighted least squares of light on shape, both less each cell's mean over time and each frame's
    mean.
    """
    used = [i for i, shape in enumerate(shapes) if shape is not None]
    if len(used) < LEAST_FRAMES:
        return None
    shape = np.stack([each for each in shapes if each is not None])
    seen = np.isfinite(light[used]).all(axis=0)
    # A cell at the rim is half seen, and the lens is darkest there.
    inside = cv2.erode(np.asarray(seen, np.uint8), np.ones((3, 3), np.uint8)) > 0
    near: MaskMap = (shape.max(axis=0) > np.exp(-REACH_DEG / FOLD_DEG)) & inside
    if np.count_nonzero(near) < LEAST_CELLS:
        return None
    cells, theirs = light[used][:, near], shape[:, near]
    whole = _fitted(cells, theirs)
    halves = [_fitted(cells[:, half], theirs[:, half])[0] for half in _halves(shape, near)]
    return HotSpot(*whole, min(halves), max(halves))


def _halves(shape: FloatStack, near: MaskMap) -> Sequence[npt.NDArray[np.bool_]]:
    """Return which near cells (N,) lie east, west, south and north of its middle."""
    rows, cols = np.nonzero(near)
    weight = shape.max(axis=0)[near]
    east, south = cols > np.average(cols, weights=weight), rows > np.average(rows, weights=weight)
    return east, ~east, south, ~south


def _fitted(light: FloatStack, shape: FloatStack) -> tuple[float, float]:
    """Return the strength that explains light (K, N) by the shape, and its standard error.

    Frames and cells count by how little is left in them: shade that moves over some of the view, or
    through some of the frames, must not hide what the others show.
    """
    by_frame, by_cell = (
        np.ones((len(light), 1), np.float32),
        np.ones((1, light.shape[1]), np.float32),
    )
    strength, error = 0.0, np.inf
    for _ in range(ROUNDS):
        change, expected = (_centred(each, by_frame, by_cell) for each in (light, shape))
        weight = by_frame * by_cell
        power = max(float((weight * expected**2).sum()), 1e-9)
        # A few samples that are far off (a vehicle, an error of place) must not decide. Far off the
        # fit: a drone that hovered and then looked aside has few samples that the hot spot changed.
        rest = change - strength * expected
        most = FARTHEST * 1.48 * float(np.median(np.abs(rest)))
        rest = np.clip(rest, -most, most)
        strength += float((weight * rest * expected).sum()) / power
        error = float(np.sqrt(ALIKE * (weight * rest**2).mean() / weight.mean() / power))
        by_frame = _weights(rest**2 * by_cell, 1)
        by_cell = _weights(rest**2 * by_frame, 0)
    return strength, error


def _weights(squares: FloatStack, axis: int) -> FloatStack:
    """Return weights along the other axis, 1 on average; those that fit best count no more than
    EVEN times as much as usual ones."""
    variance = squares.mean(axis=axis, keepdims=True)
    weight = 1.0 / np.maximum(variance, max(float(np.median(variance)) / EVEN, 1e-12))
    weights: FloatStack = (weight / weight.mean()).astype(np.float32)
    return weights


def _centred(values: FloatStack, by_frame: FloatStack, by_cell: FloatStack) -> FloatStack:
    values = values - (by_frame * values).mean(axis=0) / by_frame.mean()
    centred: FloatStack = values - (by_cell * values).mean(axis=1, keepdims=True) / by_cell.mean()
    return centred
