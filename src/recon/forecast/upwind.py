"""What is upwind of each cell, and for how long the path there is in view."""

from typing import TypeAlias

import cv2
import numpy as np
import numpy.typing as npt

from recon.forecast.motion import ShadowMotion
from recon.forecast.settings import ForecastSettings
from recon.model.geo import GroundGrid
from recon.model.shade import FloatMap, MaskMap

Cells: TypeAlias = npt.NDArray[np.intp]


def without_single_gaps(known: MaskMap) -> MaskMap:
    """Return (R, C): the known cells, and the unknown ones in gaps up to two cells wide.

    Shadows' edges are wider than such a gap, and one unknown cell must not end the horizon of all
    cells downwind of it.
    """
    gaps = cv2.morphologyEx(known.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((3, 3), np.uint8))
    return gaps > 0


def visible_upwind_s(
    seen: MaskMap, grid: GroundGrid, motion: ShadowMotion, settings: ForecastSettings
) -> FloatMap:
    """Return (R, C): for how long, in s, the place upwind of each cell is visible without a gap.

    0 where the cell itself is not visible; at most the last lead.
    """
    horizon_s = np.zeros(seen.shape, dtype=np.float32)
    alive = seen.copy()
    lead_s = 0.0
    while lead_s < settings.lead_s[-1] and alive.any():
        lead_s = min(lead_s + settings.horizon_step_s, settings.lead_s[-1])
        # A gap ends the horizon for good: what comes after it was not observed continuously.
        alive &= _is_visible_upwind(seen, grid, motion, lead_s)
        horizon_s[alive] = lead_s
    return horizon_s


def _is_visible_upwind(
    seen: MaskMap, grid: GroundGrid, motion: ShadowMotion, lead_s: float
) -> MaskMap:
    """Return (R, C): whether the place upwind of each cell at a lead is visible now."""
    to_now = upwind(grid, motion, lead_s)
    size = (grid.cols, grid.rows)
    how = cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP
    return cv2.warpAffine(seen.astype(np.uint8), to_now, size, flags=how) > 0


def upwind(grid: GroundGrid, motion: ShadowMotion, lead_s: float) -> npt.NDArray[np.float64]:
    """Return the affine map (2, 3) from a cell's column and row to those of its upwind place."""
    # Rows count from the north: north is negative.
    right = motion.east_mps * lead_s / grid.cell_m
    down = -motion.north_mps * lead_s / grid.cell_m
    return np.array([[1.0, 0.0, -right], [0.0, 1.0, -down]])


def nearest_seen(valid: MaskMap) -> tuple[Cells, Cells]:
    """Return row and column (R, C) of the seen cell nearest to each."""
    unseen = (~valid).astype(np.uint8)
    _far, labels = cv2.distanceTransformWithLabels(
        unseen, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    rows, cols = np.nonzero(valid)
    number = np.zeros(int(labels.max()) + 1, dtype=np.intp)
    number[labels[valid]] = np.arange(len(rows))
    chosen = number[labels]
    return rows[chosen], cols[chosen]
