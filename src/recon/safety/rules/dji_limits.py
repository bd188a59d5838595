"""Limits of DJI's SDK. It rejects values beyond them without a report; the gate reports."""

from collections.abc import Iterator
from itertools import pairwise
from math import hypot
from typing import assert_never

from recon.geo.distance import horizontal_distance_m
from recon.model.app_report import AppOrder
from recon.model.command import (
    Body,
    Command,
    FlyMission,
    FollowPath,
    GoTo,
    HoldPosition,
    Hover,
    LandNow,
    LockCamera,
    Nudge,
    Refusal,
    ReturnHome,
    StartCamera,
    StopCamera,
    VirtualStick,
)
from recon.model.geo import LatLon
from recon.model.mission import DJI, Mission, Waypoint
from recon.safety.path.order_path import as_sent
from recon.safety.reported_facts import reported_facts
from recon.safety.settings import SafetySettings
from recon.safety.situation import Situation

RULE = "dji_limits"
CORNER_TOLERANCE_M = 1e-6


def dji_limits(command: Command, situation: Situation) -> Refusal | None:
    """Refuse numbers that the aircraft's controller would reject without a report."""
    return next(_refusals(command.body, situation), None)


def _refusals(body: Body, situation: Situation) -> Iterator[Refusal]:
    match body:
        case FlyMission():
            return _mission(body, situation)
        case VirtualStick():
            return _stick(body, situation)
        case FollowPath():
            return _followed(body, situation)
        case GoTo():
            return _goto(body, situation)
        case Nudge():
            return _nudge(body, situation)
        case StartCamera():
            return _camera(body, situation)
        case LockCamera():
            return _lock(situation)
        case Hover() | LandNow() | ReturnHome() | StopCamera() | HoldPosition():
            return iter(())
        case _ as unknown:
            assert_never(unknown)


def _range(
    what: str, name: str, value: float, least: float, most: float, unit: str, datum: str = ""
) -> Refusal:
    """Refuse a value outside a closed range; `name` is the parameter's, without its unit."""
    return _refused(
        f"{what} must be {least:g} to {most:g} {unit}{datum}; got {value:g} {unit}",
        **{f"{name}_{_SUFFIX[unit]}": value},
        **{f"min_{_SUFFIX[unit]}": least, f"max_{_SUFFIX[unit]}": most},
    )


def _above_zero(what: str, name: str, value: float, most: float, unit: str, why: str) -> Refusal:
    """Refuse a value that is not above 0, or that is above `most`."""
    return _refused(
        f"{what} must be above 0 and at most {most:g} {unit}{why}; got {value:g} {unit}",
        **{f"{name}_{_SUFFIX[unit]}": value},
        **{f"min_{_SUFFIX[unit]}": 0.0, f"max_{_SUFFIX[unit]}": most},
    )


def _position(latitude_deg: float, longitude_deg: float, what: str) -> Refusal:
    return _refused(
        f"{what} must be within 90 deg latitude and 180 deg longitude; got {latitude_deg:g}, "
        f"{longitude_deg:g}",
        latitude_deg=latitude_deg,
        longitude_deg=longitude_deg,
        max_latitude_deg=90.0,
        max_longitude_deg=180.0,
    )


def _refused(reason: str, **parameters: float | int | str) -> Refusal:
    return Refusal(RULE, reason, parameters=parameters)


_SUFFIX = {"m": "m", "s": "s", "m/s": "mps", "deg": "deg", "Hz": "hz"}
_ABOVE_TAKEOFF = " above takeoff"


def _camera(body: StartCamera, situation: Situation) -> Iterator[Refusal]:
    limit_hz = situation.settings.max_camera_fps_hz
    if not 0.0 < as_sent(body.fps_hz) <= limit_hz:
        yield _above_zero("Frame rate", "frame_rate", body.fps_hz, limit_hz, "Hz", "")


def _lock(situation: Situation) -> Iterator[Refusal]:
    """An app that does not know the order may take it for a start or a stop of its video."""
    if AppOrder.LOCK_CAMERA not in (
        reported_facts(situation.vehicle, situation.now_ns).orders or ()
    ):
        yield _refused(
            "its app does not report that it takes orders to lock exposure and white balance: lock "
            "them in the app"
        )


def _stick(body: VirtualStick, situation: Situation) -> Iterator[Refusal]:
    limits = situation.settings
    most_mps = limits.max_stick_speed_mps
    for name, speed_mps in (("x", body.velocity_x_mps), ("y", body.velocity_y_mps)):
        if abs(speed_mps) > most_mps:
            what = f"Stick velocity {name}"
            yield _range(what, f"velocity_{name}", speed_mps, -most_mps, most_mps, "m/s")
    yield from _steered_height(body.height_above_takeoff_m, limits)
    if not 0.0 < as_sent(body.timeout_s) <= limits.max_stick_timeout_s:
        why = ", the time for which the app keeps flying it without a new stick"
        most_s = limits.max_stick_timeout_s
        yield _above_zero("Stick timeout", "timeout", body.timeout_s, most_s, "s", why)


