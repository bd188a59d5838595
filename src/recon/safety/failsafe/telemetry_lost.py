"""Telemetry lost or frozen: the link is open, and nothing new came for a second.

Frozen values count as none (`fleet/trust.py`). After 3 s the station treats a vehicle as lost, and
others keep clear of a growing area: a hold keeps that area small. It goes out blind while no
landing is possible, else when telemetry is back. A stream of sticks stops on its own, as early.
"""

from recon.model.failsafe_matrix import Activity, FailsafeCondition, Reaction
from recon.model.units import NS_PER_S
from recon.model.vehicle import LATE_UNDER_S, LIVE_UNDER_S
from recon.safety.failsafe.row import ALARM, FailsafeRow, FlightFacts, cells, hold


def find(facts: FlightFacts) -> int | None:
    """Return the time of the last telemetry when that is a second ago, on an open link."""
    at_ns, opened_at_ns = facts.vehicle.core_received_at_ns, facts.link_opened_at_ns
    if at_ns is None or opened_at_ns is None or at_ns < opened_at_ns:
        return None
    return at_ns if facts.now_ns - at_ns >= LIVE_UNDER_S * NS_PER_S else None


ROW = FailsafeRow(
    condition=FailsafeCondition.TELEMETRY_LOST,
    begins="no new telemetry for 1 s on an open link",
    ends="telemetry returns",
    reactions=frozenset({Reaction.ALARM, Reaction.HOLD}),
    why_no_other="without telemetry it is unknown where it would land, and that it flies at all",
    default=cells(hold(LATE_UNDER_S), hold(LATE_UNDER_S), ALARM, ALARM),
    after_s=LATE_UNDER_S,
    alarm_rules=frozenset({"link_late", "link_lost"}),
    find=find,
    fixed={Activity.STEERED: "a stream of sticks without telemetry always ends with a hold"},
)
