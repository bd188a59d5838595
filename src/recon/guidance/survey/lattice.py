"""One lattice of rows and marks for a whole survey, whoever flies which piece of it, and when.

Rows are numbered across, marks along them. Because every piece of a row begins and ends on the
region's edge or on a mark, pieces flown by different vehicles, or in different rounds, join
exactly. (When a camera fires between the marks nobody can say: its timer runs as it likes.)
"""

from dataclasses import dataclass
from math import ceil, cos, floor, radians, sin

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

ROUNDING = 1e-6
"""Of a mark's distance: a place this near to a mark is on it."""


@dataclass(frozen=True, slots=True)
class RowLattice:
    """Axes along the rows (at `bearing_deg` from north) and across (to the right of that).

    Row k runs at `first_row_m + k * spacing_m` across; mark j lies at `first_mark_m + j * mark_m`
    along. Both count from the frame's origin.
    """

    bearing_deg: float
    first_row_m: float
    spacing_m: float
    rows: int
    first_mark_m: float
    mark_m: float

    def along_across_m(self, east_north_m: npt.ArrayLike) -> FloatArray:
        """Return (N, 2) metres along and across of (N, 2) east-north places."""
        return np.asarray(east_north_m, dtype=np.float64) @ axes(self.bearing_deg).T

    def east_north_m(self, along_across_m: npt.ArrayLike) -> FloatArray:
        """Return (N, 2) east-north metres: `along_across_m` undone."""
        return np.asarray(along_across_m, dtype=np.float64) @ axes(self.bearing_deg)

    def row_across_m(self, row: int) -> float:
        """Return how far across a row runs."""
        return self.first_row_m + row * self.spacing_m

    @property
    def rows_across_m(self) -> FloatArray:
        """How far across each row runs, (rows,)."""
        across_m: FloatArray = self.first_row_m + self.spacing_m * np.arange(self.rows, dtype=float)
        return across_m

    def row_of(self, across_m: FloatArray) -> IntArray:
        """Return in which row's band each place lies."""
        row = np.floor((across_m - self.first_row_m) / self.spacing_m + 0.5).astype(np.int64)
        return np.clip(row, 0, self.rows - 1)

    def mark_at_or_before_m(self, along_m: float) -> float:
        """Return the last mark that is no farther along than a place."""
        return self._mark_m(floor((along_m - self.first_mark_m) / self.mark_m + ROUNDING))

    def mark_at_or_after_m(self, along_m: float) -> float:
        """Return the first mark that is at least as far along as a place."""
        return self._mark_m(ceil((along_m - self.first_mark_m) / self.mark_m - ROUNDING))

    def marks_between_m(self, start_m: float, end_m: float) -> tuple[float, ...]:
        """Return the marks strictly between two places along."""
        first = floor((start_m - self.first_mark_m) / self.mark_m + ROUNDING) + 1
        last = ceil((end_m - self.first_mark_m) / self.mark_m - ROUNDING) - 1
        return tuple(self._mark_m(number) for number in range(first, last + 1))

    def _mark_m(self, number: int) -> float:
        return self.first_mark_m + number * self.mark_m


def axes(bearing_deg: float) -> FloatArray:
    """Return the unit vectors along and across, (2, 2), as rows of east and north."""
    bearing = radians(bearing_deg)
    return np.array([[sin(bearing), cos(bearing)], [cos(bearing), -sin(bearing)]])
