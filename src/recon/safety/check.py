"""One point of the preflight checklist, and its state."""

from dataclasses import dataclass
from enum import Enum


class CheckState(Enum):
    """State of a point, the best first."""

    OK = "ok"
    ATTENTION = "attention"
    """An operator should look; it holds nothing back."""
    UNKNOWN = "unknown"
    FAILS = "fails"


@dataclass(frozen=True, slots=True)
class Check:
    """A point: `key` never changes, `name` is for operators; the finding, and what to do about it
    (empty when it is ok)."""

    key: str
    name: str
    state: CheckState
    text: str
    to_do: str = ""

    @property
    def holds_back(self) -> bool:
        """Whether no mission is flown in this state."""
        return self.state in (CheckState.FAILS, CheckState.UNKNOWN)


@dataclass(frozen=True, slots=True)
class Point:
    """A point's key and name, which makes its checks."""

    key: str
    name: str

    def ok(self, text: str) -> Check:
        """Return a passed check."""
        return Check(self.key, self.name, CheckState.OK, text)

    def attention(self, text: str, to_do: str) -> Check:
        """Return a check that an operator should look at."""
        return Check(self.key, self.name, CheckState.ATTENTION, text, to_do)

    def unknown(self, text: str, to_do: str) -> Check:
        """Return the check of an unknown value."""
        return Check(self.key, self.name, CheckState.UNKNOWN, text, to_do)

    def fails(self, text: str, to_do: str) -> Check:
        """Return a failed check."""
        return Check(self.key, self.name, CheckState.FAILS, text, to_do)
