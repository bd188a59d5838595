"""What a camera with a timer of unknown phase sees for sure of a row that is flown."""

from dataclasses import dataclass
from math import ceil, cos, floor, radians, sin

import numpy as np
import numpy.typing as npt

from recon.guidance.survey.settings import SurveySettings
from recon.model.arrays import FloatArray, IntArray
from recon.model.survey import Survey


@dataclass(frozen=True, slots=True)
class Swath:
    """`half_across_m` and `half_along_m` are what counts of the footprint, `photo_m` lies between
    two photos, and `least_row_m` is the shortest path that has a photo for sure."""

    half_across_m: float
    half_along_m: float
    photo_m: float
    widest_spacing_m: float

    @property
    def inset_m(self) -> float:
        """How far inside the end of what is to be seen a row may end; negative: beyond it.

        The last photo may lie a whole photo distance before the row's end, and sees half a
        footprint on.
        """
        return self.half_along_m - self.photo_m

    @property
    def lead_m(self) -> float:
        """How far beyond its piece a row is flown at both ends, so that the piece is seen."""
        return max(0.0, -self.inset_m)

    @property
    def beyond_m(self) -> float:
        """How far beyond the ends of a piece is seen for sure."""
        return max(0.0, self.inset_m)

    @property
    def least_row_m(self) -> float:
        """The shortest path flown: a little over one photo distance, so that one falls on it."""
        return 1.05 * self.photo_m


def swath_of(survey: Survey, settings: SurveySettings) -> Swath:
    """Return a survey's swath at its height and speed."""
    camera, height_m = survey.camera, survey.height_m
    across_m, along_m = camera.across_m(height_m), camera.along_m(height_m)
    half_across_m = across_m / 2.0 - settings.place_slack_m
    return Swath(
        half_across_m=half_across_m,
        half_along_m=along_m / 2.0 - settings.place_slack_m,
        photo_m=survey.speed_mps * camera.interval_s,
        widest_spacing_m=min(across_m * (1.0 - survey.side_overlap), 2.0 * half_across_m),
    )


EastNorth = tuple[float, float]
"""East and north metres of the site."""
AlongAcross = tuple[float, float]
"""Metres along the rows and across them, from the origin of the site."""


ROUNDING = 1e-6
"""Tolerance of a mark's distance: a place this near to a mark is on it."""


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

    def along_across_of(self, place_m: EastNorth) -> AlongAcross:
        """Return one place along and across."""
        ((along_m, across_m),) = self.along_across_m([place_m]).tolist()
        return along_m, across_m

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
