"""A value together with the moment it was received."""

from dataclasses import dataclass
from typing import Generic, TypeVar

from recon.model.units import NS_PER_S

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Stamped(Generic[T]):
    """A value that knows its age; `value` is None while it is unknown."""

    value: T | None = None
    received_at_ns: int | None = None

    def age_s(self, now_ns: int) -> float | None:
        """Return the value's age in seconds, or None when nothing was ever received."""
        if self.received_at_ns is None:
            return None
        return (now_ns - self.received_at_ns) / NS_PER_S

    def is_known(self) -> bool:
        """Return whether there is a value."""
        return self.value is not None
