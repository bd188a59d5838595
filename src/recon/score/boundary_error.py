"""How far detected edges of shadows are from the true ones, each region weighted by its area.

An edge lies between a region of shade and one of sun; it belongs to the smaller of the two. A
region's edges share its area as their weight. So a stray cell counts as one cell, however long its
edge is compared with its area, and a wrong edge of a large cloud counts as the cloud.
"""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from recon.model.shade import MaskMap

FARTHEST_EDGE_M = 200.0
"""Edges farther apart than this do not belong to the same shadow; a missed or a false edge counts
with this distance."""

FloatImage = npt.NDArray[np.float32]
EdgeImage = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class EdgeError:
    """Sums over regions, true and detected; they add up over maps."""

    area_distance: float = 0.0
    """Cells times metres: each region's area times the mean distance of its edges."""
    area: float = 0.0
    """Cells of regions with edges."""
    true_area: float = 0.0
    """Cells of these that are true regions: 0 where there is no true edge to compare with."""

    def __add__(self, other: "EdgeError") -> "EdgeError":
        return EdgeError(
            self.area_distance + other.area_distance,
            self.area + other.area,
            self.true_area + other.true_area,
        )

    @property
    def mean_m(self) -> float | None:
        """Mean distance; None where the truth has no edge."""
        return self.area_distance / self.area if self.true_area else None


def edge_error(
    detected: MaskMap, known: MaskMap, is_shade: MaskMap, counted: MaskMap, cell_m: float
) -> EdgeError:
    """Return the error of detected edges, both ways; masks are (R, C), True in shade.

    Detected edges lie between known cells, true ones between counted cells: a true edge through
    unknown ground is a missed one.
    """
    found = _edge_weights(detected, known & counted)
    true = _edge_weights(is_shade, counted)
    far = [_weighted_m(found, true, cell_m), _weighted_m(true, found, cell_m)]
    return EdgeError(sum(far), float(found.sum() + true.sum()), float(true.sum()))


def _weighted_m(edges: EdgeImage, others: EdgeImage, cell_m: float) -> float:
    """Sum of the edges' weights times their distances to the nearest of the others."""
    at = np.flatnonzero(edges)
    if at.size == 0:
        return 0.0
    if not others.any():
        return float(edges.sum()) * FARTHEST_EDGE_M
    free = (others == 0.0).astype(np.uint8)
    far: FloatImage = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    far_m = np.minimum(far.ravel()[at] * (cell_m / 2.0), FARTHEST_EDGE_M)
    return float((edges.ravel()[at] * far_m).sum())


def _edge_weights(mask: MaskMap, counted: MaskMap) -> EdgeImage:
    """(2 R - 1, 2 C - 1): cells, and between two of different regions the weight of that edge."""
    rows, cols = mask.shape
    regions = _regions(mask, counted)
    areas = np.bincount(regions.ravel())
    areas[0] = 0  # cells that do not count
    owner = np.zeros((2 * rows - 1, 2 * cols - 1), dtype=np.int64)
    pairs = (
        ((slice(None), slice(1, None)), (slice(None), slice(None, -1)), np.s_[::2, 1::2]),
        ((slice(1, None), slice(None)), (slice(None, -1), slice(None)), np.s_[1::2, ::2]),
    )
    for one, other, between in pairs:
        first, second = regions[one], regions[other]
        is_edge = (mask[one] != mask[other]) & counted[one] & counted[other]
        smaller = np.where(areas[first] <= areas[second], first, second)
        owner[between] = np.where(is_edge, smaller, 0)
    edges = np.bincount(owner.ravel(), minlength=len(areas))
    edges[0] = 0
    weights: EdgeImage = (areas / np.maximum(edges, 1))[owner] * (owner > 0)
    return weights


def _regions(mask: MaskMap, counted: MaskMap) -> npt.NDArray[np.intp]:
    """(R, C): number of the connected region of shade or of sun; 0 where not counted."""
    shaded, in_shade = cv2.connectedComponents((mask & counted).astype(np.uint8), connectivity=4)
    _, in_sun = cv2.connectedComponents((~mask & counted).astype(np.uint8), connectivity=4)
    both: npt.NDArray[np.intp] = np.where(in_sun > 0, in_sun + shaded - 1, in_shade).astype(np.intp)
    return both
