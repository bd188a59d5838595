"""Commands into packets (ICD 3.2). Until here missions use heights above takeoff."""

from collections.abc import Callable
from math import nan
from typing import Any

from recon import wire
from recon.model.command import (
    Body,
    FlyMission,
    Hover,
    LandNow,
    LockCamera,
    ReturnHome,
    StartCamera,
    StickFrame,
    StopCamera,
    VirtualStick,
)
from recon.model.mission import Waypoint
from recon.model.report import AnsweredKind
from recon.model.units import wrap_degrees

IGNORED_CORNER_RADIUS_M = 0.2
"""Sent for missions that are not curved; apps pass it to an SDK that rejects less."""


def to_packet(body: Body, altitude_offset_m: float) -> wire.Packet:
    """Return the packet that commands `body`.

    `altitude_offset_m` is added to every waypoint's height above takeoff: 0 for apps that expect
    heights above takeoff, Altitude - HAG of the aircraft's telemetry for apps that expect WGS84.
    """
    return _WRITERS[type(body)](body, altitude_offset_m)


def answered_kind(body: Body) -> AnsweredKind:
    """Return the kind that acknowledgments of `body` name."""
    return _KINDS[type(body)]


def describe_altitudes(body: Body, altitude_offset_m: float | None) -> str | None:
    """Return which altitudes a mission is sent with, for the console, the log and the audit."""
    if not isinstance(body, FlyMission):
        return None
    heights = [w.height_above_takeoff_m for w in body.mission.waypoints]
    above = f"{min(heights):.1f} to {max(heights):.1f} m above takeoff"
    if altitude_offset_m is None:
        return f"sent as {above}"
    low, high = min(heights) + altitude_offset_m, max(heights) + altitude_offset_m
    return (
        f"{above}, sent as {low:.1f} to {high:.1f} m WGS84 "
        f"(offset {altitude_offset_m:+.1f} m from its own telemetry)"
    )


def _emergency(action: int) -> Callable[[Any, float], wire.Packet]:
    return lambda body, offset_m: wire.EmergencyCommand(action=action)


def _camera_start(body: StartCamera, _offset_m: float) -> wire.Packet:
    return wire.CameraControl(action=1, target_fps_hz=body.fps_hz)


def _camera_stop(_body: StopCamera, _offset_m: float) -> wire.Packet:
    return wire.CameraControl(action=0, target_fps_hz=0.0)


def _camera_lock(body: LockCamera, _offset_m: float) -> wire.Packet:
    return wire.CameraControl(action=2 if body.is_locked else 3, target_fps_hz=0.0)


def _mission(body: FlyMission, offset_m: float) -> wire.Packet:
    mission = body.mission
    return wire.ExecuteWaypointMission(
        land_at_end=int(mission.land_at_end),
        curved_flight=int(mission.curved),
        waypoints=tuple(_waypoint(w, mission.curved, offset_m) for w in mission.waypoints),
    )


def _waypoint(waypoint: Waypoint, curved: bool, offset_m: float) -> wire.Waypoint:
    return wire.Waypoint(
        latitude_deg=waypoint.latitude_deg,
        longitude_deg=waypoint.longitude_deg,
        altitude_m=waypoint.height_above_takeoff_m + offset_m,
        corner_radius_m=waypoint.corner_radius_m if curved else IGNORED_CORNER_RADIUS_M,
        speed_mps=waypoint.speed_mps,
        loiter_time_s=nan if waypoint.loiter_s is None else waypoint.loiter_s,
        gimbal_pitch_deg=nan if waypoint.gimbal_pitch_deg is None else waypoint.gimbal_pitch_deg,
    )


def _stick(body: VirtualStick, _offset_m: float) -> wire.Packet:
    return wire.VirtualStickCommand(
        mode=0 if body.frame is StickFrame.GROUND else 1,
        yaw_deg=wrap_degrees(body.yaw_deg),
        velocity_x_mps=body.velocity_x_mps,
        velocity_y_mps=body.velocity_y_mps,
        height_above_takeoff_m=body.height_above_takeoff_m,
        timeout_s=body.timeout_s,
    )


_WRITERS: dict[type, Callable[[Any, float], wire.Packet]] = {
    Hover: _emergency(0),
    LandNow: _emergency(1),
    ReturnHome: _emergency(2),
    StartCamera: _camera_start,
    StopCamera: _camera_stop,
    LockCamera: _camera_lock,
    FlyMission: _mission,
    VirtualStick: _stick,
}

_KINDS: dict[type, AnsweredKind] = {
    Hover: AnsweredKind.EMERGENCY,
    LandNow: AnsweredKind.EMERGENCY,
    ReturnHome: AnsweredKind.EMERGENCY,
    StartCamera: AnsweredKind.CAMERA,
    StopCamera: AnsweredKind.CAMERA,
    LockCamera: AnsweredKind.CAMERA,
    FlyMission: AnsweredKind.MISSION,
    VirtualStick: AnsweredKind.STICK,
}
