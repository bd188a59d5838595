"""Waypoints of a mission that a vehicle has passed, from its positions alone.

The count only grows. A waypoint is passed when the vehicle has been near it, or is nearer to a leg
after it. The legs considered are bounded by the distance the vehicle can have flown since the
previous position, so that neighbouring rows are not confused.
"""

from collections.abc import Sequence
from math import hypot

from recon.geo import OnGlobe
from recon.geo.distance import offset_north_east_m
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint

NEAR_M = 3.0
"""Twice the noise of a GNSS position; a mission stops at half a metre from its waypoints."""

CLEARLY_NEARER_M = 0.5
FASTEST_MPS = 18.0
"""The SDK's 15 m/s plus tailwind."""

GAP_S = 1.0
"""After a gap this long the first waypoint may have been passed unnoticed."""

Point = tuple[float, float, float]


def waypoints_passed(
    mission: Mission, passed: int, position: LatLon, height_m: float | None, since_s: float
) -> int:
    """Return how many waypoints are passed, at least `passed`.

    `height_m` is above takeoff, as the waypoints' own; None leaves heights out. `since_s` is the
    time since the previous position.
    """
    points = mission.waypoints
    passed = _past_the_near_ones(points, passed, position, height_m)
    if passed == 0 and since_s < GAP_S:
        return 0
    reach_m = NEAR_M + FASTEST_MPS * max(0.0, since_s)
    on = _onto_the_nearest_leg(points, passed, position, height_m, reach_m)
    return passed if on == passed else _past_the_near_ones(points, on, position, height_m)


def distance_to_m(waypoint: Waypoint, position: LatLon, height_m: float | None) -> float:
    """Return how far a waypoint is; without a height, in the horizontal."""
    return _distance_m(position, height_m, waypoint)


def _past_the_near_ones(
    points: Sequence[Waypoint], passed: int, position: LatLon, height_m: float | None
) -> int:
    while passed < len(points) and _distance_m(position, height_m, points[passed]) <= NEAR_M:
        passed += 1
    return passed


def _onto_the_nearest_leg(
    points: Sequence[Waypoint],
    passed: int,
    position: LatLon,
    height_m: float | None,
    reach_m: float,
) -> int:
    """Leg k leads from waypoint k - 1 to k: a vehicle on it has passed k waypoints."""
    if passed == len(points):
        return passed
    best_m = NEAR_M + CLEARLY_NEARER_M
    end = _offset(position, height_m, points[passed])
    if passed > 0:
        best_m = _to_leg_m(_offset(position, height_m, points[passed - 1]), end)
    between_m, on = 0.0, passed
    for leg in range(passed + 1, len(points)):
        if between_m > reach_m:
            break
        start, end = end, _offset(position, height_m, points[leg])
        distance_m = _to_leg_m(start, end)
        if distance_m < best_m - CLEARLY_NEARER_M:
            best_m, on = distance_m, leg
        between_m += _length_m(points[leg - 1], points[leg])
    return on


def _to_leg_m(start: Point, end: Point) -> float:
    """How far a leg is from here; its ends are offsets from here."""
    along = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    length_squared = _dot(along, along)
    if length_squared < 1e-9:
        return _norm(start)
    share = max(0.0, min(1.0, -_dot(start, along) / length_squared))
    nearest = (
        start[0] + share * along[0],
        start[1] + share * along[1],
        start[2] + share * along[2],
    )
    return _norm(nearest)


def _dot(a: Point, b: Point) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _distance_m(position: OnGlobe, height_m: float | None, waypoint: Waypoint) -> float:
    return _norm(_offset(position, height_m, waypoint))


def _offset(position: OnGlobe, height_m: float | None, waypoint: Waypoint) -> Point:
    up_m = 0.0 if height_m is None else waypoint.height_above_takeoff_m - height_m
    return (*offset_north_east_m(position, waypoint), up_m)


def _length_m(a: Waypoint, b: Waypoint) -> float:
    return _distance_m(a, a.height_above_takeoff_m, b)


def _norm(point: Point) -> float:
    return hypot(hypot(point[0], point[1]), point[2])
