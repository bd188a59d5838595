"""What DJI's Mobile SDK 4 accepts of missions and sticks.

Everything else is rejected silently: the app acknowledges the packet, and nothing happens
(decisions on the ICD, "What DJI accepts").
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import isfinite, sqrt

from recon import wire
from recon.sim.flight.mission import MissionPoint


@dataclass(frozen=True, slots=True)
class SdkLimits:
    """Mobile SDK 4 limits of missions and virtual sticks, and the aircraft's own settings.

    Not taken from `recon.model.mission` on purpose: a wrong number there must show as a mission
    that the station sends and the simulated aircraft rejects.
    """

    max_waypoints: int = 99
    least_spacing_m: float = 0.5
    largest_spacing_m: float = 2_000.0
    longest_path_m: float = 30_000.0
    lowest_m: float = -200.0
    highest_m: float = 500.0
    farthest_m: float = 5_000.0
    fastest_mps: float = 15.0
    longest_stay_s: float = 32.767
    least_radius_m: float = 0.2
    largest_radius_m: float = 1_000.0


RADIUS_TOLERANCE_M = 1e-3
"""0.2 as a 32-bit float on the wire is not 0.2."""


def mission_problem(
    points: Sequence[MissionPoint], is_curved: bool, limits: SdkLimits
) -> str | None:
    """Return why the SDK would reject a mission, else None. Home is at (0, 0)."""
    if not 2 <= len(points) <= limits.max_waypoints:
        return f"{len(points)} waypoints, accepted are 2 to {limits.max_waypoints}"
    for number, point in enumerate(points, 1):
        problem = _point_problem(point, limits)
        if problem is not None:
            return f"waypoint {number}: {problem}"
    return _spacing_problem(points, limits) or (
        _corner_problem(points, limits) if is_curved else None
    )


def stick_problem(command: wire.VirtualStickCommand, limits: SdkLimits) -> str | None:
    """Return why the SDK would reject a stick command, else None."""
    ranges = (
        ("velocity x", command.velocity_x_mps, -limits.fastest_mps, limits.fastest_mps),
        ("velocity y", command.velocity_y_mps, -limits.fastest_mps, limits.fastest_mps),
        ("yaw", command.yaw_deg, -180.0, 180.0),
        ("height", command.height_above_takeoff_m, 0.0, limits.highest_m),
    )
    for name, value, low, high in ranges:
        if not low <= value <= high:
            return f"{name} {value:g}, accepted is {low:g} to {high:g}"
    if command.mode not in (0, 1):
        return f"mode {command.mode}, accepted is 0 or 1"
    return None if isfinite(command.timeout_s) else f"timeout {command.timeout_s}, not finite"


def _point_problem(point: MissionPoint, limits: SdkLimits) -> str | None:
    if not all(isfinite(v) for v in (point.north_m, point.east_m, point.height_m)):
        return "position is not finite"
    if not limits.lowest_m <= point.height_m <= limits.highest_m:
        return f"height {point.height_m:.1f} m above takeoff"
    if not 0.0 < point.speed_mps <= limits.fastest_mps:
        return f"speed {point.speed_mps:g} m/s"
    if point.north_m**2 + point.east_m**2 > limits.farthest_m**2:
        return "too far from home"
    if point.loiter_s is not None and not 0.0 <= point.loiter_s <= limits.longest_stay_s:
        return f"stay of {point.loiter_s:g} s"
    if point.gimbal_pitch_deg is not None and not -90.0 <= point.gimbal_pitch_deg <= 0.0:
        return f"gimbal pitch {point.gimbal_pitch_deg:g} degrees"
    return None


def _spacing_problem(points: Sequence[MissionPoint], limits: SdkLimits) -> str | None:
    lengths = [_distance_m(a, b) for a, b in pairwise(points)]
    # The SDK checks the way from the last waypoint to the first as well, though it is not flown.
    for length in (*lengths, _distance_m(points[-1], points[0])):
        if not limits.least_spacing_m <= length <= limits.largest_spacing_m:
            return f"waypoints {length:.2f} m apart"
    total = sum(lengths)
    return f"path of {total:.0f} m" if total > limits.longest_path_m else None


def _corner_problem(points: Sequence[MissionPoint], limits: SdkLimits) -> str | None:
    for number, point in enumerate(points, 1):
        radius = point.corner_radius_m
        low, high = limits.least_radius_m - RADIUS_TOLERANCE_M, limits.largest_radius_m
        if not low <= radius <= high:
            return f"waypoint {number}: corner radius {radius:g} m"
        if number in (1, len(points)) and radius > limits.least_radius_m + RADIUS_TOLERANCE_M:
            return f"waypoint {number}: corner radius {radius:g} m at an end of the mission"
    for a, b in pairwise(points):
        if a.corner_radius_m + b.corner_radius_m >= _distance_m(a, b):
            return "corner radii longer than the leg between them"
    return None


def _distance_m(a: MissionPoint, b: MissionPoint) -> float:
    return sqrt(
        (a.north_m - b.north_m) ** 2 + (a.east_m - b.east_m) ** 2 + (a.height_m - b.height_m) ** 2
    )
