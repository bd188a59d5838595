"""Constants and small conversions of units."""

import math

NS_PER_S = 1_000_000_000


def seconds_to_ns(seconds: float) -> int:
    """Return a duration in whole nanoseconds."""
    return round(seconds * NS_PER_S)


def ns_to_seconds(nanoseconds: int) -> float:
    """Return a duration in seconds."""
    return nanoseconds / NS_PER_S


def wrap_degrees(angle_deg: float) -> float:
    """Return the same angle in [-180, 180)."""
    return (angle_deg + 180.0) % 360.0 - 180.0


def is_finite(*values: float) -> bool:
    """Return whether every value is neither NaN nor infinite."""
    return all(math.isfinite(value) for value in values)
