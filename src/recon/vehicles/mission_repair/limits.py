"""What DJI accepts of a mission, and the margins a repair keeps."""

from dataclasses import dataclass

from recon.model.dji import DjiLimits


@dataclass(frozen=True, slots=True)
class RepairLimits(DjiLimits):
    """DJI's limits, and where a repair stops short of them."""

    least_leg_m: float = 1.0
    """Shorter legs are merged. The SDK accepts half of it, but waypoints are known to metres."""
    cut_leg_m: float = 1_990.0
    """Longest piece of a leg that was cut: distances on the globe depend, by less than this
    margin, on the point they are measured from."""
    cut_path_m: float = 29_900.0
    """Longest path of a part when a path is too long for one mission."""
    slowest_mps: float = 1.0
    """In place of a speed of 0, which to the SDK means the mission's own speed."""
    corner_margin_m: float = 0.01
    """Kept free on a leg between two corners that were made smaller: more than the rounding of
    the wire's 32-bit floats."""
    corner_slack_m: float = 0.005
    """From here on two corners are taken for as wide as their leg."""
    most_repaired_m: float = 300_000.0
    """No aircraft of these flies this far: a longer path is a mistake and is not cut up."""


REPAIR_LIMITS = RepairLimits()
