"""Waypoints of a mission that a vehicle has passed, from its positions alone.

The count only grows. A waypoint is passed when the vehicle has been near it and no longer comes
nearer, or is nearer to a leg after it. One that still climbs to a waypoint, or brakes there, stays
for a second or two yet: predicted to leave at once, it would be thought out of others' way. The
legs considered are bounded by the distance the vehicle can have flown since the
previous position, so that neighbouring rows are not confused.
"""

from collections.abc import Sequence
from math import hypot
from typing import NamedTuple

from recon.geo import OnGlobe
from recon.geo.distance import offset_north_east_m
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.vehicle import VelocityNed

NEAR_M = 3.0
"""Twice the noise of a GNSS position; a mission stops at half a metre from its waypoints."""

AT_M = 0.5
COMES_NEARER_MPS = 0.5

CLEARLY_NEARER_M = 0.5
FASTEST_MPS = 18.0
"""The SDK's 15 m/s plus tailwind."""

GAP_S = 1.0
"""Gap after which the first waypoint may have been passed unnoticed."""

Point = tuple[float, float, float]
"""North, east, up."""


class Seen(NamedTuple):
    """A vehicle's telemetry. `height_m` is above takeoff, as waypoints' own: None leaves heights
    out. A velocity of None is unknown: the vehicle may have come to a halt."""

    position: LatLon
    height_m: float | None
    velocity: VelocityNed | None = None


def waypoints_passed(mission: Mission, passed: int, seen: Seen, since_s: float) -> int:
    """Return how many waypoints are passed, at least `passed`.

    `since_s` is the time since the previous position.
    """
    passed = _past_the_near_ones(mission, passed, seen)
    if passed == 0 and since_s < GAP_S:
        return 0
    reach_m = NEAR_M + FASTEST_MPS * max(0.0, since_s)
    on = _onto_the_nearest_leg(mission.waypoints, passed, seen.position, seen.height_m, reach_m)
    return passed if on == passed else _past_the_near_ones(mission, on, seen)


def distance_to_m(waypoint: Waypoint, position: LatLon, height_m: float | None) -> float:
    """Return how far a waypoint is; without a height, in the horizontal."""
    return _distance_m(position, height_m, waypoint)


def _past_the_near_ones(mission: Mission, passed: int, seen: Seen) -> int:
    points = mission.waypoints
    while passed < len(points):
        path_m = _offset(seen.position, seen.height_m, points[passed])
        if _norm(path_m) > NEAR_M or _comes_nearer(path_m, seen.velocity, mission.curved):
            break
        passed += 1
    return passed


def _comes_nearer(path_m: Point, velocity: VelocityNed | None, is_curved: bool) -> bool:
    """Whether a vehicle is still on its way to a waypoint near it; one that flies through the
    waypoints of a curved mission is so in the vertical only."""
    if velocity is None:
        return False
    towards = (0.0, 0.0, path_m[2]) if is_curved else path_m
    far_m = _norm(towards)
    if far_m <= AT_M:
        return False
    moves = velocity.north_mps, velocity.east_mps, -velocity.down_mps
    return _dot(towards, moves) / far_m > COMES_NEARER_MPS


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
