"""How well detected shade agrees with the truth: overlap and boundary error.

Masks are (R, C), True in shade. Cells without a detected value count as wrong.
"""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from recon.model.shade import MaskMap, ShadeMap

FARTHEST_EDGE_M = 200.0
"""Edges farther apart than this do not belong to the same shadow; a missed or a false edge counts
with this distance."""


@dataclass(frozen=True, slots=True)
class Overlap:
    """Counts of cells that can be added up over maps."""

    both: int = 0
    """In shade both in truth and as detected."""
    either: int = 0

    def __add__(self, other: "Overlap") -> "Overlap":
        return Overlap(self.both + other.both, self.either + other.either)

    @property
    def iou(self) -> float | None:
        """Intersection over union; None where neither has any shade."""
        return self.both / self.either if self.either else None


def shade_or_wrong(shade: ShadeMap, is_shade: MaskMap) -> MaskMap:
    """Return a map's shade, and the opposite of the truth in cells without a value."""
    detected: MaskMap = np.where(shade.valid, ~shade.is_sunlit, ~is_shade)
    return detected


def overlap(detected: MaskMap, is_shade: MaskMap, is_counted: MaskMap) -> Overlap:
    """Return the overlap of two masks of shade over the counted cells."""
    both = int((detected & is_shade & is_counted).sum())
    return Overlap(both, int(((detected | is_shade) & is_counted).sum()))


def boundary_error_m(
    detected: MaskMap, is_shade: MaskMap, is_counted: MaskMap, cell_m: float
) -> float | None:
    """Return the mean distance between the edges of two masks, both ways.

    None where neither has an edge between counted cells.
    """
    edges = _edges(detected, is_counted), _edges(is_shade, is_counted)
    if not (edges[0].any() or edges[1].any()):
        return None
    if not (edges[0].any() and edges[1].any()):
        return FARTHEST_EDGE_M
    if np.array_equal(*edges):
        return 0.0
    far_m = [_from_m(edges[1], cell_m)[edges[0]], _from_m(edges[0], cell_m)[edges[1]]]
    return float(np.minimum(np.concatenate(far_m), FARTHEST_EDGE_M).mean())


def _edges(mask: MaskMap, is_counted: MaskMap) -> MaskMap:
    """(2 R - 1, 2 C - 1): cells, and between them True where two counted ones differ."""
    rows, cols = mask.shape
    edges = np.zeros((2 * rows - 1, 2 * cols - 1), dtype=np.bool_)
    across = is_counted[:, 1:] & is_counted[:, :-1]
    down = is_counted[1:] & is_counted[:-1]
    edges[::2, 1::2] = (mask[:, 1:] != mask[:, :-1]) & across
    edges[1::2, ::2] = (mask[1:] != mask[:-1]) & down
    return edges


def _from_m(edges: MaskMap, cell_m: float) -> npt.NDArray[np.float32]:
    """How far each half cell is from the nearest edge."""
    far = cv2.distanceTransform((~edges).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return np.asarray(far * np.float32(cell_m / 2.0), dtype=np.float32)
