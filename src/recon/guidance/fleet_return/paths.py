"""Level routes home: what a site's air leaves open, and the shortest path through it.

Straight where nothing is closed, else the shortest around (a visibility graph).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import cos, inf, pi
from typing import Any

import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo.visible_paths import VisiblePaths
from recon.guidance.fleet_return.flight import EastNorth
from recon.guidance.fleet_return.settings import FleetReturnSettings
from recon.model.airspace import Airspace, HeightDatum, Region, Zone, ZoneKind
from recon.model.arrays import BoolArray, FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class ClosedVolume:
    """A region that is closed from `low_up_m` to `high_up_m`, either of which may be infinite.

    `blocks_vertical`: also to climbing and sinking on the spot, as a keep-out zone is; least
    heights do not hold for takeoff and landing.
    """

    name: str
    area: shapely.Geometry
    low_up_m: float
    high_up_m: float
    blocks_vertical: bool


@dataclass(frozen=True, slots=True, eq=False)
class RouteHome:
    """The heights that layers may have, what is closed between them, and where the site ends.

    `lowest_up_m` above `highest_up_m`: there is no room for a layer. `boundary` None: no fence.
    `margin_m` is kept to the boundary and to what is closed.
    """

    lowest_up_m: float
    highest_up_m: float
    closed: tuple[ClosedVolume, ...]
    boundary: shapely.Geometry | None
    margin_m: float


OPEN_WAY_M = 10.0
"""The layers lie above a zone whose edge is this near to the hull of all vehicles and pads."""


def route_home(
    airspace: Airspace,
    ground_up_m: tuple[float, float],
    places_m: Sequence[EastNorth],
    settings: FleetReturnSettings,
) -> RouteHome:
    """Return what holds for paths between these places (vehicles' and pads').

    `ground_up_m` is the lowest and the highest ground on the ways. A zone near the hull of the
    places is flown over where its top leaves room under the ceiling. Every other zone is flown
    around, however far away it is: a detour may leave the hull.
    """
    limits = airspace.limits
    margin_m = limits.boundary_margin_m + settings.detour_slack_m
    low_ground_m, high_ground_m = ground_up_m
    highest_m = low_ground_m + limits.max_height_above_ground_m - settings.ceiling_margin_m
    least_m = max(limits.min_height_above_ground_m, settings.lowest_layer_m)
    near = shapely.buffer(shapely.MultiPoint(places_m).convex_hull, margin_m + OPEN_WAY_M)
    origin_m = 0.0 if airspace.frame is None else airspace.frame.origin.ellipsoid_height_m
    closed = tuple(
        piece
        for zone in airspace.zones
        for piece in _closed_by(zone, origin_m, ground_up_m, settings)
    )
    tops_m = [
        piece.high_up_m
        for piece in closed
        if piece.high_up_m <= highest_m and shapely.intersects(piece.area, near)
    ]
    return RouteHome(
        lowest_up_m=max([high_ground_m + least_m, *tops_m]),
        highest_up_m=highest_m,
        closed=closed,
        boundary=None if airspace.boundary is None else _area(airspace.boundary),
        margin_m=margin_m,
    )


def _closed_by(
    zone: Zone, origin_m: float, ground_up_m: tuple[float, float], settings: FleetReturnSettings
) -> Iterator[ClosedVolume]:
    """What a zone shuts; of uneven ground the side that is safe counts."""
    low_ground_m, high_ground_m = ground_up_m
    area = _area(zone.region)
    is_wgs84 = zone.datum is HeightDatum.WGS84

    def up_m(height_m: float | None, ground_m: float, otherwise_m: float) -> float:
        if height_m is None:
            return otherwise_m
        return height_m - origin_m if is_wgs84 else height_m + ground_m

    if zone.kind is ZoneKind.KEEP_OUT:
        low_m = up_m(zone.floor_m, low_ground_m, -inf) - settings.zone_margin_m
        high_m = up_m(zone.ceiling_m, high_ground_m, inf) + settings.zone_margin_m
        yield ClosedVolume(zone.name, area, low_m, high_m, blocks_vertical=True)
        return
    margin_m = settings.ceiling_margin_m
    if zone.floor_m is not None:
        floor_m = up_m(zone.floor_m, high_ground_m, -inf) + margin_m
        yield ClosedVolume(zone.name, area, -inf, floor_m, blocks_vertical=False)
    if zone.ceiling_m is not None:
        ceiling_m = up_m(zone.ceiling_m, low_ground_m, inf) - margin_m
        yield ClosedVolume(zone.name, area, ceiling_m, inf, blocks_vertical=False)


def _area(region: Region) -> shapely.Geometry:
    return shapely.Polygon(region.outline_m, list(region.holes_m))


CLEARANCE_M = 0.25
"""Distance of a path's corners from what they go around, so that rounding never touches it."""