def _goto(body: GoTo, situation: Situation) -> Iterator[Refusal]:
    """A goto becomes sticks: numbers that these cannot carry are refused as a whole."""
    target = body.target
    if not target.is_valid():
        yield _position(target.latitude_deg, target.longitude_deg, "Target")
    yield from _steered_height(body.height_above_takeoff_m, situation.settings)
    yield from _steering_speed(body.speed_mps, situation.settings)


def _steered_height(height_m: float, limits: SafetySettings) -> Iterator[Refusal]:
    most_m = limits.max_stick_height_m
    if not 0.0 <= height_m <= most_m:
        name = "height_above_takeoff"
        yield _range("Height", name, height_m, 0.0, most_m, "m", _ABOVE_TAKEOFF)


def _nudge(body: Nudge, situation: Situation) -> Iterator[Refusal]:
    longest_m = situation.settings.max_nudge_m
    for name, moved_m in (("north", body.north_m), ("east", body.east_m), ("up", body.up_m)):
        if abs(moved_m) > longest_m:
            yield _refused(
                f"Nudge {name} must be {-longest_m:g} to {longest_m:g} m; got {moved_m:g} m; use "
                "a goto for larger distances",
                **{f"{name}_m": moved_m},
                min_m=-longest_m,
                max_m=longest_m,
            )
    yield from _steering_speed(body.speed_mps, situation.settings)


def _steering_speed(speed_mps: float, limits: SafetySettings) -> Iterator[Refusal]:
    least_mps, most_mps = limits.min_steering_mps, limits.max_stick_speed_mps
    if not least_mps <= speed_mps <= most_mps:
        yield _range("Speed", "speed", speed_mps, least_mps, most_mps, "m/s")


def _mission(body: FlyMission, situation: Situation) -> Iterator[Refusal]:
    mission, limits, vehicle = body.mission, situation.settings, situation.vehicle
    if vehicle is not None and not vehicle.flies_missions:
        yield _refused(
            f"{vehicle.display_name} flies no missions: its aircraft takes none. Give it a goto, "
            "or a survey, which the station steers"
        )
    yield from _count(mission, situation)
    yield from _too_high(mission, situation)
    for number, waypoint in enumerate(mission.waypoints, start=1):
        for refusal in _waypoint(waypoint, mission.curved, limits):
            yield _refused(
                f"Waypoint {number}: {refusal.reason}", waypoint=number, **refusal.parameters
            )
    yield from _legs(mission, limits)
    if mission.curved:
        yield from _corners(mission, limits)


def _too_high(mission: Mission, situation: Situation) -> Iterator[Refusal]:
    """Refuse heights above the aircraft's own maximum, where its app reports that."""
    most_m = reported_facts(situation.vehicle, situation.now_ns).max_height_m
    highest_m = max((each.height_above_takeoff_m for each in mission.waypoints), default=0.0)
    if most_m is not None and highest_m > most_m:
        yield _refused(
            f"Mission height must be at most {most_m:g} m above takeoff, the maximum height set in "
            f"the aircraft; got {highest_m:g} m",
            height_above_takeoff_m=highest_m,
            max_m=most_m,
        )


def _followed(body: FollowPath, situation: Situation) -> Iterator[Refusal]:
    """A path becomes sticks, which do nothing but fly, and end only where the station holds."""
    mission, limits = body.mission, situation.settings
    least, most = 1, limits.max_followed_waypoints
    count = len(mission.waypoints)
    if not least <= count <= most:
        text = f"Path must have {least} to {most} waypoints; got {count}"
        yield _refused(text, waypoint_count=count, min_count=least, max_count=most)
    if mission.curved or any(each.loiter_s for each in mission.waypoints):
        yield _refused("A path that is steered has no rounded corners and no waits; got some")
    yield from _too_high(mission, situation)
    for number, each in enumerate(mission.waypoints, start=1):
        for refusal in _followed_waypoint(each, limits):
            yield _refused(f"Waypoint {number}: {refusal.reason}", **refusal.parameters)


def _followed_waypoint(waypoint: Waypoint, limits: SafetySettings) -> Iterator[Refusal]:
    if not LatLon(waypoint.latitude_deg, waypoint.longitude_deg).is_valid():
        yield _position(waypoint.latitude_deg, waypoint.longitude_deg, "position")
    yield from _steered_height(waypoint.height_above_takeoff_m, limits)
    yield from _steering_speed(waypoint.speed_mps, limits)


def _count(mission: Mission, situation: Situation) -> Iterator[Refusal]:
    profile = situation.vehicle.profile if situation.vehicle is not None else None
    most = DJI.max_waypoints if profile is None else min(DJI.max_waypoints, profile.max_waypoints)
    stated = reported_facts(situation.vehicle, situation.now_ns).max_waypoints
    most = most if stated is None else min(most, stated)
    count, least = len(mission.waypoints), situation.settings.min_waypoints
    if not least <= count <= most:
        yield _refused(
            f"Mission must have {least} to {most} waypoints for this vehicle's app; got {count}",
            waypoint_count=count,
            min_count=least,
            max_count=most,
        )


