"""Path volumes: everything that an order may make its vehicle touch, for rules about places.

A vehicle sets out from its last known position. On the leg to a mission's first waypoint it may fly
at every height between; so it may on a leg, a goto, a nudge, and while a stick changes its height.
The height it sets out from counts as up to 1 m nearer to where it goes (`height_noise_m`).
"""

from collections.abc import Sequence
from math import ceil, cos, radians
from typing import Final

import numpy as np

from recon.geo import corner_hulls
from recon.model.arrays import FloatArray
from recon.model.command import Command, StickFrame
from recon.model.mission import Mission
from recon.model.vehicle import Failsafe
from recon.safety.datum import places_m
from recon.safety.path.order_path import (
    OrderPath,
    StickFlight,
    StraightFlight,
    TakeoffClimb,
    as_sent,
    order_path,
)
from recon.safety.path.pieces import (
    Departure,
    Kind,
    PathVolume,
    Pieces,
    UnknownPath,
    block,
    departure,
    joined,
    legs_between,
)
from recon.safety.settings import FenceSettings, SafetySettings
from recon.safety.situation import Situation

FAN_STEP_DEG: Final = 30.0
"""A circle of what a stick may reach is drawn as a polygon round it, 4 % larger at most."""

EITHER_WAY_DEG: Final = 170.0
"""A turn of nearly half a circle may go the one way or the other."""


HOME = "home"


def path_volume(command: Command, situation: Situation) -> PathVolume | UnknownPath | None:
    """Return where the order may take its vehicle, or why that is unknown; None for no motion.

    Computed once for each command and situation.
    """
    if not command.moves or situation.vehicle is None:
        return None
    return situation.once(command, _path_volume)


def _path_volume(command: Command, situation: Situation) -> PathVolume | UnknownPath:
    assert situation.vehicle is not None
    begin = departure(situation, situation.vehicle)
    if isinstance(begin, UnknownPath):
        return begin
    path = order_path(command.body, situation.vehicle)
    return PathVolume(_pieces(path, begin, situation.settings), begin)


def _pieces(path: OrderPath, begin: Departure, limits: SafetySettings) -> Pieces:
    settings = limits.fences
    match path:
        case Mission():
            return mission_pieces(path, begin, settings)
        case StraightFlight():
            return straight_pieces(path, begin, settings)
        case StickFlight():
            return stick_pieces(path, begin, settings)
        case TakeoffClimb():
            return takeoff_pieces(begin, limits.prediction.takeoff_height_m, settings)
        case _:  # HoldPath
            return hold_pieces(begin, settings)


def mission_pieces(mission: Mission, departure: Departure, settings: FenceSettings) -> Pieces:
    """The way to the first waypoint, the legs, a curved mission's corners, routes home, the end."""
    points_m = np.empty((len(mission.waypoints), 3))
    points_m[:, :2] = places_m(departure.frame, mission.waypoints)
    points_m[:, 2] = [waypoint.height_above_takeoff_m for waypoint in mission.waypoints]
    points_m[:, 2] += departure.takeoff_m
    is_entry = np.arange(len(points_m)) == 0
    path_m = np.concatenate([departure.here_m[np.newaxis], points_m])
    path_m[0, 2] = _setting_out_m(departure, float(path_m[1, 2]), settings)
    flown = legs_between(path_m, _leg_names(len(points_m)), is_entry=is_entry)
    if mission.curved:
        flown = joined(flown, _corners(mission, points_m))
    pieces = joined(flown, routes_home(flown, departure))
    return joined(pieces, _landing(path_m[-1])) if mission.land_at_end else pieces


def _leg_names(count: int) -> tuple[str, ...]:
    return (
        "the leg to waypoint 1",
        *(f"leg {number} to {number + 1}" for number in range(1, count)),
    )


