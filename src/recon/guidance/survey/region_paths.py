"""The shortest paths between rows inside the region.

Found by Dijkstra's search on a visibility graph of the region's corners.
"""

from heapq import heappop, heappush
from math import dist

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.guidance.survey.lattice import EastNorth
from recon.model.arrays import FloatArray

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
        self._corners = _corners(area)
        self._seen: dict[int, list[tuple[int, float]]] = {}
        shapely.prepare(area)

    def between(self, start_m: EastNorth, end_m: EastNorth) -> tuple[EastNorth, ...] | None:
        """Return the corners on the way, none where it is straight; None where there is no path."""
        if self._is_open(np.array([start_m]), end_m)[0]:
            return ()
        return self._around(start_m, end_m)

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

    def _around(self, start_m: EastNorth, end_m: EastNorth) -> tuple[EastNorth, ...] | None:
        """Dijkstra's search over the corners, from the start to the first that sees the end."""
        sees_end = self._is_open(self._corners, end_m)
        waiting = [(far_m, corner, -1) for corner, far_m in self._visible_from(start_m)]
        waiting.sort()
        before: dict[int, int] = {}
        best: tuple[float, int] | None = None
        while waiting:
            far_m, corner, previous = heappop(waiting)
            if best is not None and far_m >= best[0]:
                break
            if corner in before:
                continue
            before[corner] = previous
            if sees_end[corner]:
                total_m = far_m + dist(self._corners[corner], end_m)
                best = min(best or (total_m, corner), (total_m, corner))
            for neighbour, leg_m in self._neighbours(corner):
                if neighbour not in before:
                    heappush(waiting, (far_m + leg_m, neighbour, corner))
        return None if best is None else self._back(best[1], before)

    def _back(self, corner: int, before: dict[int, int]) -> tuple[EastNorth, ...]:
        path: list[EastNorth] = []
        while corner >= 0:
            path.append((float(self._corners[corner][0]), float(self._corners[corner][1])))
            corner = before[corner]
        return tuple(reversed(path))

    def _neighbours(self, corner: int) -> list[tuple[int, float]]:
        if corner not in self._seen:
            place = self._corners[corner]
            self._seen[corner] = self._visible_from((float(place[0]), float(place[1])))
        return self._seen[corner]

    def _visible_from(self, place_m: EastNorth) -> list[tuple[int, float]]:
        open_to = np.flatnonzero(self._is_open(self._corners, place_m))
        return [(int(each), dist(self._corners[each], place_m)) for each in open_to]

    def _is_open(self, places_m: FloatArray, end_m: EastNorth) -> npt.NDArray[np.bool_]:
        """Return which of N places see one straight, (N,)."""
        ends = np.broadcast_to(np.array(end_m), places_m.shape)
        legs = shapely.linestrings(np.stack([places_m, ends], axis=1))
        is_inside: npt.NDArray[np.bool_] = shapely.covers(self.area, legs)
        is_there: npt.NDArray[np.bool_] = (places_m == ends).all(axis=1)
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
