"""Station overloaded or suspended: its own steps come too late.

Sticks come from the station ten times a second, so a steered vehicle is held. A mission is flown by
the aircraft itself.
"""

from recon.model.failsafe_matrix import FailsafeCondition, Reaction
from recon.safety.failsafe.row import ALARM, NO_FIXED, FailsafeRow, FlightFacts, cells, hold

RULE = "station_overloaded"


def find(facts: FlightFacts) -> int | None:
    """Return since when the station is late."""
    return facts.station.late_since_ns


ROW = FailsafeRow(
    condition=FailsafeCondition.STATION_OVERLOADED,
    begins="a gap of 1 s in the station's steps, or two of 0.5 s within 10 s",
    ends="it is on time again",
    reactions=frozenset({Reaction.NOTHING, Reaction.ALARM, Reaction.HOLD}),
    why_no_other="a slow computer is no reason to end a flight",
    default=cells(ALARM, hold(), ALARM, ALARM),
    after_s=0.0,
    alarm_rules=frozenset({RULE}),
    find=find,
    fixed=NO_FIXED,
)
