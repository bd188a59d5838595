"""What DJI's SDK takes. It rejects the rest silently, so the station says it aloud."""

import struct
from collections.abc import Callable, Iterator
from itertools import pairwise
from math import hypot, inf
from typing import Any

from recon.geo.distance import horizontal_distance_m
from recon.model.command import (
    Command,
    FlyMission,
    GoTo,
    Nudge,
    Refusal,
    StartCamera,
    VirtualStick,
)
from recon.model.dji import DJI
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
from recon.safety.settings import SafetySettings
from recon.safety.situation import Situation

RULE = "dji_limits"
CORNER_TOLERANCE_M = 1e-6


def dji_limits(command: Command, situation: Situation) -> Refusal | None:
    """Refuse what the aircraft's controller would drop without a word."""
    check = _CHECKS.get(type(command.body))
    if check is None:
        return None
    fault = next(check(command.body, situation), None)
    return None if fault is None else Refusal(RULE, fault)


def _camera(body: StartCamera, situation: Situation) -> Iterator[str]:
    limit_hz = situation.settings.max_camera_fps_hz
    if not 0.0 < _as_sent(body.fps_hz) <= limit_hz:
        yield f"{body.fps_hz:g} frames per second: more than 0 and up to {limit_hz:g} are possible"


def _stick(body: VirtualStick, situation: Situation) -> Iterator[str]:
    limits = situation.settings
    for name, speed_mps in (("x", body.velocity_x_mps), ("y", body.velocity_y_mps)):
        if abs(speed_mps) > limits.max_stick_speed_mps:
            yield f"velocity {name} is {speed_mps:g} m/s, at most 15 m/s either way is accepted"
    if not 0.0 <= body.height_above_takeoff_m <= limits.max_stick_height_m:
        yield f"height {body.height_above_takeoff_m:g} m: 0 to 500 m above takeoff are accepted"
    if not 0.0 < _as_sent(body.timeout_s) <= limits.max_stick_timeout_s:
        yield (
            f"timeout {body.timeout_s:g} s: more than 0 and up to "
            f"{limits.max_stick_timeout_s:g} s are allowed, for the app flies on by itself so long"
        )


def _goto(body: GoTo, situation: Situation) -> Iterator[str]:
    """A goto becomes sticks: what they could not say is refused as a whole."""
    limits, target = situation.settings, body.target
    if not target.is_valid():
        yield f"{target.latitude_deg:g}, {target.longitude_deg:g} is no place on the globe"
    if not 0.0 <= body.height_above_takeoff_m <= limits.max_stick_height_m:
        yield f"height {body.height_above_takeoff_m:g} m: 0 to 500 m above takeoff are accepted"
    yield from _steering_speed(body.speed_mps, limits)


def _nudge(body: Nudge, situation: Situation) -> Iterator[str]:
    longest_m = situation.settings.max_nudge_m
    for name, moved_m in (("north", body.north_m), ("east", body.east_m), ("up", body.up_m)):
        if abs(moved_m) > longest_m:
            yield f"{moved_m:g} m {name}: a nudge is {longest_m:g} m at most; farther is a goto"
    yield from _steering_speed(body.speed_mps, situation.settings)


def _steering_speed(speed_mps: float, limits: SafetySettings) -> Iterator[str]:
    if not limits.min_steering_mps <= speed_mps <= limits.max_stick_speed_mps:
        yield f"speed {speed_mps:g} m/s: {limits.min_steering_mps:g} to 15 m/s are accepted"


def _mission(body: FlyMission, situation: Situation) -> Iterator[str]:
    mission, limits = body.mission, situation.settings
    yield from _count(mission, situation)
    for number, waypoint in enumerate(mission.waypoints, start=1):
        for fault in _waypoint(waypoint, mission.curved, limits):
            yield f"waypoint {number}: {fault}"
    yield from _legs(mission, limits)
    if mission.curved:
        yield from _corners(mission, limits)


def _count(mission: Mission, situation: Situation) -> Iterator[str]:
    profile = situation.vehicle.profile if situation.vehicle is not None else None
    most = DJI.max_waypoints if profile is None else min(DJI.max_waypoints, profile.max_waypoints)
    count, least = len(mission.waypoints), situation.settings.min_waypoints
    if not least <= count <= most:
        yield f"{count} waypoints: this vehicle's app takes {least} to {most}"