CORNERS_OF_A_CIRCLE = 12

Way = tuple[EastNorth, ...]


class ReturnPaths:
    """Finds paths in one site's air at any height; keeps what it has worked out."""

    def __init__(self, home: RouteHome) -> None:
        self._home = home
        self._closed_by: dict[frozenset[int], shapely.Geometry] = {}
        self._found: dict[tuple[EastNorth, EastNorth, frozenset[int]], Way | None] = {}
        self._inside = _shrunk(home.boundary, home.margin_m)
        self._inside_corners = _corners(_shrunk(home.boundary, home.margin_m + CLEARANCE_M))
        shapely.prepare(self._inside)

    def find(self, start_m: EastNorth, end_m: EastNorth, up_m: float) -> Way | None:
        """Return the shortest path at a height, or None."""
        key = start_m, end_m, self._closed_pieces(up_m)
        if key not in self._found:
            self._found[key] = self._search(start_m, end_m, self._shut(up_m))
        return self._found[key]

    def find_around(
        self,
        start_m: EastNorth,
        end_m: EastNorth,
        up_m: float,
        hovering_m: Sequence[EastNorth],
        circle_m: float,
    ) -> Way | None:
        """Return a path that keeps `circle_m` from hovering vehicles as well, or None."""
        circles = [_circle(place_m, circle_m) for place_m in hovering_m]
        return self._search(start_m, end_m, shapely.union_all([self._shut(up_m), *circles]))

    def is_in_reach(self, place_m: EastNorth, up_m: float) -> bool:
        """Return whether a place at a height is inside the site and not closed."""
        return bool(self._is_open(np.array([[place_m, place_m]]), self._shut(up_m))[0])

    def _search(self, start_m: EastNorth, end_m: EastNorth, closed: Any) -> Way | None:
        shapely.prepare(closed)
        around = shapely.buffer(closed, CLEARANCE_M, join_style="mitre", mitre_limit=2.0)
        corners = np.array([*_corners(around), *self._inside_corners]).reshape(-1, 2)
        paths = VisiblePaths(corners, lambda legs_m: self._is_open(legs_m, closed))
        turns = paths.between(start_m, end_m)
        return None if turns is None else (start_m, *turns, end_m)

    def _closed_pieces(self, up_m: float) -> frozenset[int]:
        closed = enumerate(self._home.closed)
        return frozenset(n for n, piece in closed if piece.low_up_m < up_m < piece.high_up_m)

    def _shut(self, up_m: float) -> shapely.Geometry:
        pieces = self._closed_pieces(up_m)
        if pieces not in self._closed_by:
            areas = [self._home.closed[number].area for number in sorted(pieces)]
            margin_m = self._home.margin_m
            self._closed_by[pieces] = shapely.union_all(
                [shapely.buffer(area, margin_m, quad_segs=4) for area in areas]
            )
        return self._closed_by[pieces]

    def _is_open(self, legs_m: FloatArray, closed: Any) -> BoolArray:
        lines = shapely.linestrings(legs_m)
        is_point = (legs_m[:, 0] == legs_m[:, 1]).all(axis=1)
        lines[is_point] = shapely.points(legs_m[is_point, 0])
        is_open: BoolArray = ~shapely.intersects(closed, lines)
        if self._inside is not None:
            is_open &= shapely.covers(self._inside, lines)
        return is_open


def _shrunk(boundary: shapely.Geometry | None, margin_m: float) -> shapely.Geometry | None:
    return None if boundary is None else shapely.buffer(boundary, -margin_m, join_style="mitre")


def _circle(place_m: EastNorth, radius_m: float) -> shapely.Geometry:
    """A polygon around a circle, nowhere nearer than its radius."""
    outside_m = radius_m / cos(pi / CORNERS_OF_A_CIRCLE)
    angles = np.arange(CORNERS_OF_A_CIRCLE) * (2.0 * pi / CORNERS_OF_A_CIRCLE)
    offsets = np.column_stack([np.cos(angles), np.sin(angles)]) * outside_m
    return shapely.Polygon(np.asarray(place_m) + offsets)


def _corners(area: shapely.Geometry | None) -> list[EastNorth]:
    if area is None:
        return []
    return [(float(east), float(north)) for east, north in shapely.get_coordinates(area)]
