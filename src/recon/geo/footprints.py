"""Ground footprints of legs, corners and points, prepared for queries against many polygons."""

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.int64]
ShapeArray = npt.NDArray[np.object_]

FARTHEST_M = 1e8
"""Farther than any two places on earth; GEOS overflows on far larger numbers."""


class Footprints:
    """Each of N footprints is the hull of three points, given as (N, 3, 2) east-north metres.

    The same point twice makes a leg, three times a point. `least_m` and `most_m` (N, 2) are the
    bounding boxes. `is_finite` (N,) is False for a footprint with a point that is not finite or not
    on earth; its other values are meaningless.
    """

    def __init__(self, triangles_m: npt.ArrayLike) -> None:
        points, is_finite = finite_points(triangles_m)
        corners = points.reshape(-1, 3, 2)
        self.is_finite: BoolArray = np.asarray(is_finite.reshape(-1, 3).all(axis=1))
        self._corners = corners
        self._shapes: ShapeArray | None = None
        self.least_m: FloatArray = corners.min(axis=1)
        self.most_m: FloatArray = corners.max(axis=1)

    def only(self, which: BoolArray | IntArray) -> "Footprints":
        """Return the footprints of a mask (N,), or at these indices."""
        chosen = Footprints.__new__(Footprints)
        chosen.is_finite, chosen._corners = self.is_finite[which], self._corners[which]
        chosen._shapes = None if self._shapes is None else self._shapes[which]
        chosen.least_m, chosen.most_m = self.least_m[which], self.most_m[which]
        return chosen

    def __len__(self) -> int:
        return len(self._corners)

    @property
    def shapes(self) -> ShapeArray:
        """The footprints (N,) as GEOS geometries, made at first use: most queries do without."""
        shapes = self._shapes
        if shapes is None:
            self._shapes = shapes = shapely.convex_hull(shapely.multipoints(self._corners))
        return shapes


def is_on_earth(points_m: FloatArray) -> BoolArray:
    """Return which (N, 2) points are finite and within `FARTHEST_M`, (N,)."""
    # NaN compares as false.
    near: BoolArray = np.abs(points_m).max(axis=1, initial=0.0) <= FARTHEST_M
    return near


def finite_points(points_m: npt.ArrayLike) -> tuple[FloatArray, BoolArray]:
    """Return (N, 2) points with zeros for those not on the earth, and which are on it, (N,)."""
    points = np.asarray(points_m, dtype=np.float64).reshape(-1, 2)
    is_finite = is_on_earth(points)
    return np.where(is_finite[:, np.newaxis], points, 0.0), is_finite
