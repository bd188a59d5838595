"""GNSS lost: telemetry without a position, or signal level 0.

Neither a hold nor a return can be flown without GNSS: the aircraft drifts with the wind, and its
pilot must steer it.
"""

from recon.model.failsafe_matrix import FailsafeCondition, Reaction
from recon.model.vehicle import VehicleState
from recon.safety.failsafe.row import ALARM, NO_FIXED, FailsafeRow, FlightFacts, cells


def is_lost(vehicle: VehicleState) -> bool:
    """Return whether a vehicle that has reported its reception has none."""
    if vehicle.extended_received_at_ns is None:
        return False
    return vehicle.position.value is None or vehicle.gnss_signal_level.value == 0


def find(facts: FlightFacts) -> int | None:
    """Return now while telemetry shows no GNSS."""
    return facts.now_ns if facts.is_live and is_lost(facts.vehicle) else None


ROW = FailsafeRow(
    condition=FailsafeCondition.GNSS_LOST,
    begins="no position, or signal level 0",
    ends="GNSS returns",
    reactions=frozenset({Reaction.ALARM, Reaction.LAND}),
    why_no_other="without GNSS it can neither hold its position nor fly home",
    default=cells(ALARM, ALARM, ALARM, ALARM),
    after_s=10.0,
    alarm_rules=frozenset({"gnss"}),
    find=find,
    fixed=NO_FIXED,
)
