"""Items of a mission as the mission that is flown, or the one that is not understood and why.

Nothing is flown that was not asked for, and nothing that was asked for is left out silently: an
item that the station has no order for refuses the whole mission. Left out are only a takeoff as the
first item, because a mission itself takes off once the vehicle is armed, and a waypoint's heading.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Any

from recon.gateway.mavlink.dialect import ENCODED_DEGREE, mavlink
from recon.gateway.mavlink.heights import height_above_takeoff_m
from recon.gateway.mavlink.values import GatewaySettings
from recon.model.mission import Mission, Waypoint

INVALID, UNSUPPORTED = mavlink.MAV_MISSION_INVALID, mavlink.MAV_MISSION_UNSUPPORTED
UNSUPPORTED_FRAME = mavlink.MAV_MISSION_UNSUPPORTED_FRAME
FENCE_COMMANDS = range(
    mavlink.MAV_CMD_NAV_FENCE_RETURN_POINT, mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION + 1
)
SPEED_IS_GROUND = 1.0
SAME_PLACE_DEG = 1e-6


@dataclass(frozen=True, slots=True)
class NotUnderstood:
    """A mission that cannot be flown as it is: MAV_MISSION_RESULT and a sentence."""

    result: int
    sentence: str


def mission_of(items: Sequence[Any], settings: GatewaySettings) -> Mission | NotUnderstood:
    """Return the mission of items that came by MISSION_ITEM_INT."""
    waypoints: list[Waypoint] = []
    speed_mps, lands = settings.speed_mps, False
    for number, item in enumerate(items):
        if lands:
            return _not(item, number, "comes after the landing, which ends a mission")
        match item.command:
            case mavlink.MAV_CMD_NAV_WAYPOINT:
                waypoint = _waypoint(item, number, speed_mps, settings)
                if isinstance(waypoint, NotUnderstood):
                    return waypoint
                waypoints.append(waypoint)
            case mavlink.MAV_CMD_NAV_TAKEOFF if number == 0:
                continue
            case mavlink.MAV_CMD_NAV_LAND if waypoints and _is_at(item, waypoints[-1]):
                lands = True
            case mavlink.MAV_CMD_DO_CHANGE_SPEED if isfinite(item.param2) and item.param2 > 0.0:
                speed_mps = item.param2
                if waypoints:
                    waypoints[-1] = replace(waypoints[-1], speed_mps=speed_mps)
            case mavlink.MAV_CMD_NAV_DELAY if waypoints and item.param1 > 0.0:
                waypoints[-1] = replace(waypoints[-1], loiter_s=item.param1)
            case mavlink.MAV_CMD_DO_MOUNT_CONTROL | mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW if (
                waypoints and isfinite(item.param1)
            ):
                waypoints[-1] = replace(waypoints[-1], gimbal_pitch_deg=item.param1)
            case command if command in FENCE_COMMANDS:
                return _not(
                    item, number, "is of a fence: send a fence with MAVLink 2, and not as a mission"
                )
            case _:
                return _not(item, number, "is nothing that the station can order there")
    if not waypoints:
        return NotUnderstood(INVALID, "Not taken: a mission needs waypoints")
    return Mission(tuple(waypoints), land_at_end=lands)


def _waypoint(
    item: Any, number: int, speed_mps: float, settings: GatewaySettings
) -> Waypoint | NotUnderstood:
    height_m = height_above_takeoff_m(item.z, item.frame, settings.ground_above_sea_level_m)
    if height_m is None:
        return NotUnderstood(
            UNSUPPORTED_FRAME,
            f"Not taken: item {number} has frame {item.frame}; use heights above sea level or home",
        )
    if not isfinite(height_m):
        return NotUnderstood(
            mavlink.MAV_MISSION_INVALID_PARAM7, f"Not taken: item {number} has no height"
        )
    loiter_s = item.param1 if isfinite(item.param1) and item.param1 > 0.0 else None
    place = item.x / ENCODED_DEGREE, item.y / ENCODED_DEGREE
    return Waypoint(*place, height_m, speed_mps, loiter_s=loiter_s)


def _is_at(item: Any, waypoint: Waypoint) -> bool:
    """Return whether a landing is at the last waypoint, or names no place."""
    if item.x == 0 and item.y == 0:
        return True
    north_deg: float = item.x / ENCODED_DEGREE - waypoint.latitude_deg
    east_deg: float = item.y / ENCODED_DEGREE - waypoint.longitude_deg
    return max(abs(north_deg), abs(east_deg)) < SAME_PLACE_DEG


def _not(item: Any, number: int, why: str) -> NotUnderstood:
    return NotUnderstood(UNSUPPORTED, f"Not taken: item {number}, command {item.command}, {why}")