def _waypoint(waypoint: Waypoint, curved: bool, limits: SafetySettings) -> Iterator[Refusal]:
    """What is wrong with one waypoint; its number goes before each sentence."""
    if not LatLon(waypoint.latitude_deg, waypoint.longitude_deg).is_valid():
        yield _position(waypoint.latitude_deg, waypoint.longitude_deg, "position")
    height_m, least_m, most_m = (
        waypoint.height_above_takeoff_m,
        limits.min_height_m,
        limits.max_height_m,
    )
    if not least_m <= height_m <= most_m:
        name = "height_above_takeoff"
        yield _range("height", name, height_m, least_m, most_m, "m", _ABOVE_TAKEOFF)
    if not 0.0 < as_sent(waypoint.speed_mps) <= limits.max_speed_mps:
        yield _above_zero("speed", "speed", waypoint.speed_mps, limits.max_speed_mps, "m/s", "")
    if curved and (waypoint.loiter_s is not None or waypoint.gimbal_pitch_deg is not None):
        yield _refused(
            "a curved mission cannot have loiter or gimbal actions: the SDK ignores them"
        )
    yield from _actions(waypoint, limits)


def _actions(waypoint: Waypoint, limits: SafetySettings) -> Iterator[Refusal]:
    loiter_s, pitch_deg = waypoint.loiter_s, waypoint.gimbal_pitch_deg
    if loiter_s is not None and not 0.0 <= loiter_s <= limits.max_loiter_s:
        yield _range("loiter", "loiter", loiter_s, 0.0, limits.max_loiter_s, "s")
    lowest_deg, highest_deg = limits.min_gimbal_pitch_deg, limits.max_gimbal_pitch_deg
    if pitch_deg is not None and not lowest_deg <= pitch_deg <= highest_deg:
        yield _range("gimbal pitch", "gimbal_pitch", pitch_deg, lowest_deg, highest_deg, "deg")


def _legs(mission: Mission, limits: SafetySettings) -> Iterator[Refusal]:
    path_m = 0.0
    for number, (a, b) in enumerate(pairwise(mission.waypoints), start=1):
        leg_m = _distance_m(a, b)
        path_m += leg_m
        yield from _span(f"Waypoints {number} and {number + 1}", leg_m, limits)
    closing_m = _distance_m(mission.waypoints[0], mission.waypoints[-1])
    yield from _span("The first and the last waypoint", closing_m, limits)
    if path_m > limits.max_path_m:
        yield _refused(
            f"Mission path must be at most {limits.max_path_m / 1000:g} km long; got "
            f"{path_m / 1000:.1f} km",
            path_m=path_m,
            max_m=limits.max_path_m,
        )


def _span(which: str, distance_m: float, limits: SafetySettings) -> Iterator[Refusal]:
    least_m, most_m = limits.min_leg_m, limits.max_leg_m
    if not least_m <= distance_m <= most_m:
        yield _refused(
            f"{which} must be {least_m:g} to {most_m:g} m apart; got {distance_m:.2f} m",
            distance_m=distance_m,
            min_m=least_m,
            max_m=most_m,
        )


def _corners(mission: Mission, limits: SafetySettings) -> Iterator[Refusal]:
    least_m, most_m = limits.min_corner_radius_m, limits.max_corner_radius_m
    for number, waypoint in enumerate(mission.waypoints, start=1):
        radius_m = waypoint.corner_radius_m
        is_end = number in (1, len(mission.waypoints))
        if is_end and abs(radius_m - least_m) > CORNER_TOLERANCE_M:
            yield _refused(
                f"Waypoint {number}: the first and last corner radius must be {least_m:g} m; got "
                f"{radius_m:g} m",
                waypoint=number,
                corner_radius_m=radius_m,
                min_m=least_m,
                max_m=least_m,
            )
        if not least_m - CORNER_TOLERANCE_M <= radius_m <= most_m:
            yield _range(
                f"Waypoint {number}: corner radius", "corner_radius", radius_m, least_m, most_m, "m"
            )
    for number, (a, b) in enumerate(pairwise(mission.waypoints), start=1):
        both_m, leg_m = a.corner_radius_m + b.corner_radius_m, _distance_m(a, b)
        if both_m >= leg_m:
            yield _refused(
                f"Waypoints {number} and {number + 1}: the corner radii must sum to less than "
                f"their leg of {leg_m:.2f} m; got {both_m:.2f} m",
                corner_radii_m=both_m,
                max_m=leg_m,
            )


def _distance_m(a: Waypoint, b: Waypoint) -> float:
    across_m = horizontal_distance_m(
        LatLon(a.latitude_deg, a.longitude_deg), LatLon(b.latitude_deg, b.longitude_deg)
    )
    return hypot(across_m, b.height_above_takeoff_m - a.height_above_takeoff_m)
