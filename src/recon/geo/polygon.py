"""Regions on the ground: which points lie in them, how far from the edge, which legs pass.

Every answer about what is not finite, or not on the earth, is the careful one: not inside, and not
clear either.
GEOS (by shapely) does the geometry, so that touching and grazing are decided in one place.
"""

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.model.zone import Region

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

FARTHEST_M = 1e8
"""No place on the earth is farther from any other; GEOS overflows on far larger numbers."""

_FAULTS = {
    "Self-intersection": "its edges cross or overlap",
    "Ring Self-intersection": "its outline touches itself",
    "Too few points in geometry component": "it has fewer than three different corners",
    "Hole lies outside shell": "a hole lies outside its outline",
    "Holes are nested": "a hole lies in another hole",
    "Interior is disconnected": "its holes cut it into pieces",
}
"""GEOS's words for what makes a polygon none, in plain ones."""


class Polygon:
    """A region made ready for many questions; build one for each region and keep it.

    Raises `ValueError` for a region with a `region_fault`: answers about one would be arbitrary.
    """

    def __init__(self, region: Region) -> None:
        fault = region_fault(region)
        if fault is not None:
            raise ValueError(f"expected a polygon whose edges do not meet, but {fault}")
        self._area = _shape(region)
        self._edge = shapely.boundary(self._area)
        shapely.prepare(self._area)
        shapely.prepare(self._edge)

    @property
    def area_m2(self) -> float:
        """The region's area without its holes."""
        return float(shapely.area(self._area))

    def contains(self, points_m: npt.ArrayLike) -> BoolArray:
        """Return which of the (N, 2) east-north points lie in the region or on its edge, (N,)."""
        points, is_finite = _finite_points(points_m)
        inside: BoolArray = shapely.covers(self._area, shapely.points(points)) & is_finite
        return inside

    def distance_to_edge_m(self, points_m: npt.ArrayLike) -> FloatArray:
        """Return how far the (N, 2) points are from the edge, outline or hole, (N,).

        Positive inside the region and negative outside; NaN for a point that is not finite.
        """
        points, is_finite = _finite_points(points_m)
        places = shapely.points(points)
        distance_m: FloatArray = shapely.distance(self._edge, places)
        signed_m = np.where(shapely.covers(self._area, places), distance_m, -distance_m)
        return np.where(is_finite, signed_m, np.nan)

    def holds_legs(
        self, starts_m: npt.ArrayLike, ends_m: npt.ArrayLike, margin_m: float = 0.0
    ) -> BoolArray:
        """Return which straight legs stay inside as a whole, at least `margin_m` from the edge.

        Starts and ends are (N, 2); the answer is (N,). A leg without length counts as its point.
        With no margin a leg may touch the edge.
        """
        legs, is_finite = _legs(starts_m, ends_m)
        far_m: FloatArray = shapely.distance(self._edge, legs)
        inside: BoolArray = shapely.covers(self._area, legs)
        holds: BoolArray = inside & (far_m >= margin_m) & is_finite
        return holds

    def is_clear_of_legs(
        self, starts_m: npt.ArrayLike, ends_m: npt.ArrayLike, margin_m: float = 0.0
    ) -> BoolArray:
        """Return which straight legs stay outside as a whole, at least `margin_m` away.

        As `holds_legs`; but a leg that touches the edge is not clear, whatever the margin.
        """
        legs, is_finite = _legs(starts_m, ends_m)
        far_m: FloatArray = shapely.distance(self._area, legs)
        clear: BoolArray = (far_m > 0.0) & (far_m >= margin_m) & is_finite
        return clear


def region_fault(region: Region) -> str | None:
    """Return what keeps a region from being a polygon, in words, or None when it is one.

    Crossing edges are said with their place, in metres east and north of the origin.
    """
    rings = (region.outline_m, *region.holes_m)
    if any(len(ring) < 3 for ring in rings):
        return "it has fewer than three corners"
    if not all(_is_on_earth(ring).all() for ring in rings):
        return "it has a corner that is not finite or not on the earth"
    shape = _shape(region)
    reason, _, place = str(shapely.is_valid_reason(shape)).partition("[")
    if reason == "Valid Geometry":
        return None if shapely.area(shape) > 0.0 else "it has no area"
    words = _FAULTS.get(reason, reason.lower())
    east_north = place.rstrip("]").split()
    if len(east_north) < 2:
        return words
    east_m, north_m = (float(value) for value in east_north[:2])
    return f"{words}, {east_m:.1f} m east and {north_m:.1f} m north of the origin"


def _shape(region: Region) -> shapely.Polygon:
    return shapely.Polygon(region.outline_m, list(region.holes_m))


def _is_on_earth(points_m: FloatArray) -> BoolArray:
    """Return which (N, 2) points are finite and no farther than anything is, (N,)."""
    # NaN compares as false.
    near: BoolArray = np.abs(points_m).max(axis=1, initial=0.0) <= FARTHEST_M
    return near


def _finite_points(points_m: npt.ArrayLike) -> tuple[FloatArray, BoolArray]:
    """Return (N, 2) points with zeros for those not finite, and which are, (N,)."""
    points = np.asarray(points_m, dtype=np.float64).reshape(-1, 2)
    is_finite = _is_on_earth(points)
    return np.where(is_finite[:, np.newaxis], points, 0.0), is_finite


def _legs(
    starts_m: npt.ArrayLike, ends_m: npt.ArrayLike
) -> tuple[npt.NDArray[np.object_], BoolArray]:
    starts, start_is_finite = _finite_points(starts_m)
    ends, end_is_finite = _finite_points(ends_m)
    legs: npt.NDArray[np.object_] = shapely.linestrings(np.stack([starts, ends], axis=1))
    is_point = (starts == ends).all(axis=1)
    # GEOS takes a line without length for nothing at all, which lies in no region.
    legs[is_point] = shapely.points(starts[is_point])
    return legs, start_is_finite & end_is_finite
