"""Pieces of a flight that are either level or upright, and how near two of them come.

Whatever two vehicles do inside pieces that are apart, at whatever time, they stay apart.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import hypot

EastNorth = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Volume:
    """A level leg (`low_m` equals `high_m`) or a column (`start_m` equals `end_m`), or a point."""

    start_m: EastNorth
    end_m: EastNorth
    low_m: float
    high_m: float


@dataclass(frozen=True, slots=True)
class Separation:
    """Two vehicles are apart when either of these lies between them."""

    horizontal_m: float
    vertical_m: float


def column(place_m: EastNorth, one_m: float, other_m: float) -> Volume:
    """Return the upright piece at a place between two heights."""
    return Volume(place_m, place_m, min(one_m, other_m), max(one_m, other_m))


def point(place_m: tuple[float, float, float]) -> Volume:
    """Return the piece that a hovering vehicle takes."""
    east_m, north_m, up_m = place_m
    return column((east_m, north_m), up_m, up_m)


def level_legs(way_m: Sequence[EastNorth], up_m: float) -> tuple[Volume, ...]:
    """Return the level pieces along a way."""
    return tuple(Volume(start, end, up_m, up_m) for start, end in pairwise(way_m))


def are_apart(ones: Iterable[Volume], others: Iterable[Volume], separation: Separation) -> bool:
    """Return whether no piece of the one comes too near to any of the other."""
    seconds = tuple(others)
    return all(_is_apart(one, other, separation) for one in ones for other in seconds)


def _is_apart(one: Volume, other: Volume, separation: Separation) -> bool:
    gap_m = max(one.low_m, other.low_m) - min(one.high_m, other.high_m)
    if gap_m >= separation.vertical_m:
        return True
    across_m = distance_m(one.start_m, one.end_m, other.start_m, other.end_m)
    return across_m >= separation.horizontal_m


def distance_m(a: EastNorth, b: EastNorth, c: EastNorth, d: EastNorth) -> float:
    """Return the least distance between the legs a-b and c-d, either of which may be a point."""
    if _cross(a, b, c, d):
        return 0.0
    return min(
        distance_to_leg_m(a, c, d),
        distance_to_leg_m(b, c, d),
        distance_to_leg_m(c, a, b),
        distance_to_leg_m(d, a, b),
    )


def distance_to_leg_m(place_m: EastNorth, start_m: EastNorth, end_m: EastNorth) -> float:
    """Return the least distance of a place to a leg."""
    share = share_along(place_m, start_m, end_m)
    east_m = start_m[0] + share * (end_m[0] - start_m[0])
    north_m = start_m[1] + share * (end_m[1] - start_m[1])
    return hypot(place_m[0] - east_m, place_m[1] - north_m)


def share_along(place_m: EastNorth, start_m: EastNorth, end_m: EastNorth) -> float:
    """Return where along a leg, 0 to 1, it comes nearest to a place; 0 for a leg of no length."""
    east_m, north_m = end_m[0] - start_m[0], end_m[1] - start_m[1]
    squared = east_m * east_m + north_m * north_m
    if squared == 0.0:
        return 0.0
    along = (place_m[0] - start_m[0]) * east_m + (place_m[1] - start_m[1]) * north_m
    return min(1.0, max(0.0, along / squared))


def _cross(a: EastNorth, b: EastNorth, c: EastNorth, d: EastNorth) -> bool:
    """Whether the legs cross in their middles; touching ends have distance 0 anyway."""
    return _side(a, b, c) * _side(a, b, d) < 0.0 and _side(c, d, a) * _side(c, d, b) < 0.0


def _side(a: EastNorth, b: EastNorth, c: EastNorth) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
