"""The repair itself, step by step."""

from dataclasses import dataclass, replace
from itertools import pairwise

from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.units import is_finite
from recon.model.vehicle import VehicleProfile
from recon.vehicles.mission_repair.corners import fit_corners
from recon.vehicles.mission_repair.limits import REPAIR_LIMITS, RepairLimits
from recon.vehicles.mission_repair.parts import cut
from recon.vehicles.mission_repair.ranges import into_ranges
from recon.vehicles.mission_repair.spacing import divide_long, merge_near
from recon.vehicles.mission_repair.working import Numbered, distance_m


@dataclass(frozen=True, slots=True)
class Repaired:
    """A mission as it is flown: one part, or several; and what was changed, in sentences."""

    parts: tuple[Mission, ...]
    repairs: tuple[str, ...] = ()


def repair(
    mission: Mission, profile: VehicleProfile, limits: RepairLimits = REPAIR_LIMITS
) -> Repaired:
    """Return a mission in parts that DJI and the vehicle's app accept, or unchanged. Pure."""
    if not _is_repairable(mission, limits):
        return Repaired((mission,))
    numbered = [Numbered(point, number) for number, point in enumerate(mission.waypoints, start=1)]
    points, told = into_ranges(numbered, limits)
    for step in (merge_near, divide_long):
        points, sentences = step(points, limits)
        told += sentences
    if len(points) < limits.min_waypoints:
        return Repaired((mission,))
    most = max(limits.min_waypoints, min(limits.max_waypoints, profile.max_waypoints))
    parts, why = cut(points, most, limits)
    if why:
        told.append(_in_parts(parts, why))
    if mission.curved:
        parts, sentences = _with_corners(parts, limits)
        told += sentences
    if not told or not all(_has_fitting_legs(part, limits) for part in parts):
        return Repaired((mission,))
    return Repaired(tuple(_missions(mission, parts)), tuple(told))


def joined(parts: tuple[Mission, ...]) -> Mission:
    """Return parts as the one mission they are flown as; a part begins where the last one ended."""
    waypoints = parts[0].waypoints
    for part in parts[1:]:
        # The shared waypoint is left as the later part says: its speed is that of the next leg.
        waypoints = (
            *waypoints[:-1],
            _shared(waypoints[-1], part.waypoints[0]),
            *part.waypoints[1:],
        )
    return replace(parts[-1], waypoints=waypoints)


def _shared(end: Waypoint, beginning: Waypoint) -> Waypoint:
    """The waypoint between two parts: its actions are the earlier one's, its speed the later's."""
    return replace(end, speed_mps=beginning.speed_mps)


def _is_repairable(mission: Mission, limits: RepairLimits) -> bool:
    points = mission.waypoints
    if len(points) < limits.min_waypoints or not all(_is_sound(p, limits) for p in points):
        return False
    has_actions = any(p.loiter_s is not None or p.gimbal_pitch_deg is not None for p in points)
    if mission.curved and has_actions:
        return False
    return sum(distance_m(a, b) for a, b in pairwise(points)) <= limits.most_repaired_m


def _is_sound(point: Waypoint, limits: RepairLimits) -> bool:
    """Whether its place and numbers are such as a repair may go by."""
    numbers = (point.height_above_takeoff_m, point.speed_mps, point.corner_radius_m)
    actions = (point.loiter_s or 0.0, point.gimbal_pitch_deg or 0.0)
    if not is_finite(*numbers, *actions):
        return False
    is_place = LatLon(point.latitude_deg, point.longitude_deg).is_valid()
    is_high = limits.min_height_m <= point.height_above_takeoff_m <= limits.max_height_m
    return is_place and is_high and point.speed_mps >= 0.0 and (point.loiter_s or 0.0) >= 0.0


def _has_fitting_legs(part: list[Numbered], limits: RepairLimits) -> bool:
    """Whether cutting has helped: near the poles a leg's length depends on where it is measured."""
    legs_m = [a.distance_m(b) for a, b in (*pairwise(part), (part[0], part[-1]))]
    return all(limits.least_leg_m <= leg_m <= limits.max_leg_m for leg_m in legs_m)


def _in_parts(parts: list[list[Numbered]], why: str) -> str:
    ends = ", ".join(f"{part[0].number} to {part[-1].number}" for part in parts)
    return (
        f"flown in {len(parts)} parts (waypoints {ends}), for {why}; it hovers at the end of each "
        "part, and the next one is only flown if link and authority were whole since the order"
    )


def _with_corners(
    parts: list[list[Numbered]], limits: RepairLimits
) -> tuple[list[list[Numbered]], list[str]]:
    fitted, told = list[list[Numbered]](), list[str]()
    for part in parts:
        points, sentences = fit_corners(part, limits)
        fitted.append(points)
        told += sentences
    return fitted, told


def _missions(mission: Mission, parts: list[list[Numbered]]) -> list[Mission]:
    """The parts as missions: only the last may land, and what was done at its shared waypoint is
    not done again by the next part."""
    made: list[Mission] = []
    for index, part in enumerate(parts):
        points = tuple(point.waypoint for point in part)
        if index > 0:
            again = replace(points[0], loiter_s=None, gimbal_pitch_deg=None)
            points = (again, *points[1:])
        lands = mission.land_at_end and index == len(parts) - 1
        made.append(replace(mission, waypoints=points, land_at_end=lands))
    return made