def _corners(mission: Mission, points_m: FloatArray) -> Pieces:
    radii_m = np.array([as_sent(waypoint.corner_radius_m) for waypoint in mission.waypoints])
    hulls_m = corner_hulls(points_m, radii_m)
    names = tuple(f"the corner at waypoint {number}" for number in range(2, len(points_m)))
    heights_m = hulls_m[..., 2]
    return block(Kind.CORNER, hulls_m[..., :2], heights_m.min(axis=1), heights_m.max(axis=1), names)


def _landing(point_m: FloatArray) -> Pieces:
    place_m = np.broadcast_to(point_m[:2], (1, 3, 2))
    return block(Kind.LANDING, place_m, np.array([-np.inf]), point_m[2:], ("the end",))


def straight_pieces(path: StraightFlight, departure: Departure, settings: FenceSettings) -> Pieces:
    """Return the flight to the target by closed-loop sticks, with overshoot, and the routes
    home."""
    height_m = path.height_above_takeoff_m
    assert height_m is not None  # a departure has a height
    target_m = places_m(departure.frame, [path.target])[0]
    offset_m = target_m - departure.here_m[:2]
    distance_m = float(np.hypot(*offset_m))
    if distance_m > 0.0:
        target_m = target_m + settings.steering_overshoot_m / distance_m * offset_m
    up_m = departure.takeoff_m + height_m
    flown = _from_here(departure, (*target_m.tolist(), up_m), path.name, settings)
    return joined(flown, routes_home(flown, departure))


def hold_pieces(departure: Departure, settings: FenceSettings) -> Pieces:
    """The place where the vehicle is; its route home is no newer than it is."""
    return _from_here(departure, departure.here_m.tolist(), "the place to hold", settings)


def takeoff_pieces(departure: Departure, height_m: float, settings: FenceSettings) -> Pieces:
    """Straight up to the height that a takeoff by hover ends at, and the routes home from there."""
    top_m = departure.here_m + np.array([0.0, 0.0, height_m])
    flown = _from_here(departure, top_m.tolist(), "the takeoff", settings)
    return joined(flown, routes_home(flown, departure))


def stick_pieces(path: StickFlight, departure: Departure, settings: FenceSettings) -> Pieces:
    """What the velocity reaches in the stick's time and its braking, from where the vehicle is.

    In the body's frame the direction turns with the vehicle from its present yaw to the stick's: a
    fan, or the whole circle when the yaw is not known or the turn is nearly half a circle. Every
    height between the present one and the stick's. No route home: the next stick, the zero at the
    end or the aircraft's own failsafe follow within seconds.
    """
    up_m = departure.takeoff_m + path.height_above_takeoff_m
    reach_m = path.reach_m(settings.stick)
    name = "the stick's path"
    east_m, north_m, _up_m = departure.here_m.tolist()
    if path.speed_mps == 0.0:
        return _from_here(departure, (east_m, north_m, up_m), name, settings)
    towards = path.east_mps / path.speed_mps, path.north_mps / path.speed_mps
    if path.frame is StickFrame.GROUND:
        target_m = east_m + reach_m * towards[0], north_m + reach_m * towards[1], up_m
        return _from_here(departure, target_m, name, settings)
    triangles_m = _fan(departure, towards, reach_m, path)
    low_m, high_m = sorted((_setting_out_m(departure, up_m, settings), up_m))
    count = len(triangles_m)
    return block(
        Kind.FLIGHT,
        triangles_m,
        np.full(count, low_m),
        np.full(count, high_m),
        (name,) * count,
        is_entry=np.ones(count, dtype=np.bool_),
    )


