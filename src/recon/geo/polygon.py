"""Regions on the ground: which points and footprints lie in them, and how far from the edge.

Input that is not finite or not on earth gets the safe answer: neither inside nor clear. GEOS (by
shapely) does the geometry, so that touching and grazing are decided in one place.
"""

from functools import cached_property
from math import hypot, inf
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo.local_frame import geo_from_enu
from recon.model.airspace import Region
from recon.model.arrays import BoolArray, FloatArray, IntArray
from recon.model.geo import LocalFrame

ShapeArray = npt.NDArray[np.object_]

DECIMALS = 7
"""Decimals of a degree in GeoJSON: a centimetre."""

FARTHEST_M = 1e8
"""Farther than any two places on earth; GEOS overflows on far larger numbers."""


class Box(NamedTuple):
    """West, south, east and north limits in metres."""

    west_m: float
    south_m: float
    east_m: float
    north_m: float

    def meets(self, other: "Box", gap_m: float) -> bool:
        """Return whether another box is no farther than a gap away, along both axes."""
        return (
            self.west_m <= other.east_m + gap_m
            and self.east_m >= other.west_m - gap_m
            and self.south_m <= other.north_m + gap_m
            and self.north_m >= other.south_m - gap_m
        )

    def farthest_m(self, east_m: float, north_m: float) -> float:
        """Return how far the box's farthest corner is from a place."""
        return hypot(
            max(east_m - self.west_m, self.east_m - east_m),
            max(north_m - self.south_m, self.north_m - north_m),
        )


UNBOUNDED = Box(-inf, -inf, inf, inf)


class Footprints:
    """Each of N footprints is the hull of three points, given as (N, 3, 2) east-north metres.

    The same point twice makes a leg, three times a point. `is_finite` (N,) is False for a footprint
    with a point that is not finite or not on earth; its other values are meaningless. Everything is
    worked out when it is asked for: of most paths, the box alone.
    """

    def __init__(self, triangles_m: npt.ArrayLike) -> None:
        self._triangles_m = np.asarray(triangles_m, dtype=np.float64).reshape(-1, 3, 2)
        self._shapes: ShapeArray | None = None

    def only(self, which: BoolArray | IntArray) -> "Footprints":
        """Return the footprints of a mask (N,), or at these indices."""
        chosen = Footprints(self._triangles_m[which])
        chosen._shapes = None if self._shapes is None else self._shapes[which]
        return chosen

    def __len__(self) -> int:
        return len(self._triangles_m)

    @cached_property
    def box(self) -> Box:
        """The box round all footprints; unbounded where one is not finite, and for no footprint.

        Most paths are small, and far from an edge as a whole: four numbers show it soonest.
        """
        if len(self) == 0:
            return UNBOUNDED
        points_m = self._triangles_m.reshape(-1, 2)
        # What is not finite is in the least or the most of all: NaN spreads.
        west_m, south_m = points_m.min(axis=0).tolist()
        east_m, north_m = points_m.max(axis=0).tolist()
        is_finite = (
            west_m >= -FARTHEST_M
            and south_m >= -FARTHEST_M
            and east_m <= FARTHEST_M
            and north_m <= FARTHEST_M
        )
        return Box(west_m, south_m, east_m, north_m) if is_finite else UNBOUNDED

    @cached_property
    def is_finite(self) -> BoolArray:
        """Which footprints (N,) have three points that are finite and on earth."""
        # NaN compares as false.
        near: BoolArray = np.abs(self._triangles_m).max(axis=(1, 2), initial=0.0) <= FARTHEST_M
        return near

    @cached_property
    def _corners_m(self) -> FloatArray:
        """The triangles, with zeros for those that are not finite."""
        return np.where(self.is_finite[:, np.newaxis, np.newaxis], self._triangles_m, 0.0)

    @cached_property
    def least_m(self) -> FloatArray:
        """West and south limits of each footprint, (N, 2)."""
        least_m: FloatArray = self._corners_m.min(axis=1)
        return least_m

    @cached_property
    def most_m(self) -> FloatArray:
        """East and north limits of each footprint, (N, 2)."""
        most_m: FloatArray = self._corners_m.max(axis=1)
        return most_m

    @property
    def shapes(self) -> ShapeArray:
        """The footprints (N,) as GEOS geometries, made at first use: most queries do without."""
        shapes = self._shapes
        if shapes is None:
            self._shapes = shapes = shapely.convex_hull(shapely.multipoints(self._corners_m))
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


LEAST_RESIZE_M = 1e-3
"""GEOS returns an empty polygon when its edge is to move by far less; smaller margins are taken as
0, which is the stricter answer."""

SAMPLES_OUTSIDE = 200
"""Samples along the part outside: its farthest point is known to 0.5 % of its length."""

_FAULTS = {
    "Self-intersection": "its edges cross or overlap",
    "Ring Self-intersection": "its outline touches itself",
    "Too few points in geometry component": "it has fewer than three different corners",
    "Hole lies outside shell": "a hole lies outside its outline",
    "Holes are nested": "a hole lies in another hole",
    "Interior is disconnected": "its holes cut it into pieces",
}
"""GEOS's reasons for an invalid polygon, in plain words."""