def _waypoint(waypoint: Waypoint, curved: bool, limits: SafetySettings) -> Iterator[str]:
    if not LatLon(waypoint.latitude_deg, waypoint.longitude_deg).is_valid():
        yield f"{waypoint.latitude_deg:g}, {waypoint.longitude_deg:g} is no place on the globe"
    height_m = waypoint.height_above_takeoff_m
    if not limits.min_height_m <= height_m <= limits.max_height_m:
        yield f"height {height_m:g} m: -200 to 500 m above takeoff are accepted"
    if not 0.0 < _as_sent(waypoint.speed_mps) <= limits.max_speed_mps:
        yield f"speed {waypoint.speed_mps:g} m/s: more than 0 and up to 15 m/s are accepted"
    if curved and (waypoint.loiter_s is not None or waypoint.gimbal_pitch_deg is not None):
        yield "a curved mission carries no loiter or gimbal action (the SDK ignores them)"
    yield from _actions(waypoint, limits)


def _actions(waypoint: Waypoint, limits: SafetySettings) -> Iterator[str]:
    loiter_s, pitch_deg = waypoint.loiter_s, waypoint.gimbal_pitch_deg
    if loiter_s is not None and not 0.0 <= loiter_s <= limits.max_loiter_s:
        yield f"loiter {loiter_s:g} s: 0 to {limits.max_loiter_s:g} s are accepted"
    lowest_deg, highest_deg = limits.min_gimbal_pitch_deg, limits.max_gimbal_pitch_deg
    if pitch_deg is not None and not lowest_deg <= pitch_deg <= highest_deg:
        yield f"gimbal pitch {pitch_deg:g} deg: -90 to 0 deg are accepted"


def _legs(mission: Mission, limits: SafetySettings) -> Iterator[str]:
    path_m = 0.0
    for number, (a, b) in enumerate(pairwise(mission.waypoints), start=1):
        leg_m = _distance_m(a, b)
        path_m += leg_m
        if not limits.min_leg_m <= leg_m <= limits.max_leg_m:
            yield f"waypoints {number} and {number + 1} are {leg_m:.2f} m apart: {_SPAN}"
    closing_m = _distance_m(mission.waypoints[0], mission.waypoints[-1])
    if not limits.min_leg_m <= closing_m <= limits.max_leg_m:
        yield f"the first and the last waypoint are {closing_m:.2f} m apart: {_SPAN}"
    if path_m > limits.max_path_m:
        yield f"the path is {path_m / 1000:.1f} km long: 30 km at most are accepted"


_SPAN = "0.5 m to 2 km are accepted"


def _corners(mission: Mission, limits: SafetySettings) -> Iterator[str]:
    smallest_m = limits.min_corner_radius_m
    for number, waypoint in enumerate(mission.waypoints, start=1):
        radius_m = waypoint.corner_radius_m
        is_end = number in (1, len(mission.waypoints))
        if is_end and abs(radius_m - smallest_m) > CORNER_TOLERANCE_M:
            yield f"waypoint {number}: the first and last corner radius must be {smallest_m:g} m"
        if not smallest_m - CORNER_TOLERANCE_M <= radius_m <= limits.max_corner_radius_m:
            yield f"waypoint {number}: corner radius {radius_m:g} m: 0.2 to 1000 m are accepted"
    for number, (a, b) in enumerate(pairwise(mission.waypoints), start=1):
        if a.corner_radius_m + b.corner_radius_m >= _distance_m(a, b):
            yield f"waypoints {number} and {number + 1}: their corners are wider than their leg"


def _as_sent(value: float) -> float:
    """The number a 32-bit float of the wire makes of it: what is tiny becomes 0."""
    try:
        return float(struct.unpack(">f", struct.pack(">f", value))[0])
    except OverflowError:
        return inf


def _distance_m(a: Waypoint, b: Waypoint) -> float:
    across_m = horizontal_distance_m(
        LatLon(a.latitude_deg, a.longitude_deg), LatLon(b.latitude_deg, b.longitude_deg)
    )
    return hypot(across_m, b.height_above_takeoff_m - a.height_above_takeoff_m)


_CHECKS: dict[type, Callable[[Any, Situation], Iterator[str]]] = {
    StartCamera: _camera,
    VirtualStick: _stick,
    GoTo: _goto,
    Nudge: _nudge,
    FlyMission: _mission,
}
