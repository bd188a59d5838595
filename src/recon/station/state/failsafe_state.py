"""What the failsafe matrix's runner remembers from one run to the next."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

from recon.model.failsafe_matrix import Activity, FailsafeCondition
from recon.model.mission import Mission


class ReactionOutcome(Enum):
    """What became of an occurrence's reaction."""

    PENDING = "pending"
    """Nothing ordered: its delay runs, or the matrix asks for an alarm only."""
    ORDERED = "ordered"
    REFUSED = "refused"
    """Not sent; tried again a few times."""
    LEFT = "left"
    """No order will follow: an operator's newer order prevails, or it is from before a restart."""


@dataclass(frozen=True, slots=True)
class Occurrence:
    """One condition of one vehicle, from its beginning until it has ended for a while.

    `activity` is what the vehicle did at its beginning. `outcome_text` follows "; " in the alarm.
    """

    condition: FailsafeCondition
    since_ns: int
    seen_ns: int
    activity: Activity
    outcome: ReactionOutcome = ReactionOutcome.PENDING
    outcome_text: str = ""
    tries: int = 0
    retry_at_ns: int = 0


@dataclass(frozen=True, slots=True)
class RemainingMission:
    """Whether what is left of a mission only brings its vehicle home; worked out once for each."""

    mission: Mission
    passed: int
    leads_home: bool


Occurrences = Mapping[FailsafeCondition, Occurrence]
NO_OCCURRENCES: Occurrences = {}


@dataclass(frozen=True)
class FailsafeState:
    """Everything by serial, and the times of the station's own conditions."""

    run_at_ns: int | None = None
    occurrences: Mapping[str, Occurrences] = field(default_factory=dict)
    activities: Mapping[str, Activity] = field(default_factory=dict)
    """Activity at the last run of each vehicle with an occurrence."""
    remaining: Mapping[str, RemainingMission] = field(default_factory=dict)
    awaited_ns: Mapping[str, int] = field(default_factory=dict)
    """Time at which each vehicle of the last run was last missing, while that matters."""
    ticked_ns: int | None = None
    late_ns: tuple[int, ...] = ()
    """Times of late steps, the newest last."""
    is_late: bool = False
    late_since_ns: int = 0
    late_gap_s: float = 0.0
    client_since_ns: int | None = None
    """Time since which any client is connected; None while none is."""
    had_operator: bool = False
    """Whether one stayed long enough to be an operator's."""
    no_client_since_ns: int | None = None
