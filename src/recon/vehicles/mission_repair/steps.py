"""The steps of a mission repair: ranges, spacing, corners. Each returns the changed waypoints and
one sentence for each kind of change."""

import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, hypot, inf
from typing import Any

from recon.geo.distance import horizontal_distance_m
from recon.model.geo import LatLon
from recon.model.mission import DjiLimits, Waypoint
from recon.model.units import wrap_degrees


@dataclass(frozen=True, slots=True)
class RepairLimits(DjiLimits):
    """DJI's limits, and the margins a repair keeps to them."""

    least_leg_m: float = 1.0
    """Shorter legs are merged. The SDK accepts half of it, but positions are accurate to metres."""
    cut_leg_m: float = 1_990.0
    """Longest piece of a leg that was cut: distances on the globe depend, by less than this
    margin, on the point they are measured from."""
    cut_path_m: float = 29_900.0
    """Longest path of a part when a path is too long for one mission."""
    slowest_mps: float = 1.0
    """Speed to use for 0, which to the SDK means the mission's own speed."""
    corner_margin_m: float = 0.01
    """Margin on a leg between two reduced corners: more than the rounding of 32-bit floats."""
    corner_slack_m: float = 0.005
    """Two corners count as wide as their leg when less than this remains."""
    most_repaired_m: float = 300_000.0
    """Longest path that is divided: a longer one exceeds the aircraft's range, so is a mistake."""


REPAIR_LIMITS = RepairLimits()


@dataclass(frozen=True, slots=True)
class NumberedWaypoint:
    """A waypoint and its number in the ordered mission; an inserted one has the number of the
    waypoint before it and is marked as new."""

    waypoint: Waypoint
    number: int
    is_new: bool = False

    def with_(self, **changes: Any) -> "NumberedWaypoint":
        """Return it with its waypoint changed."""
        return replace(self, waypoint=replace(self.waypoint, **changes))

    def distance_m(self, other: "NumberedWaypoint") -> float:
        """Return the 3D distance, measured from this one."""
        return distance_m(self.waypoint, other.waypoint)


def distance_m(a: Waypoint, b: Waypoint) -> float:
    """Return the 3D distance between two waypoints, in metres, measured from `a`."""
    across_m = horizontal_distance_m(
        LatLon(a.latitude_deg, a.longitude_deg), LatLon(b.latitude_deg, b.longitude_deg)
    )
    return hypot(across_m, b.height_above_takeoff_m - a.height_above_takeoff_m)


def as_sent(value: float) -> float:
    """Return a value rounded to the wire's 32-bit float; tiny values become 0."""
    try:
        return float(struct.unpack(">f", struct.pack(">f", value))[0])
    except OverflowError:
        return inf


def listed(numbers: Iterator[int] | list[int]) -> str:
    """Return waypoint numbers in words: `3`, `3 and 4`, `3 to 7, 9`."""
    runs: list[list[int]] = []
    for number in sorted(set(numbers)):
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    words = [_run(run) for run in runs]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def _run(run: list[int]) -> str:
    if len(run) <= 2:
        return " and ".join(str(number) for number in run)
    return f"{run[0]} to {run[-1]}"


def waypoints(numbers: list[int]) -> str:
    """Return `waypoint 3` or `waypoints 3 to 7`."""
    word = "waypoint" if len(set(numbers)) == 1 else "waypoints"
    return f"{word} {listed(numbers)}"


def into_ranges(
    points: list[NumberedWaypoint], limits: RepairLimits
) -> tuple[list[NumberedWaypoint], list[str]]:
    """Return the waypoints with their numbers in range, and one sentence for each kind of change.

    A negative speed or loiter time is a mistake and is left for the gate to refuse.
    """
    changes: list[str] = []
    for change, sentence in _CHANGES:
        changed = [change(point, limits) for point in points]
        numbers = [new.number for old, new in zip(points, changed, strict=True) if old != new]
        if numbers:
            changes.append(f"{waypoints(numbers)}: {sentence(limits)}")
        points = changed
    return points, changes


