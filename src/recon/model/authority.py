"""Control authority over a vehicle: pilot, operator or guidance. Transfers are explicit."""

from dataclasses import dataclass
from enum import Enum


class AuthorityHolder(Enum):
    """The party that may set a vehicle in motion. Any party may stop it."""

    PILOT = "pilot"
    """The person with the controller; the station stops commanding."""
    OPERATOR = "operator"
    """A user or a program at the station."""
    GUIDANCE = "guidance"
    """The station's own planning."""


@dataclass(frozen=True, slots=True)
class ControlAuthority:
    """The authority holder of a vehicle, since when, and why."""

    holder: AuthorityHolder = AuthorityHolder.OPERATOR
    holder_name: str = ""
    since_ns: int = 0
    reason: str = "not yet transferred"
