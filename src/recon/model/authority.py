"""Who leads a vehicle: the pilot, the operator or guidance. Taking over is always explicit."""

from dataclasses import dataclass
from enum import Enum


class AuthorityHolder(Enum):
    """Who may set a vehicle in motion. Anyone may stop it."""

    PILOT = "pilot"
    """The person with the sticks; the station lets go and does not fight."""
    OPERATOR = "operator"
    """A person or a program at the station."""
    GUIDANCE = "guidance"
    """The station's own planning."""


@dataclass(frozen=True, slots=True)
class ControlAuthority:
    """Who leads a vehicle, since when, and how that came about."""

    holder: AuthorityHolder = AuthorityHolder.OPERATOR
    holder_name: str = ""
    since_ns: int = 0
    reason: str = "nobody has taken it yet"
