"""Link lost: a vehicle in flight has no connection, or a new one that brought no telemetry yet.

Nothing can be sent while it lasts. The reaction is ordered when telemetry is back, if the vehicle
still does what it did. A mission is allowed half a minute: its path was judged to its end, and apps
reconnect within seconds; after that others may have been moved, and no one saw what it passed. A
steered vehicle was stopped by its app's own timeout; it is held, so that nothing moves it again.
"""

from recon.model.failsafe_matrix import FailsafeCondition, Reaction
from recon.safety.failsafe.row import (
    ALARM,
    NO_FIXED,
    ORDERS,
    FailsafeRow,
    FlightFacts,
    cells,
    hold,
)


def find(facts: FlightFacts) -> int | None:
    """Return the time of the last telemetry while the link is lost."""
    at_ns, opened_at_ns = facts.vehicle.core_received_at_ns, facts.link_opened_at_ns
    if at_ns is None or (opened_at_ns is not None and at_ns >= opened_at_ns):
        return None
    return at_ns


ROW = FailsafeRow(
    condition=FailsafeCondition.LINK_LOST,
    begins="the app's connection is closed",
    ends="the link is back before",
    reactions=ORDERS | {Reaction.ALARM},
    why_no_other="the alarm of a vehicle lost in flight cannot be switched off",
    default=cells(hold(30.0), hold(), ALARM, ALARM),
    after_s=30.0,
    alarm_rules=frozenset({"link_lost"}),
    find=find,
    fixed=NO_FIXED,
    is_ordered_on_return=True,
)
