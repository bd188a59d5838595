"""Missions cut into parts that an app and the SDK take."""

from itertools import accumulate, pairwise

from recon.vehicles.mission_repair.limits import RepairLimits
from recon.vehicles.mission_repair.working import Numbered


def cut(
    points: list[Numbered], most: int, limits: RepairLimits
) -> tuple[list[list[Numbered]], str]:
    """Return the parts, each beginning where the one before ends, and why there are several.

    Always as long a part as can be; a single leg always is one, so an end is always found.
    """
    along_m = list(accumulate((a.distance_m(b) for a, b in pairwise(points)), initial=0.0))
    parts: list[list[Numbered]] = []
    start = 0
    while start < len(points) - 1:
        end = _last_that_fits(points, along_m, start, most, limits)
        parts.append(points[start : end + 1])
        start = end
    return parts, "" if len(parts) == 1 else _why(points, along_m[-1], most, limits)


def _last_that_fits(
    points: list[Numbered], along_m: list[float], start: int, most: int, limits: RepairLimits
) -> int:
    """The farthest end of a part from `start`; `along_m`: how far along each point is."""
    is_whole = along_m[-1] - along_m[start] <= limits.max_path_m
    longest_m = limits.max_path_m if is_whole else limits.cut_path_m
    for end in range(min(start + most, len(points)) - 1, start + 1, -1):
        is_short = along_m[end] - along_m[start] <= longest_m
        if is_short and _may_span(points[start], points[end], limits):
            return end
    return start + 1


def _may_span(first: Numbered, last: Numbered, limits: RepairLimits) -> bool:
    return limits.least_leg_m <= first.distance_m(last) <= limits.max_leg_m


def _why(points: list[Numbered], path_m: float, most: int, limits: RepairLimits) -> str:
    if len(points) > most:
        return f"{len(points)} waypoints are more than the {most} its app takes"
    if path_m > limits.max_path_m:
        most_km = limits.max_path_m / 1000.0
        return f"its path is {path_m / 1000:.1f} km, more than the {most_km:g} km DJI takes"
    span_m = points[0].distance_m(points[-1])
    if span_m < limits.least_leg_m:
        return (
            f"it ends {span_m:.2f} m from where it begins, and DJI wants {limits.least_leg_m:g} m"
        )
    return f"it ends {span_m / 1000:.2f} km from where it begins, and DJI takes 2 km at most"
