"""Waypoints that are too near merged, legs that are too long divided."""

from itertools import pairwise
from math import ceil

from recon.model.mission import Waypoint
from recon.model.units import wrap_degrees
from recon.vehicles.mission_repair.limits import RepairLimits
from recon.vehicles.mission_repair.working import Numbered, listed


def merge_near(points: list[Numbered], limits: RepairLimits) -> tuple[list[Numbered], list[str]]:
    """Return the waypoints at least 1 m from the one before, and what became of the others.

    Each is merged into the last one kept, which stays where it is: so none moves by 1 m or more.
    """
    kept, told = [points[0]], list[str]()
    for point in points[1:]:
        apart_m = kept[-1].distance_m(point)
        if apart_m >= limits.least_leg_m:
            kept.append(point)
            continue
        merged, lost = _merged(kept[-1], point, limits)
        kept[-1] = merged
        told.append(
            f"waypoint {point.number} is {apart_m:.2f} m from waypoint {merged.number} and was "
            f"merged into it{lost}"
        )
    return kept, told


def _merged(first: Numbered, second: Numbered, limits: RepairLimits) -> tuple[Numbered, str]:
    """The first one's place with both ones' actions; what is left is flown as from the second."""
    a, b = first.waypoint, second.waypoint
    lost: list[str] = []
    if a.gimbal_pitch_deg is not None and b.gimbal_pitch_deg not in (None, a.gimbal_pitch_deg):
        lost.append(f"gimbal pitch {a.gimbal_pitch_deg:g} deg of waypoint {first.number}")
    loiter_s = _both_stays(a, b)
    if loiter_s is not None and loiter_s > limits.max_loiter_s:
        lost.append(f"{loiter_s - limits.max_loiter_s:.3g} s of their stays together")
        loiter_s = limits.max_loiter_s
    pitch_deg = a.gimbal_pitch_deg if b.gimbal_pitch_deg is None else b.gimbal_pitch_deg
    merged = first.with_(
        speed_mps=b.speed_mps,
        loiter_s=loiter_s,
        gimbal_pitch_deg=pitch_deg,
        corner_radius_m=min(a.corner_radius_m, b.corner_radius_m),
    )
    return merged, f"; lost: {', '.join(lost)}" if lost else ""


def _both_stays(a: Waypoint, b: Waypoint) -> float | None:
    stays = [stay for stay in (a.loiter_s, b.loiter_s) if stay is not None]
    return sum(stays) if stays else None


def divide_long(points: list[Numbered], limits: RepairLimits) -> tuple[list[Numbered], list[str]]:
    """Return the waypoints with new ones on every leg longer than 2 km, and which these are."""
    divided, told = [points[0]], list[str]()
    for a, b in pairwise(points):
        leg_m = a.distance_m(b)
        if leg_m > limits.max_leg_m:
            count = ceil(leg_m / limits.cut_leg_m)
            divided += [_between(a, b, k / count) for k in range(1, count)]
            told.append(
                f"waypoints {listed([a.number, b.number])} are {leg_m / 1000:.2f} km apart: "
                f"{count - 1} more put between them"
            )
        divided.append(b)
    return divided, told


def _between(a: Numbered, b: Numbered, share: float) -> Numbered:
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
    return Numbered(point, a.number, is_new=True)
