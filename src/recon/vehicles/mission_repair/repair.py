"""The repair of a mission, and its division into parts."""

from dataclasses import dataclass, replace
from itertools import accumulate, pairwise

from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.units import is_finite
from recon.model.vehicle import VehicleProfile
from recon.vehicles.mission_repair.steps import (
    REPAIR_LIMITS,
    NumberedWaypoint,
    RepairLimits,
    distance_m,
    divide_long,
    fit_corners,
    into_ranges,
    merge_near,
)


@dataclass(frozen=True, slots=True)
class Repaired:
    """A mission in one or several parts, and the repairs as sentences."""

    parts: tuple[Mission, ...]
    repairs: tuple[str, ...] = ()


def repair(
    mission: Mission, profile: VehicleProfile, limits: RepairLimits = REPAIR_LIMITS
) -> Repaired:
    """Return a mission in parts that DJI and the vehicle's app accept, or unchanged."""
    if not _is_repairable(mission, limits):
        return Repaired((mission,))
    numbered = [
        NumberedWaypoint(point, number) for number, point in enumerate(mission.waypoints, start=1)
    ]
    points, changes = into_ranges(numbered, limits)
    for step in (merge_near, divide_long):
        points, sentences = step(points, limits)
        changes += sentences
    if len(points) < limits.min_waypoints:
        return Repaired((mission,))
    most = max(limits.min_waypoints, min(limits.max_waypoints, profile.max_waypoints))
    parts, why = cut(points, most, limits)
    if why:
        changes.append(_in_parts(parts, why))
    if mission.curved:
        parts, sentences = _with_corners(parts, limits)
        changes += sentences
    if not changes or not all(_has_fitting_legs(part, limits) for part in parts):
        return Repaired((mission,))
    return Repaired(tuple(_missions(mission, parts)), tuple(changes))


def joined(parts: tuple[Mission, ...]) -> Mission:
    """Return the parts joined into one mission; each part begins where the last one ended."""
    waypoints = parts[0].waypoints
    for part in parts[1:]:
        # The speed at a shared waypoint is that of the next leg.
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
    """Whether its position and values are valid."""
    numbers = (point.height_above_takeoff_m, point.speed_mps, point.corner_radius_m)
    actions = (point.loiter_s or 0.0, point.gimbal_pitch_deg or 0.0)
    if not is_finite(*numbers, *actions):
        return False
    is_place = LatLon(point.latitude_deg, point.longitude_deg).is_valid()
    is_high = limits.min_height_m <= point.height_above_takeoff_m <= limits.max_height_m
    return is_place and is_high and point.speed_mps >= 0.0 and (point.loiter_s or 0.0) >= 0.0


def _has_fitting_legs(part: list[NumberedWaypoint], limits: RepairLimits) -> bool:
    """Whether all legs fit: near the poles a leg's length depends on where it is measured."""
    legs_m = [a.distance_m(b) for a, b in (*pairwise(part), (part[0], part[-1]))]
    return all(limits.least_leg_m <= leg_m <= limits.max_leg_m for leg_m in legs_m)


def _in_parts(parts: list[list[NumberedWaypoint]], why: str) -> str:
    ends = ", ".join(f"{part[0].number} to {part[-1].number}" for part in parts)
    return (
        f"flown in {len(parts)} parts (waypoints {ends}): {why}; it hovers at the end of each "
        "part, and continues only if link and authority were uninterrupted since the order"
    )


def _with_corners(
    parts: list[list[NumberedWaypoint]], limits: RepairLimits
) -> tuple[list[list[NumberedWaypoint]], list[str]]:
    fitted, changes = list[list[NumberedWaypoint]](), list[str]()
    for part in parts:
        points, sentences = fit_corners(part, limits)
        fitted.append(points)
        changes += sentences
    return fitted, changes


def _missions(mission: Mission, parts: list[list[NumberedWaypoint]]) -> list[Mission]:
    """The parts as missions: only the last may land, and actions at a shared waypoint are not
    repeated by the next part."""
    made: list[Mission] = []
    for index, part in enumerate(parts):
        points = tuple(point.waypoint for point in part)
        if index > 0:
            again = replace(points[0], loiter_s=None, gimbal_pitch_deg=None)
            points = (again, *points[1:])
        lands = mission.land_at_end and index == len(parts) - 1
        made.append(replace(mission, waypoints=points, land_at_end=lands))
    return made


def cut(
    points: list[NumberedWaypoint], most: int, limits: RepairLimits
) -> tuple[list[list[NumberedWaypoint]], str]:
    """Return the parts, each beginning where the previous one ends, and the reason for several.

    Each part is as long as possible; a single leg always fits.
    """
    along_m = list(accumulate((a.distance_m(b) for a, b in pairwise(points)), initial=0.0))
    parts: list[list[NumberedWaypoint]] = []
    start = 0
    while start < len(points) - 1:
        end = _last_that_fits(points, along_m, start, most, limits)
        parts.append(points[start : end + 1])
        start = end
    return parts, "" if len(parts) == 1 else _why(points, along_m[-1], most, limits)


def _last_that_fits(
    points: list[NumberedWaypoint],
    along_m: list[float],
    start: int,
    most: int,
    limits: RepairLimits,
) -> int:
    """The farthest end of a part from `start`; `along_m`: how far along each point is."""
    is_whole = along_m[-1] - along_m[start] <= limits.max_path_m
    longest_m = limits.max_path_m if is_whole else limits.cut_path_m
    for end in range(min(start + most, len(points)) - 1, start + 1, -1):
        is_short = along_m[end] - along_m[start] <= longest_m
        if is_short and _may_span(points[start], points[end], limits):
            return end
    return start + 1


def _may_span(first: NumberedWaypoint, last: NumberedWaypoint, limits: RepairLimits) -> bool:
    return limits.least_leg_m <= first.distance_m(last) <= limits.max_leg_m


def _why(points: list[NumberedWaypoint], path_m: float, most: int, limits: RepairLimits) -> str:
    if len(points) > most:
        return f"{len(points)} waypoints exceed the {most} that its app accepts"
    if path_m > limits.max_path_m:
        most_km = limits.max_path_m / 1000.0
        return f"its path is {path_m / 1000:.1f} km, more than the {most_km:g} km DJI accepts"
    span_m = points[0].distance_m(points[-1])
    if span_m < limits.least_leg_m:
        return f"it ends {span_m:.2f} m from where it begins, DJI requires {limits.least_leg_m:g} m"
    return f"it ends {span_m / 1000:.2f} km from where it begins, DJI accepts 2 km at most"
