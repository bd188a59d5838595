"""Limits of DJI's Mobile SDK 4, written once for all of the station.

What lies outside is rejected without an error: the app acknowledges, and nothing happens (decisions
on the ICD, "What DJI accepts"). The simulator has a copy of its own on purpose.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DjiLimits:
    """Missions and virtual sticks; heights are above takeoff, distances in three dimensions."""

    max_waypoints: int = 99
    """In one packet of the ICD; an app may accept fewer (`VehicleProfile.max_waypoints`)."""
    min_waypoints: int = 2
    min_leg_m: float = 0.5
    max_leg_m: float = 2_000.0
    """Also from the first waypoint to the last."""
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


DJI = DjiLimits()
