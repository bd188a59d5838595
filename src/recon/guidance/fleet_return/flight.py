"""What goes into a plan and what comes out. Places are (east, north, up) metres of the site.

Up counts from the height of the frame's origin, in one datum for all vehicles: each one's own
height above takeoff is added to the height of its takeoff point before it comes in here.

A flight is made of volumes that are either level or upright. Whatever two vehicles do inside
volumes that are apart, at whatever time, they stay apart.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import hypot

import numpy as np

from recon.geo import geo_from_enu
from recon.guidance.fleet_return.settings import FleetReturnSettings
from recon.model.geo import LocalFrame
from recon.model.mission import Mission, Waypoint

EastNorth = tuple[float, float]

PARTING_M = 6.0
"""Vehicles that hover one above the other by less are left to their pilots."""


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


def leads_away(from_up_m: float, to_up_m: float, other_up_m: float) -> bool:
    """Return whether a climb or descent takes a vehicle away from another, above or below it."""
    gap_m = other_up_m - from_up_m
    return abs(gap_m) >= PARTING_M and (to_up_m - from_up_m) * gap_m <= 0.0


def level_legs(path_m: Sequence[EastNorth], up_m: float) -> tuple[Volume, ...]:
    """Return the level pieces along a path."""
    return tuple(Volume(start, end, up_m, up_m) for start, end in pairwise(path_m))


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


Place = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Pad:
    """Where a vehicle lands."""

    name: str
    east_m: float
    north_m: float
    up_m: float

    @property
    def east_north_m(self) -> EastNorth:
        """Return its place on the ground."""
        return self.east_m, self.north_m


@dataclass(frozen=True, slots=True)
class Hovering:
    """Something in the air that stays where it is. `key` is its own alone, its name may not be."""

    key: str
    name: str
    place_m: Place


@dataclass(frozen=True, slots=True)
class CalledVehicle:
    """A vehicle that hovers and is recalled. `battery_fraction` None: not known, taken for
    the lowest."""

    serial: str
    name: str
    place_m: Place
    takeoff_up_m: float
    pad: Pad
    battery_fraction: float | None = None

    @property
    def hovering(self) -> Hovering:
        """The vehicle as the others see it while it waits."""
        return Hovering(self.serial, self.name, self.place_m)


@dataclass(frozen=True, slots=True)
class ReturnFlight:
    """One route home: up or down to the layer on the spot, along `path_m` in it, down at the pad.

    `path_m` begins over the vehicle's place and ends over its pad, at least two points. `wave`
    counts from 1.
    """

    serial: str
    name: str
    start_m: Place
    takeoff_up_m: float
    pad: Pad
    layer_up_m: float
    path_m: tuple[EastNorth, ...]
    wave: int

    @property
    def volumes(self) -> tuple[Volume, ...]:
        """Every place it passes, in order: its column, its path, the pad's column."""
        east_m, north_m, up_m = self.start_m
        return (
            column((east_m, north_m), up_m, self.layer_up_m),
            *level_legs(self.path_m, self.layer_up_m),
            column(self.pad.east_north_m, self.layer_up_m, self.pad.up_m),
        )

    def volumes_past(self, place_m: Place) -> tuple[Volume, ...]:
        """What must be apart from a vehicle that hovers there: not a column that leads away.

        Two that hover too near, one above the other, could otherwise never part.
        """
        leaves = leads_away(self.start_m[2], self.layer_up_m, place_m[2])
        return self.volumes[1:] if leaves else self.volumes


@dataclass(frozen=True, slots=True)
class ExcludedVehicle:
    """A vehicle without a flight, and why, in words for its operator."""

    serial: str
    name: str
    reason: str


@dataclass(frozen=True, slots=True)
class ReturnPlan:
    """Flights in the order of their turn, and those excluded. `layers_up_m` from the lowest."""

    layers_up_m: tuple[float, ...]
    flights: tuple[ReturnFlight, ...]
    excluded: tuple[ExcludedVehicle, ...]

    @property
    def waves(self) -> tuple[tuple[ReturnFlight, ...], ...]:
        """The flights by wave; in a wave every vehicle has a layer of its own."""
        numbers = sorted({flight.wave for flight in self.flights})
        return tuple(tuple(f for f in self.flights if f.wave == number) for number in numbers)


LEAST_LEG_M = 1.0
"""DJI refuses waypoints nearer than 0.5 m; over its pad a vehicle sinks by this much instead."""

LEAST_CORNER_M = 0.6
"""A corner nearer than this to the waypoint before it is excluded, or DJI would refuse the flight.
The path moves by no more than that: less than `detour_slack_m`, which it keeps from all limits."""


def mission_of(
    flight: ReturnFlight,
    frame: LocalFrame,
    place_m: Place,
    settings: FleetReturnSettings,
    speed_mps: float,
) -> Mission:
    """Return the mission of a flight that begins where the vehicle hovers now, `place_m`.

    The first waypoint is over that place, so that the aircraft climbs or sinks on the spot, however
    its app flies to a first waypoint.
    """
    path_m = _without_short_legs([place_m[:2], *flight.path_m[1:]])
    up_m = [flight.layer_up_m] * len(path_m)
    if _apart_m(path_m[0], path_m[-1]) < LEAST_LEG_M:
        up_m[-1] -= LEAST_LEG_M
    flat_m = np.column_stack([np.array(path_m), np.zeros(len(path_m))])
    latitude_deg, longitude_deg, _ = geo_from_enu(frame, flat_m)
    speed = min(speed_mps, settings.speed_mps)
    return Mission(
        tuple(
            Waypoint(float(latitude), float(longitude), height_m - flight.takeoff_up_m, speed)
            for latitude, longitude, height_m in zip(latitude_deg, longitude_deg, up_m, strict=True)
        ),
        land_at_end=True,
        purpose=f"fleet return: to {flight.pad.name}",
    )


def _without_short_legs(path_m: Sequence[EastNorth]) -> list[EastNorth]:
    """Exclude the corners that are too near; where the path begins and ends stays."""
    kept = [path_m[0]]
    for corner in path_m[1:-1]:
        if _apart_m(kept[-1], corner) >= LEAST_CORNER_M <= _apart_m(corner, path_m[-1]):
            kept.append(corner)
    return [*kept, path_m[-1]]


def _apart_m(one: EastNorth, other: EastNorth) -> float:
    return hypot(one[0] - other[0], one[1] - other[1])
