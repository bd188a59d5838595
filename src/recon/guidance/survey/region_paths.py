"""The shortest paths between rows inside the region."""

import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo.visible_paths import VisiblePaths
from recon.guidance.survey.lattice import EastNorth
from recon.model.arrays import BoolArray, FloatArray

CLEARANCE_M = 0.25
"""Distance of a path's corners from the edge, so that rounding never crosses it."""

OFF_PLACE_M = 3.0
"""A vehicle at the end of a row is no farther off it: GNSS and braking."""

MOST_CORNERS = 400
"""Most corners of the area; with more it is taken a little smaller, with fewer corners."""

COARSEST_M = 50.0
"""A region that has more corners even so has no room to spare."""


class RegionPaths:
    """Shortest paths in one area; what it has worked out it keeps."""

    def __init__(self, area: shapely.Geometry) -> None:
        self.area = area
        self._paths = VisiblePaths(_corners(area), self._is_open)
        shapely.prepare(area)

    def between(self, start_m: EastNorth, end_m: EastNorth) -> tuple[EastNorth, ...] | None:
        """Return the corners on the way, none where it is straight; None where there is no path."""
        return self._paths.between(start_m, end_m)

    def inside(self, place_m: EastNorth) -> EastNorth:
        """Return the place, or the nearest one `CLEARANCE_M` inside the area if it is not far off.

        Rows end on the edge, and a vehicle stops some way beyond it.
        """
        inner = shapely.buffer(self.area, -CLEARANCE_M)
        place = shapely.Point(place_m)
        if inner.is_empty or shapely.covers(inner, place):
            return place_m
        nearest = shapely.get_point(shapely.shortest_line(inner, place), 0)
        is_far = shapely.distance(nearest, place) > OFF_PLACE_M
        return place_m if is_far else (float(nearest.x), float(nearest.y))

    def _is_open(self, legs_m: FloatArray) -> BoolArray:
        is_inside: BoolArray = shapely.covers(self.area, shapely.linestrings(legs_m))
        is_there: BoolArray = (legs_m[:, 0] == legs_m[:, 1]).all(axis=1)
        return is_inside | is_there


def _corners(area: shapely.Geometry) -> FloatArray:
    """Corners to turn at, a little inside the area; of a round edge only some."""
    inner = shapely.buffer(area, -CLEARANCE_M, join_style="mitre")
    tolerance_m = CLEARANCE_M
    while shapely.get_num_coordinates(inner) > MOST_CORNERS and tolerance_m < COARSEST_M:
        # What is excluded lies farther in than the clearance by as much as it may be off.
        farther_in = shapely.buffer(area, -CLEARANCE_M - tolerance_m, join_style="mitre")
        inner = shapely.simplify(farther_in, tolerance_m)
        tolerance_m *= 2.0
    corners: FloatArray = np.unique(shapely.get_coordinates(inner), axis=0)
    return corners
