"""Units: constants, small conversions, and a value with its receive time."""

import math
from dataclasses import dataclass
from typing import Generic, TypeVar

NS_PER_S = 1_000_000_000
NS_PER_MS = 1_000_000
HECTARE_M2 = 10_000.0
M_PER_FT = 0.3048
M_PER_DEG = 111_195.0
"""Along a meridian, on a sphere of the earth's mean radius."""


def seconds_to_ns(seconds: float) -> int:
    """Return a duration in whole nanoseconds."""
    return round(seconds * NS_PER_S)


def unix_ns(unix_s: float) -> int:
    """Return Unix seconds in nanoseconds, to the microsecond: a float holds no more of today."""
    return round(unix_s * 1e6) * (NS_PER_S // 1_000_000)


def ns_to_seconds(nanoseconds: int) -> float:
    """Return a duration in seconds."""
    return nanoseconds / NS_PER_S


def wrap_degrees(angle_deg: float) -> float:
    """Return the same angle in [-180, 180)."""
    return (angle_deg + 180.0) % 360.0 - 180.0


def is_finite(*values: float) -> bool:
    """Return whether every value is neither NaN nor infinite."""
    return all(math.isfinite(value) for value in values)


T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Stamped(Generic[T]):
    """A value and when it was received; `value` is None while unknown."""

    value: T | None = None
    received_at_ns: int | None = None

    def age_s(self, now_ns: int) -> float | None:
        """Return the age in seconds, None when nothing was received yet."""
        if self.received_at_ns is None:
            return None
        return (now_ns - self.received_at_ns) / NS_PER_S

    def is_known(self) -> bool:
        """Return whether there is a value."""
        return self.value is not None
