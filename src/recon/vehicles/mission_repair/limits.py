"""What DJI accepts of a mission, with the margins a repair keeps."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DjiLimits:
    """Limits of DJI's Mobile SDK 4 where no other reason is given; distances are 3D, in metres."""

    max_waypoints: int = 99
    """In one packet of the ICD; an app may take fewer."""
    min_waypoints: int = 2

    least_leg_m: float = 1.0
    """The SDK takes half of it; a place known to metres tells no smaller leg."""
    longest_leg_m: float = 2_000.0
    """Also from the first waypoint to the last."""
    cut_leg_m: float = 1_990.0
    """What a longer leg is cut into at most: distances on the globe depend, by less than this
    margin, on the point they are measured from."""
    longest_path_m: float = 30_000.0
    cut_path_m: float = 29_900.0
    """What a part's path is at most when a path is too long for one."""

    lowest_m: float = -200.0
    highest_m: float = 500.0
    fastest_mps: float = 15.0
    slowest_mps: float = 1.0
    """In place of a speed of 0, which to the SDK means the mission's own speed."""
    longest_stay_s: float = 32.767
    lowest_pitch_deg: float = -90.0
    highest_pitch_deg: float = 0.0

    least_radius_m: float = 0.2
    largest_radius_m: float = 1_000.0
    corner_margin_m: float = 0.01
    """Kept free on a leg between two corners that were made smaller: more than the rounding of
    the wire's 32-bit floats."""
    corner_slack_m: float = 0.005
    """From here on two corners are taken for as wide as their leg."""

    most_repaired_m: float = 300_000.0
    """No aircraft of these flies this far: a longer path is a mistake and is not cut up."""


DJI = DjiLimits()
