"""Missions: WGS84 positions, heights above takeoff."""

from dataclasses import dataclass


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


@dataclass(frozen=True, slots=True)
class Mission:
    """A waypoint mission. `curved` rounds the corners and carries no loiter or gimbal action."""

    waypoints: tuple[Waypoint, ...]
    land_at_end: bool = False
    curved: bool = False
    purpose: str = ""
