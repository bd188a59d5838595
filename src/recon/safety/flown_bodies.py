"""The pieces that each kind of order makes a vehicle fly."""

from math import ceil, cos, hypot, radians
from typing import Final

import numpy as np
import numpy.typing as npt

from recon.geo import corner_hulls
from recon.model.command import GoTo, Nudge, StickFrame, VirtualStick
from recon.model.mission import Mission
from recon.model.units import wrap_degrees
from recon.safety.as_sent import as_sent
from recon.safety.datum import places_m
from recon.safety.departure import Departure
from recon.safety.flown_path import Kind, Pieces, block, joined, legs_between
from recon.safety.settings import FenceSettings
from recon.safety.ways_home import ways_home

FloatArray = npt.NDArray[np.float64]

FAN_STEP_DEG: Final = 30.0
"""A circle of what a stick may reach is drawn as a polygon round it, 4 % larger at most."""

EITHER_WAY_DEG: Final = 170.0
"""A turn of nearly half a circle may go the one way or the other."""


def mission_pieces(mission: Mission, departure: Departure, settings: FenceSettings) -> Pieces:
    """The way to the first waypoint, the legs, a curved mission's corners, ways home, the end."""
    if not mission.waypoints:
        return hold_pieces(departure, settings)
    points_m = np.empty((len(mission.waypoints), 3))
    points_m[:, :2] = places_m(departure.frame, mission.waypoints)
    points_m[:, 2] = [waypoint.height_above_takeoff_m for waypoint in mission.waypoints]
    points_m[:, 2] += departure.takeoff_m
    is_entry = np.arange(len(points_m)) == 0
    way_m = np.concatenate([departure.here_m[np.newaxis], points_m])
    way_m[0, 2] = _setting_out_m(departure, float(way_m[1, 2]), settings)
    flown = legs_between(way_m, _leg_names(len(points_m)), is_entry=is_entry)
    if mission.curved:
        flown = joined(flown, _corners(mission, points_m))
    pieces = joined(flown, ways_home(flown, departure))
    return joined(pieces, _landing(way_m[-1])) if mission.land_at_end else pieces


def _leg_names(count: int) -> tuple[str, ...]:
    return (
        "the way to waypoint 1",
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


def goto_pieces(body: GoTo, departure: Departure, settings: FenceSettings) -> Pieces:
    """Straight to the target and a little beyond, every height between; ways home."""
    target_m = places_m(departure.frame, [body.target])[0]
    up_m = departure.takeoff_m + body.height_above_takeoff_m
    return _straight(departure, target_m, up_m, "the way to the target", settings)


def nudge_pieces(body: Nudge, departure: Departure, settings: FenceSettings) -> Pieces:
    """As a goto, from where the vehicle is."""
    target_m = departure.here_m[:2] + np.array([body.east_m, body.north_m])
    up_m = float(departure.here_m[2]) + body.up_m
    return _straight(departure, target_m, up_m, "the nudge", settings)


def hold_pieces(departure: Departure, settings: FenceSettings) -> Pieces:
    """The place where the vehicle is; its way home is no newer than it is."""
    return _from_here(departure, departure.here_m, "the place to hold", settings)


def takeoff_pieces(departure: Departure, height_m: float, settings: FenceSettings) -> Pieces:
    """Straight up to the height that a takeoff by hover ends at, and the ways home from there."""
    top_m = departure.here_m + np.array([0.0, 0.0, height_m])
    flown = _from_here(departure, top_m, "the takeoff", settings)
    return joined(flown, ways_home(flown, departure))


def stick_pieces(body: VirtualStick, departure: Departure, settings: FenceSettings) -> Pieces:
    """What the velocity reaches in the stick's time and its braking, from where the vehicle is.

    In the body's frame the direction turns with the vehicle from its present yaw to the stick's: a
    fan, or the whole circle when the yaw is not known or the turn is nearly half a circle. Every
    height between the present one and the stick's. No way home: the next stick, the zero at the
    end or the aircraft's own failsafe follow within seconds.
    """
    north_mps, east_mps = as_sent(body.velocity_x_mps), as_sent(body.velocity_y_mps)
    speed_mps = hypot(north_mps, east_mps)
    reach_m = speed_mps * as_sent(body.timeout_s) + speed_mps**2 / (2.0 * settings.braking_mps2)
    up_m = departure.takeoff_m + as_sent(body.height_above_takeoff_m)
    name = "the stick's way"
    if speed_mps == 0.0:
        return _from_here(departure, np.array([*departure.here_m[:2], up_m]), name, settings)
    towards = np.array([east_mps, north_mps]) / speed_mps
    if body.frame is StickFrame.GROUND:
        target_m = departure.here_m[:2] + reach_m * towards
        return _from_here(departure, np.array([*target_m, up_m]), name, settings)
    triangles_m = _fan(departure, towards, reach_m, as_sent(body.yaw_deg))
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
    departure: Departure, towards: FloatArray, reach_m: float, wanted_yaw_deg: float
) -> FloatArray:
    """The triangles (N, 3, 2) round what may be reached while the vehicle turns."""
    attitude = departure.vehicle.attitude.value
    if attitude is None:
        first_deg, turn_deg = 0.0, 360.0
    else:
        first_deg, turn_deg = attitude.yaw_deg, wrap_degrees(wanted_yaw_deg - attitude.yaw_deg)
        turn_deg = 360.0 if abs(turn_deg) > EITHER_WAY_DEG else turn_deg
    steps = max(1, ceil(abs(turn_deg) / FAN_STEP_DEG))
    yaws = np.deg2rad(first_deg + np.linspace(0.0, turn_deg, steps + 1))
    radius_m = reach_m / cos(radians(turn_deg) / steps / 2.0)
    # Clockwise from north: at yaw 0 forward is north and right is east.
    east = np.cos(yaws) * towards[0] + np.sin(yaws) * towards[1]
    north = np.cos(yaws) * towards[1] - np.sin(yaws) * towards[0]
    here_m = departure.here_m[:2]
    rim_m = here_m + radius_m * np.stack([east, north], axis=1)
    centres_m = np.broadcast_to(here_m, (steps, 2))
    return np.stack([centres_m, rim_m[:-1], rim_m[1:]], axis=1)


def _straight(
    departure: Departure,
    target_m: FloatArray,
    up_m: float,
    name: str,
    settings: FenceSettings,
) -> Pieces:
    """To a place by closed-loop sticks, which may pass it a little, and the ways home."""
    offset_m = target_m - departure.here_m[:2]
    distance_m = float(np.hypot(*offset_m))
    if distance_m > 0.0:
        target_m = target_m + settings.steering_overshoot_m / distance_m * offset_m
    flown = _from_here(departure, np.array([*target_m, up_m]), name, settings)
    return joined(flown, ways_home(flown, departure))


def _setting_out_m(departure: Departure, up_m: float, settings: FenceSettings) -> float:
    """The height it sets out from, on its way to another."""
    here_m, noise_m = float(departure.here_m[2]), settings.height_noise_m
    return here_m + min(max(up_m - here_m, -noise_m), noise_m)


def _from_here(
    departure: Departure, target_m: FloatArray, name: str, settings: FenceSettings
) -> Pieces:
    way_m = np.stack([departure.here_m, target_m])
    way_m[0, 2] = _setting_out_m(departure, float(target_m[2]), settings)
    return legs_between(way_m, (name,), is_entry=np.ones(1, dtype=np.bool_))