def _no_speed(point: NumberedWaypoint, limits: RepairLimits) -> NumberedWaypoint:
    speed_mps = point.waypoint.speed_mps
    is_none = speed_mps >= 0.0 and as_sent(speed_mps) == 0.0
    return point.with_(speed_mps=limits.slowest_mps) if is_none else point


def _too_fast(point: NumberedWaypoint, limits: RepairLimits) -> NumberedWaypoint:
    is_over = as_sent(point.waypoint.speed_mps) > limits.max_speed_mps
    return point.with_(speed_mps=limits.max_speed_mps) if is_over else point


def _too_long(point: NumberedWaypoint, limits: RepairLimits) -> NumberedWaypoint:
    loiter_s = point.waypoint.loiter_s
    is_over = loiter_s is not None and loiter_s > limits.max_loiter_s
    return point.with_(loiter_s=limits.max_loiter_s) if is_over else point


def _pitch(point: NumberedWaypoint, limits: RepairLimits) -> NumberedWaypoint:
    pitch_deg = point.waypoint.gimbal_pitch_deg
    if pitch_deg is None:
        return point
    within_deg = max(limits.min_gimbal_pitch_deg, min(limits.max_gimbal_pitch_deg, pitch_deg))
    return point if within_deg == pitch_deg else point.with_(gimbal_pitch_deg=within_deg)


_CHANGES: tuple[
    tuple[
        Callable[[NumberedWaypoint, RepairLimits], NumberedWaypoint], Callable[[RepairLimits], str]
    ],
    ...,
] = (
    (
        _no_speed,
        lambda limits: (
            f"speed 0 replaced by {limits.slowest_mps:g} m/s (0 means the default to DJI)"
        ),
    ),
    (
        _too_fast,
        lambda limits: f"speed limited to {limits.max_speed_mps:g} m/s, the most DJI accepts",
    ),
    (
        _too_long,
        lambda limits: f"loiter time limited to {limits.max_loiter_s:g} s, the most DJI accepts",
    ),
    (
        _pitch,
        lambda limits: (
            f"gimbal pitch limited to {limits.min_gimbal_pitch_deg:g} to "
            f"{limits.max_gimbal_pitch_deg:g} deg"
        ),
    ),
)


def merge_near(
    points: list[NumberedWaypoint], limits: RepairLimits
) -> tuple[list[NumberedWaypoint], list[str]]:
    """Return the waypoints with those closer than 1 m to the previous one merged into it.

    The kept waypoint does not move, so none moves by 1 m or more.
    """
    kept, changes = [points[0]], list[str]()
    for point in points[1:]:
        apart_m = kept[-1].distance_m(point)
        if apart_m >= limits.least_leg_m:
            kept.append(point)
            continue
        merged, lost = _merged(kept[-1], point, limits)
        kept[-1] = merged
        changes.append(
            f"waypoint {point.number} is {apart_m:.2f} m from waypoint {merged.number} and was "
            f"merged into it{lost}"
        )
    return kept, changes


def _merged(
    first: NumberedWaypoint, second: NumberedWaypoint, limits: RepairLimits
) -> tuple[NumberedWaypoint, str]:
    """The place of the first with the actions of both, and the speed of the second."""
    a, b = first.waypoint, second.waypoint
    lost: list[str] = []
    if a.gimbal_pitch_deg is not None and b.gimbal_pitch_deg not in (None, a.gimbal_pitch_deg):
        lost.append(f"gimbal pitch {a.gimbal_pitch_deg:g} deg of waypoint {first.number}")
    loiter_s = _total_loiter_s(a, b)
    if loiter_s is not None and loiter_s > limits.max_loiter_s:
        lost.append(f"{loiter_s - limits.max_loiter_s:.3g} s of their total loiter time")
        loiter_s = limits.max_loiter_s
    pitch_deg = a.gimbal_pitch_deg if b.gimbal_pitch_deg is None else b.gimbal_pitch_deg
    merged = first.with_(
        speed_mps=b.speed_mps,
        loiter_s=loiter_s,
        gimbal_pitch_deg=pitch_deg,
        corner_radius_m=min(a.corner_radius_m, b.corner_radius_m),
    )
    return merged, f"; lost: {', '.join(lost)}" if lost else ""


