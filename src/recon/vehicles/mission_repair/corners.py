"""Corner radii of curved missions: in range, and two of them never as wide as their leg."""

from itertools import pairwise

from recon.vehicles.mission_repair.limits import RepairLimits
from recon.vehicles.mission_repair.working import Numbered, as_sent, waypoints

FLOAT_ROUNDING_M = 1e-6
"""The 0.2 of a 32-bit float is this near to 0.2."""


def fit_corners(part: list[Numbered], limits: RepairLimits) -> tuple[list[Numbered], list[str]]:
    """Return a part of a curved mission with corners that fit, and which ones were changed."""
    fitted = _ends_sharp([_in_range(point, limits) for point in part], limits)
    fitted = _narrower_than_legs(fitted, limits)
    changed = [new.number for old, new in zip(part, fitted, strict=True) if old != new]
    if not changed:
        return part, []
    return fitted, [f"{waypoints(changed)}: corner radius made to fit what DJI accepts"]


def _in_range(point: Numbered, limits: RepairLimits) -> Numbered:
    radius_m = point.waypoint.corner_radius_m
    if radius_m < limits.min_corner_radius_m - FLOAT_ROUNDING_M:
        return point.with_(corner_radius_m=limits.min_corner_radius_m)
    if as_sent(radius_m) > limits.max_corner_radius_m:
        return point.with_(corner_radius_m=limits.max_corner_radius_m)
    return point


def _ends_sharp(part: list[Numbered], limits: RepairLimits) -> list[Numbered]:
    """The first and the last waypoint have no corner: DJI wants the least radius there."""
    least_m = limits.min_corner_radius_m
    sharp = list(part)
    for index in (0, -1):
        if abs(sharp[index].waypoint.corner_radius_m - least_m) > FLOAT_ROUNDING_M:
            sharp[index] = sharp[index].with_(corner_radius_m=least_m)
    return sharp


def _narrower_than_legs(part: list[Numbered], limits: RepairLimits) -> list[Numbered]:
    """Each leg in turn; radii only shrink, so what fits already goes on fitting."""
    fitted = list(part)
    for index, (a, b) in enumerate(pairwise(part)):
        leg_m = a.distance_m(b)
        radii = [fitted[index + side].waypoint.corner_radius_m for side in (0, 1)]
        if sum(radii) < leg_m - limits.corner_slack_m:
            continue
        for side, radius_m in enumerate(_shared(radii[0], radii[1], leg_m, limits)):
            if radius_m < radii[side]:
                point = fitted[index + side]
                fitted[index + side] = point.with_(corner_radius_m=radius_m)
    return fitted


def _shared(a_m: float, b_m: float, leg_m: float, limits: RepairLimits) -> tuple[float, float]:
    """What two corners get of their leg, in proportion, and the least radius in any case."""
    room_m, least_m = leg_m - limits.corner_margin_m, limits.min_corner_radius_m
    share = room_m / (a_m + b_m)
    first_m = min(max(least_m, a_m * share), room_m - least_m)
    return first_m, room_m - first_m
