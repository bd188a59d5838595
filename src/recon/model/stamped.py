"""A value with its receive time."""

from dataclasses import dataclass
from typing import Generic, TypeVar

from recon.model.units import NS_PER_S

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
