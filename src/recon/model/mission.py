"""Missions: WGS84 positions, heights above takeoff."""

from dataclasses import dataclass
from functools import cached_property


@dataclass(frozen=True, slots=True)
class Waypoint:
    """One waypoint. `speed_mps` holds from here to the next waypoint; None means no action."""

    latitude_deg: float
    longitude_deg: float
    height_above_takeoff_m: float
    speed_mps: float
    corner_radius_m: float = 0.2
    loiter_s: float | None = None
    gimbal_pitch_deg: float | None = None


@dataclass(frozen=True)
class Mission:
    """A waypoint mission. `curved` rounds the corners and carries no loiter or gimbal action."""

    waypoints: tuple[Waypoint, ...]
    land_at_end: bool = False
    curved: bool = False
    purpose: str = ""

    @cached_property
    def bounds(self) -> tuple[float, float, float]:
        """The fastest speed, and the lowest and highest height above takeoff, of all waypoints."""
        heights_m = [waypoint.height_above_takeoff_m for waypoint in self.waypoints]
        speeds_mps = (waypoint.speed_mps for waypoint in self.waypoints)
        return max(speeds_mps), min(heights_m), max(heights_m)
