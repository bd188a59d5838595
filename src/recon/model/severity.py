"""Severity of an alarm."""

from enum import Enum


class Severity(Enum):
    """Severity levels, the worst first."""

    CRITICAL = "critical"
    ERROR = "error"
    WARNING = "warning"
    INFO = "info"

    @property
    def rank(self) -> int:
        """0 for the worst."""
        return tuple(Severity).index(self)

    def is_worse_than(self, other: "Severity") -> bool:
        """Return whether this is the worse of the two."""
        return self.rank < other.rank
