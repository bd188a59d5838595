"""Figures of a shade map against the true sky, as sums that add up over maps.

Cells without a value are unknown: neither false nor missed nor wrong, but wrong in the IoU.
"""

from dataclasses import dataclass, field

import numpy as np

from recon.model.shade import SUNLIT_TRANSMITTANCE, FloatMap, MaskMap
from recon.score.boundary_error import EdgeError, edge_error

LEAST_MIXED, MOST_MIXED = 0.05, 0.95
"""Share of shade of a map whose IoU is compared separately: with less, a few cells decide it."""


@dataclass(frozen=True, slots=True)
class Overlap:
    """Counts of cells that can be added up over maps."""

    both: int = 0
    """Cells in shade both in truth and as detected."""
    either: int = 0

    def __add__(self, other: "Overlap") -> "Overlap":
        return Overlap(self.both + other.both, self.either + other.either)

    @property
    def iou(self) -> float | None:
        """Intersection over union; None where neither has any shade."""
        return self.both / self.either if self.either else None


def overlap(detected: MaskMap, is_shade: MaskMap, is_counted: MaskMap) -> Overlap:
    """Return the overlap of two masks of shade over the counted cells."""
    both = int((detected & is_shade & is_counted).sum())
    return Overlap(both, int(((detected | is_shade) & is_counted).sum()))


@dataclass(frozen=True, slots=True)
class ShadeFigures:
    """Counts of cells, of one map or of many."""

    cells: int = 0
    shaded: int = 0
    """Cells truly in shade."""
    unknown: int = 0
    false: int = 0
    """Cells in sun, called shade."""
    missed: int = 0
    """Cells in shade, called sun."""
    shade: Overlap = field(default_factory=Overlap)
    """Overlap in shade; unknown cells count as wrong."""
    mixed: Overlap = field(default_factory=Overlap)
    """The same, over maps with 5 to 95 % of true shade."""
    mixed_ious: tuple[float, ...] = ()
    """Intersection over union of each of these maps."""
    transmittance_error: float = 0.0
    """Sum of absolute errors over the known cells."""
    edges: EdgeError = field(default_factory=EdgeError)

    def __add__(self, other: "ShadeFigures") -> "ShadeFigures":
        return ShadeFigures(
            self.cells + other.cells,
            self.shaded + other.shaded,
            self.unknown + other.unknown,
            self.false + other.false,
            self.missed + other.missed,
            self.shade + other.shade,
            self.mixed + other.mixed,
            self.mixed_ious + other.mixed_ious,
            self.transmittance_error + other.transmittance_error,
            self.edges + other.edges,
        )

    @property
    def iou(self) -> float | None:
        """Intersection over union of shade; None where neither has any."""
        return self.shade.iou

    @property
    def known(self) -> int:
        """Cells with a value."""
        return self.cells - self.unknown

    @property
    def wrong(self) -> int:
        """Cells called wrongly: known and wrong."""
        return self.false + self.missed

    @property
    def right_share(self) -> float:
        """Return the share of all cells that are known and right."""
        return (self.known - self.wrong) / self.cells if self.cells else 0.0


def map_figures(
    transmittance: FloatMap, known: MaskMap, truth: FloatMap, counted: MaskMap, cell_m: float
) -> ShadeFigures:
    """Return the figures of one map; arrays are (R, C), `transmittance` is not read where unknown.

    `truth` is the true transmittance at the cells' centres.
    """
    known = known & counted
    is_shade: MaskMap = truth < SUNLIT_TRANSMITTANCE
    called: MaskMap = np.where(known, transmittance, 1.0) < SUNLIT_TRANSMITTANCE
    found = overlap(np.where(known, called, ~is_shade), is_shade, counted)
    cells, shaded = int(counted.sum()), int((is_shade & counted).sum())
    is_mixed = LEAST_MIXED * cells <= shaded <= MOST_MIXED * cells
    iou = found.iou if is_mixed else None
    return ShadeFigures(
        cells=cells,
        shaded=shaded,
        unknown=int((counted & ~known).sum()),
        false=int((known & called & ~is_shade).sum()),
        missed=int((known & ~called & is_shade).sum()),
        shade=found,
        mixed=found if is_mixed else Overlap(),
        mixed_ious=() if iou is None else (iou,),
        transmittance_error=float(np.abs(transmittance - truth)[known].sum(dtype=np.float64)),
        edges=edge_error(called, known, is_shade, counted, cell_m),
    )
