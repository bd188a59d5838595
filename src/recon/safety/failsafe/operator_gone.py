"""Operator gone: no client is connected, after one was for half a minute.

Only that edge counts: not a station without any client so far, nor a command of the shell, which
connects for a moment, nor the page of an observer. A steered vehicle is held by its stream as soon
as its own client goes. A mission continues for a minute, the time to open the console again; after
that its alarms would be seen by no operator.
"""

from recon.model.failsafe_matrix import Activity, FailsafeCondition, Reaction
from recon.safety.failsafe.row import ALARM, ORDERS, FailsafeRow, FlightFacts, cells, hold

RULE = "operator_gone"


def find(facts: FlightFacts) -> int | None:
    """Return since when the last client is gone."""
    return facts.station.operator_gone_since_ns


ROW = FailsafeRow(
    condition=FailsafeCondition.OPERATOR_GONE,
    begins="no console or program connected for 10 s, after one was for 30 s",
    ends="an operator connects",
    reactions=ORDERS | {Reaction.NOTHING, Reaction.ALARM},
    why_no_other="",
    default=cells(hold(60.0), hold(), ALARM, ALARM),
    after_s=60.0,
    alarm_rules=frozenset({RULE}),
    find=find,
    fixed={Activity.STEERED: "a steered vehicle is always held when its client goes"},
)
