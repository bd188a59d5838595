"""Speeds, stays and gimbal angles brought into their ranges."""

from collections.abc import Callable

from recon.vehicles.mission_repair.limits import RepairLimits
from recon.vehicles.mission_repair.working import Numbered, as_sent, waypoints

Change = Callable[[Numbered], Numbered]


def into_ranges(points: list[Numbered], limits: RepairLimits) -> tuple[list[Numbered], list[str]]:
    """Return the waypoints with their numbers in range, and one sentence for each kind of change.

    A negative speed or stay is no number too large or too small but a mistake: it stays.
    """
    told: list[str] = []
    for change, sentence in _CHANGES:
        changed = [change(point, limits) for point in points]
        numbers = [new.number for old, new in zip(points, changed, strict=True) if old != new]
        if numbers:
            told.append(f"{waypoints(numbers)}: {sentence(limits)}")
        points = changed
    return points, told


def _no_speed(point: Numbered, limits: RepairLimits) -> Numbered:
    speed_mps = point.waypoint.speed_mps
    is_none = speed_mps >= 0.0 and as_sent(speed_mps) == 0.0
    return point.with_(speed_mps=limits.slowest_mps) if is_none else point


def _too_fast(point: Numbered, limits: RepairLimits) -> Numbered:
    is_over = as_sent(point.waypoint.speed_mps) > limits.max_speed_mps
    return point.with_(speed_mps=limits.max_speed_mps) if is_over else point


def _too_long(point: Numbered, limits: RepairLimits) -> Numbered:
    loiter_s = point.waypoint.loiter_s
    is_over = loiter_s is not None and loiter_s > limits.max_loiter_s
    return point.with_(loiter_s=limits.max_loiter_s) if is_over else point


def _pitch(point: Numbered, limits: RepairLimits) -> Numbered:
    pitch_deg = point.waypoint.gimbal_pitch_deg
    if pitch_deg is None:
        return point
    within_deg = max(limits.min_gimbal_pitch_deg, min(limits.max_gimbal_pitch_deg, pitch_deg))
    return point if within_deg == pitch_deg else point.with_(gimbal_pitch_deg=within_deg)


_CHANGES: tuple[
    tuple[Callable[[Numbered, RepairLimits], Numbered], Callable[[RepairLimits], str]], ...
] = (
    (
        _no_speed,
        lambda limits: f"speed 0 means another speed to DJI; {limits.slowest_mps:g} m/s is flown",
    ),
    (_too_fast, lambda limits: f"flown at {limits.max_speed_mps:g} m/s, the fastest DJI accepts"),
    (_too_long, lambda limits: f"stays {limits.max_loiter_s:g} s, the longest DJI accepts"),
    (
        _pitch,
        lambda limits: (
            f"gimbal pitch brought into {limits.min_gimbal_pitch_deg:g} to "
            f"{limits.max_gimbal_pitch_deg:g} deg"
        ),
    ),
)
