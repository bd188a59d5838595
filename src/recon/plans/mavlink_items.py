"""A flight as MAVLink mission items, which QGroundControl and Mission Planner have in their files.

Commands and parameters are those of MAVLink's common messages (MAV_CMD).
"""

from collections.abc import Iterator
from dataclasses import dataclass

from recon.model.mission import Waypoint
from recon.plans.flight_plan import AtEnd, ExportedPlan, PhotoTrigger

WAYPOINT, RETURN_TO_LAUNCH, LAND, TAKEOFF = 16, 20, 21, 22
CHANGE_SPEED, MOUNT_CONTROL, TRIGGER_DISTANCE = 178, 205, 206
START_CAPTURE, STOP_CAPTURE = 2000, 2001
GROUND_SPEED, UNCHANGED_THROTTLE, AIMED_BY_MAVLINK = 1.0, -1.0, 2.0


@dataclass(frozen=True, slots=True)
class MissionItem:
    """One item; `place` is latitude, longitude (degrees) and height above takeoff (m) where it has
    one, and three more parameters where it has none."""

    command: int
    parameters: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    place: tuple[float, float, float] = (0.0, 0.0, 0.0)
    has_place: bool = False


def before_rows(plan: ExportedPlan) -> tuple[MissionItem, ...]:
    """Return takeoff, speed and gimbal: what comes before the first waypoint."""
    first = plan.waypoints[0]
    climb_m = max(first.height_above_takeoff_m, 0.0)
    gimbal = [] if first.gimbal_pitch_deg is None else [_gimbal(first.gimbal_pitch_deg)]
    takeoff = MissionItem(TAKEOFF, place=(0.0, 0.0, climb_m), has_place=True)
    return takeoff, _speed(first.speed_mps), *gimbal


def rows(plan: ExportedPlan, photos: PhotoTrigger | None) -> Iterator[MissionItem]:
    """Yield the waypoints, with photos from the first to the last, and changes between them."""
    speed_mps = plan.waypoints[0].speed_mps
    for index, each in enumerate(plan.waypoints):
        yield _waypoint(each)
        if index == 0:
            yield from _photos_on(photos)
        elif each.gimbal_pitch_deg is not None:
            yield _gimbal(each.gimbal_pitch_deg)
        is_last = index == len(plan.waypoints) - 1
        if not is_last and each.speed_mps != speed_mps:
            speed_mps = each.speed_mps
            yield _speed(speed_mps)
    yield from _photos_off(photos)


def after_rows(plan: ExportedPlan) -> tuple[MissionItem, ...]:
    """Return what ends the flight; without any item an autopilot holds its place."""
    if plan.at_end is AtEnd.RETURN_HOME:
        return (MissionItem(RETURN_TO_LAUNCH),)
    if plan.at_end is AtEnd.LAND:
        last = plan.waypoints[-1]
        place = (last.latitude_deg, last.longitude_deg, 0.0)
        return (MissionItem(LAND, place=place, has_place=True),)
    return ()


def _waypoint(waypoint: Waypoint) -> MissionItem:
    place = (waypoint.latitude_deg, waypoint.longitude_deg, waypoint.height_above_takeoff_m)
    return MissionItem(WAYPOINT, (waypoint.loiter_s or 0.0, 0.0, 0.0, 0.0), place, has_place=True)


def _speed(speed_mps: float) -> MissionItem:
    return MissionItem(CHANGE_SPEED, (GROUND_SPEED, speed_mps, UNCHANGED_THROTTLE, 0.0))


def _gimbal(pitch_deg: float) -> MissionItem:
    return MissionItem(
        MOUNT_CONTROL, (pitch_deg, 0.0, 0.0, 0.0), place=(0.0, 0.0, AIMED_BY_MAVLINK)
    )


def _photos_on(photos: PhotoTrigger | None) -> Iterator[MissionItem]:
    if photos is None:
        return
    if photos.every_s is not None:
        yield MissionItem(START_CAPTURE, (0.0, photos.every_s, 0.0, 0.0))
    else:
        yield MissionItem(TRIGGER_DISTANCE, (photos.every_m or 0.0, 0.0, 1.0, 0.0))


def _photos_off(photos: PhotoTrigger | None) -> Iterator[MissionItem]:
    if photos is not None:
        is_timed = photos.every_s is not None
        yield MissionItem(STOP_CAPTURE if is_timed else TRIGGER_DISTANCE)
