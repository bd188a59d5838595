"""Missions (WGS84 positions, heights above takeoff), and DJI's limits for them and for sticks.

What lies outside DJI's limits is rejected without an error: the app acknowledges, and nothing
happens (decisions on the ICD, "What DJI accepts"). The limits of Mobile SDK 4 are written here
once for all of the station; the simulator has a copy of its own on purpose.
"""

from dataclasses import dataclass
from functools import cached_property


@dataclass(frozen=True, slots=True)
class DjiLimits:
    """Missions and virtual sticks; heights are above takeoff, distances in three dimensions."""

    max_waypoints: int = 99
    """Waypoints in one ICD packet; an app may accept fewer (`VehicleProfile.max_waypoints`)."""
    min_waypoints: int = 2
    min_leg_m: float = 0.5
    max_leg_m: float = 2_000.0
    """Longest leg; also limits the distance from the first waypoint to the last."""
    max_path_m: float = 30_000.0
    min_height_m: float = -200.0
    max_height_m: float = 500.0
    max_speed_mps: float = 15.0
    max_loiter_s: float = 32.767
    """The SDK counts milliseconds in 16 bits, signed."""
    min_gimbal_pitch_deg: float = -90.0
    max_gimbal_pitch_deg: float = 0.0
    min_corner_radius_m: float = 0.2
    max_corner_radius_m: float = 1_000.0
    fastest_mps: float = 25.0
    """Ground speed in strong wind that none of these aircraft exceeds; telemetry is held to it."""
    fastest_vertical_mps: float = 12.0
    """Fastest vertical speed: twice the usual climb and sink (5 to 8 m/s), as gusts add to it."""


DJI = DjiLimits()


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