def _total_loiter_s(a: Waypoint, b: Waypoint) -> float | None:
    stays = [stay for stay in (a.loiter_s, b.loiter_s) if stay is not None]
    return sum(stays) if stays else None


def divide_long(
    points: list[NumberedWaypoint], limits: RepairLimits
) -> tuple[list[NumberedWaypoint], list[str]]:
    """Return the waypoints with new ones inserted on every leg longer than 2 km."""
    divided, changes = [points[0]], list[str]()
    for a, b in pairwise(points):
        leg_m = a.distance_m(b)
        if leg_m > limits.max_leg_m:
            count = ceil(leg_m / limits.cut_leg_m)
            divided += [_between(a, b, k / count) for k in range(1, count)]
            changes.append(
                f"waypoints {listed([a.number, b.number])} are {leg_m / 1000:.2f} km apart: "
                f"{count - 1} inserted between them"
            )
        divided.append(b)
    return divided, changes


def _between(a: NumberedWaypoint, b: NumberedWaypoint, share: float) -> NumberedWaypoint:
    start, end = a.waypoint, b.waypoint
    east_deg = wrap_degrees(end.longitude_deg - start.longitude_deg)
    rise_m = end.height_above_takeoff_m - start.height_above_takeoff_m
    north_deg = end.latitude_deg - start.latitude_deg
    point = Waypoint(
        latitude_deg=start.latitude_deg + share * north_deg,
        longitude_deg=wrap_degrees(start.longitude_deg + share * east_deg),
        height_above_takeoff_m=start.height_above_takeoff_m + share * rise_m,
        speed_mps=start.speed_mps,
    )
    return NumberedWaypoint(point, a.number, is_new=True)


FLOAT_ROUNDING_M = 1e-6
"""The 0.2 of a 32-bit float is this near to 0.2."""


def fit_corners(
    part: list[NumberedWaypoint], limits: RepairLimits
) -> tuple[list[NumberedWaypoint], list[str]]:
    """Return a part of a curved mission with corner radii that fit their legs."""
    fitted = _ends_sharp([_in_range(point, limits) for point in part], limits)
    fitted = _narrower_than_legs(fitted, limits)
    changed = [new.number for old, new in zip(part, fitted, strict=True) if old != new]
    if not changed:
        return part, []
    return fitted, [f"{waypoints(changed)}: corner radius adjusted to DJI's limits"]


def _in_range(point: NumberedWaypoint, limits: RepairLimits) -> NumberedWaypoint:
    radius_m = point.waypoint.corner_radius_m
    if radius_m < limits.min_corner_radius_m - FLOAT_ROUNDING_M:
        return point.with_(corner_radius_m=limits.min_corner_radius_m)
    if as_sent(radius_m) > limits.max_corner_radius_m:
        return point.with_(corner_radius_m=limits.max_corner_radius_m)
    return point


def _ends_sharp(part: list[NumberedWaypoint], limits: RepairLimits) -> list[NumberedWaypoint]:
    """The first and last waypoint have no corner: DJI requires the least radius there."""
    least_m = limits.min_corner_radius_m
    sharp = list(part)
    for index in (0, -1):
        if abs(sharp[index].waypoint.corner_radius_m - least_m) > FLOAT_ROUNDING_M:
            sharp[index] = sharp[index].with_(corner_radius_m=least_m)
    return sharp


def _narrower_than_legs(
    part: list[NumberedWaypoint], limits: RepairLimits
) -> list[NumberedWaypoint]:
    """Return waypoints whose radii fit each leg; radii only shrink, so earlier legs still fit."""
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
    """Divide a leg between two corners in proportion, keeping the least radius."""
    room_m, least_m = leg_m - limits.corner_margin_m, limits.min_corner_radius_m
    share = room_m / (a_m + b_m)
    first_m = min(max(least_m, a_m * share), room_m - least_m)
    return first_m, room_m - first_m