def _fan(
    departure: Departure, towards: tuple[float, float], reach_m: float, path: StickFlight
) -> FloatArray:
    """The triangles (N, 3, 2) round what may be reached while the vehicle turns."""
    turn_deg = path.turn_deg
    if turn_deg is None or abs(turn_deg) > EITHER_WAY_DEG:
        turn_deg = 360.0
    steps = max(1, ceil(abs(turn_deg) / FAN_STEP_DEG))
    yaws = np.deg2rad(path.first_yaw_deg + np.linspace(0.0, turn_deg, steps + 1))
    radius_m = reach_m / cos(radians(turn_deg) / steps / 2.0)
    # Clockwise from north: at yaw 0 forward is north and right is east.
    east = np.cos(yaws) * towards[0] + np.sin(yaws) * towards[1]
    north = np.cos(yaws) * towards[1] - np.sin(yaws) * towards[0]
    here_m = departure.here_m[:2]
    rim_m = here_m + radius_m * np.stack([east, north], axis=1)
    centres_m = np.broadcast_to(here_m, (steps, 2))
    return np.stack([centres_m, rim_m[:-1], rim_m[1:]], axis=1)


def _setting_out_m(departure: Departure, up_m: float, settings: FenceSettings) -> float:
    """The height it sets out from, on its way to another."""
    here_m, noise_m = float(departure.here_m[2]), settings.height_noise_m
    return here_m + min(max(up_m - here_m, -noise_m), noise_m)


def _from_here(
    departure: Departure, target_m: Sequence[float], name: str, settings: FenceSettings
) -> Pieces:
    """One flight from where the vehicle is to (3,) east, north and up; written out, for each
    setpoint of a stream is one."""
    east_m, north_m, up_m = target_m
    here_m, from_m = departure.here_m[:2].tolist(), _setting_out_m(departure, up_m, settings)
    return block(
        Kind.FLIGHT,
        np.array([[here_m, (east_m, north_m), (east_m, north_m)]]),
        np.array([min(from_m, up_m)]),
        np.array([max(from_m, up_m)]),
        (name,),
        is_entry=np.ones(1, dtype=np.bool_),
    )


def routes_home(flown: Pieces, departure: Departure) -> Pieces:
    """Return what may follow at every point of what is flown, by the aircraft's failsafe.

    Going home: a climb to the go-home height (where it is lower), then straight home at that
    height or the higher one it has, and down. From a flight these routes fill the triangle of the
    flight and home; those of a corner lie in the corner and in its legs' triangles. Landing: from
    everywhere straight down. Hovering: nothing.
    """
    if departure.failsafe is Failsafe.HOVER:
        return _none()
    if departure.failsafe is Failsafe.LAND:
        low_m = np.full(len(flown), -np.inf)
        return _like(flown, Kind.LANDING, flown.triangles_m, low_m, flown.high_m)
    return _going_home(flown, departure)


def _going_home(flown: Pieces, departure: Departure) -> Pieces:
    least_m, most_m = departure.go_home_m
    top_m = np.maximum(flown.high_m, most_m)
    climbs = _like(flown, Kind.CLIMB, flown.triangles_m, flown.low_m, top_m)
    flights = flown.only(flown.kinds == Kind.FLIGHT)
    triangles_m = flights.triangles_m.copy()
    return_m = np.maximum(flights.low_m, least_m), np.maximum(flights.high_m, most_m)
    # A flight is a leg (start, end, end): the route home starts anywhere on it.
    triangles_m[:, 2] = departure.home_m[:2]
    routes = _like(flights, Kind.ROUTE_HOME, triangles_m, *return_m)
    home_m = np.broadcast_to(departure.home_m[:2], (1, 3, 2))
    highest_m = np.array([return_m[1].max()])
    return joined(
        climbs, routes, block(Kind.LANDING, home_m, np.array([-np.inf]), highest_m, (HOME,))
    )


def _like(
    flown: Pieces,
    kind: Kind,
    triangles_m: FloatArray,
    low_m: FloatArray,
    high_m: FloatArray,
) -> Pieces:
    return block(kind, triangles_m, low_m, high_m, flown.names, is_entry=flown.is_entry)


def _none() -> Pieces:
    nothing = np.zeros(0)
    return block(Kind.CLIMB, np.zeros((0, 3, 2)), nothing, nothing, ())