QUARTER_CIRCLE_SEGMENTS = 64
"""Segments of a rounded corner of a resized polygon: error 8e-5 of the distance."""


class Polygon:
    """A region prepared for many queries; build one per region and keep it.

    Raises `ValueError` for a region with a `region_fault`: answers about one would be arbitrary.
    """

    def __init__(self, region: Region) -> None:
        fault = region_fault(region)
        if fault is not None:
            raise ValueError(f"expected a polygon whose edges do not meet, but {fault}")
        self._take(shape_of(region))

    def _take(self, area: shapely.Polygon) -> None:
        self._area = area
        self._edge = shapely.boundary(area)
        # Prepared geometries answer repeated queries many times faster.
        shapely.prepare(self._area)
        shapely.prepare(self._edge)
        west, south, east, north = shapely.bounds(self._area)
        self._least_m, self._most_m = np.array([west, south]), np.array([east, north])
        self._middle_m, self._around_m = _circle_inside(area)
        self._middle_east_m, self._middle_north_m = self._middle_m.tolist()

    @property
    def area_m2(self) -> float:
        """The region's area without its holes."""
        return float(shapely.area(self._area))

    def contains(self, points_m: npt.ArrayLike) -> BoolArray:
        """Return which of the (N, 2) east-north points lie in the region or on its edge, (N,)."""
        points, is_finite = finite_points(points_m)
        inside: BoolArray = shapely.covers(self._area, shapely.points(points)) & is_finite
        return inside

    def distance_to_edge_m(self, points_m: npt.ArrayLike) -> FloatArray:
        """Return how far the (N, 2) points are from the edge, outline or hole, (N,).

        Positive inside the region and negative outside; NaN for a point that is not finite.
        """
        points, is_finite = finite_points(points_m)
        places = shapely.points(points)
        distance_m: FloatArray = shapely.distance(self._edge, places)
        signed_m = np.where(shapely.covers(self._area, places), distance_m, -distance_m)
        return np.where(is_finite, signed_m, np.nan)

    def holds(self, footprints: Footprints, inset_m: float = 0.0) -> BoolArray:
        """Return which of N footprints lie inside as a whole, (N,).

        Every point of one is then inside and more than `inset_m` from the edge; with none, on the
        edge is inside. With a negative inset every point is inside, or outside by that at most.
        """
        # A negative inset grows the region: GEOS has no such query, so make the larger polygon.
        if inset_m < -LEAST_RESIZE_M:
            return self._resized(-inset_m).holds(footprints)
        inside = self._is_in_the_middle(footprints, inset_m)
        ask = footprints.is_finite & ~inside
        if ask.any():
            inside[ask] = self._holds_shapes(footprints.shapes[ask], inset_m)
        return inside

    def _holds_shapes(self, shapes: ShapeArray, inset_m: float) -> BoolArray:
        inside: BoolArray = shapely.covers(self._area, shapes)
        if inset_m > 0.0 and inside.any():
            inside[inside] = ~shapely.dwithin(self._edge, shapes[inside], inset_m)
        return inside

    def has_circle_in_the_middle(self, east_m: float, north_m: float, radius_m: float) -> bool:
        """Return whether a circle lies in the inscribed circle, and so inside, clear of the edge:
        fast, and not true of every circle inside."""
        far_m = hypot(east_m - self._middle_east_m, north_m - self._middle_north_m)
        return far_m + radius_m <= self._around_m - LEAST_RESIZE_M

    def has_box_in_the_middle(self, box: Box, inset_m: float) -> bool:
        """Return whether a box lies in the inscribed circle, and so does what is in it: as `holds`,
        fast, and not true of every box inside."""
        far_m = box.farthest_m(self._middle_east_m, self._middle_north_m)
        return far_m <= self._around_m - max(inset_m, 0.0) - LEAST_RESIZE_M

    def _is_in_the_middle(self, footprints: Footprints, inset_m: float) -> BoolArray:
        """Return which footprints' boxes lie in the inscribed circle, (N,): fast, without GEOS.

        With a millimetre of margin, so that rounding cannot decide.
        """
        room_m = self._around_m - max(inset_m, 0.0) - LEAST_RESIZE_M
        if room_m <= 0.0:
            return np.zeros(len(footprints), dtype=np.bool_)
        far_m = np.maximum(footprints.most_m - self._middle_m, self._middle_m - footprints.least_m)
        is_near: BoolArray = (far_m * far_m).sum(axis=1) <= room_m * room_m
        return is_near & footprints.is_finite

    def is_clear_of(self, footprints: Footprints, gap_m: float = 0.0) -> BoolArray:
        """Return which of N footprints lie outside as a whole, (N,).

        Every point of one is then outside and more than `gap_m` away; on the edge is not outside.
        With a negative gap every point is outside, or less than that from the edge.
        """
        if gap_m < -LEAST_RESIZE_M:
            return self._resized(gap_m).is_clear_of(footprints)
        gap_m = max(gap_m, 0.0)
        is_near = (footprints.least_m <= self._most_m + gap_m).all(axis=1)
        is_near &= (footprints.most_m >= self._least_m - gap_m).all(axis=1)
        clear = footprints.is_finite & ~is_near
        ask = footprints.is_finite & is_near
        if ask.any():
            clear[ask] = ~shapely.dwithin(self._area, footprints.shapes[ask], gap_m)
        return clear

    def room_m(self, footprints: Footprints) -> FloatArray:
        """Return how far inside each of N footprints stays, (N,): its least distance to the edge.

        For one that does not lie inside: minus how far outside the farthest place is on the edges
        of its part outside, found by samples. NaN for one that is not finite.
        """
        shapes = footprints.shapes
        room_m: FloatArray = shapely.distance(self._edge, shapes)
        for index in np.flatnonzero(~shapely.covers(self._area, shapes)):
            outside = shapely.difference(shapes[index], self._area)
            # Across a notch both ends are on the edge, and the farthest point is between them.
            step_m = max(shapely.length(outside) / SAMPLES_OUTSIDE, LEAST_RESIZE_M)
            places = shapely.points(shapely.get_coordinates(shapely.segmentize(outside, step_m)))
            room_m[index] = -shapely.distance(self._area, places).max()
        return np.where(footprints.is_finite, room_m, np.nan)

    def gap_m(self, footprints: Footprints) -> FloatArray:
        """Return how far each of N footprints is from the region, (N,); 0 when it touches it."""
        gap_m: FloatArray = shapely.distance(self._area, footprints.shapes)
        return np.where(footprints.is_finite, gap_m, np.nan)

    def _resized(self, outward_m: float) -> "Polygon":
        """Return the region grown (or shrunk, negative) by a distance."""
        area = shapely.buffer(self._area, outward_m, quad_segs=QUARTER_CIRCLE_SEGMENTS)
        resized = Polygon.__new__(Polygon)
        resized._take(area)
        return resized


def region_fault(region: Region) -> str | None:
    """Return why a region is not a valid polygon, in words, or None when it is one.

    Crossing edges are given with their position, in metres east and north of the origin.
    """
    rings = (region.outline_m, *region.holes_m)
    if any(len(ring) < 3 for ring in rings):
        return "it has fewer than three corners"
    if not all(is_on_earth(ring).all() for ring in rings):
        return "it has a corner that is not finite or not on the earth"
    shape = shape_of(region)
    # GEOS appends the position in brackets.
    reason, _, place = str(shapely.is_valid_reason(shape)).partition("[")
    if reason == "Valid Geometry":
        return None if shapely.area(shape) > 0.0 else "it has no area"
    words = fault_words(reason)
    east_north = place.rstrip("]").split()
    if len(east_north) < 2:
        return words
    east_m, north_m = (float(value) for value in east_north[:2])
    return f"{words}, {east_m:.1f} m east and {north_m:.1f} m north of the origin"


def fault_words(reason: str) -> str:
    """Return GEOS's reason for an invalid polygon in plain words."""
    return _FAULTS.get(reason, reason.lower())


def _circle_inside(area: shapely.Polygon) -> tuple[FloatArray, float]:
    """Return centre (2,) and radius of a large circle inside the area, outside its holes."""
    if shapely.is_empty(area):
        return np.zeros(2), 0.0
    west, south, east, north = shapely.bounds(area)
    roughly_m = 0.01 * max(east - west, north - south)
    middle = shapely.get_point(shapely.maximum_inscribed_circle(area, roughly_m), 0)
    radius_m = float(shapely.distance(shapely.boundary(area), middle))
    return shapely.get_coordinates(middle)[0], radius_m


def shape_of(region: Region) -> shapely.Polygon:
    """Return a region with its holes as shapely has it, east-north metres."""
    return shapely.Polygon(region.outline_m, list(region.holes_m))


def geojson_geometry(frame: LocalFrame, shape_m: shapely.Geometry) -> dict[str, Any]:
    """Return a shape in east-north metres as a GeoJSON geometry (RFC 7946): longitude first.

    Outer rings are counter-clockwise, holes clockwise.
    """

    def lon_lat(places_m: FloatArray) -> FloatArray:
        flat_m = np.column_stack([places_m, np.zeros(len(places_m))])
        latitude_deg, longitude_deg, _ = geo_from_enu(frame, flat_m)
        return np.column_stack([longitude_deg, latitude_deg]).round(DECIMALS)

    turned = shapely.orient_polygons(shapely.transform(shape_m, lon_lat))
    geometry: dict[str, Any] = shapely.geometry.mapping(turned)
    return geometry


def thinned_ring(ring_m: FloatArray, within_m: float) -> FloatArray:
    """Return a ring (N, 2) with fewer corners (M, 2), M >= 3, at most `within_m` off.

    For display only, never for decisions. The first corner is not repeated at the end, in input or
    output; a tolerance of 0 changes nothing.
    """
    if within_m <= 0.0:
        return ring_m
    area = shapely.simplify(shapely.Polygon(ring_m), within_m, preserve_topology=True)
    thin: FloatArray = np.array(area.exterior.coords, dtype=np.float64)[:-1, :2]
    return thin
