"""Attitude: a tilt beyond 45 degrees. No order helps an aircraft out of control; its pilot may."""

from recon.model.failsafe_matrix import FailsafeCondition, Reaction
from recon.model.vehicle import VehicleState
from recon.safety.failsafe.row import ALARM, NO_FIXED, FailsafeRow, FlightFacts, cells


def words(vehicle: VehicleState, max_tilt_deg: float) -> str | None:
    """Return how far it is tilted if that is beyond the limit, else None."""
    attitude = vehicle.attitude.value
    if attitude is None:
        return None
    tilt_deg = max(abs(attitude.pitch_deg), abs(attitude.roll_deg))
    if tilt_deg <= max_tilt_deg:
        return None
    return (
        f"tilted by {tilt_deg:.0f} deg, limit {max_tilt_deg:g} deg: its pilot must take "
        "over; keep clear below"
    )


def find(facts: FlightFacts) -> int | None:
    """Return now while it is tilted too far."""
    if not facts.is_live or words(facts.vehicle, facts.limits.max_tilt_deg) is None:
        return None
    return facts.now_ns


ROW = FailsafeRow(
    condition=FailsafeCondition.ATTITUDE,
    begins="tilted by more than 45 degrees",
    ends="it is level again",
    reactions=frozenset({Reaction.ALARM, Reaction.HOLD, Reaction.LAND}),
    why_no_other="an aircraft that tilts so far flies no route home, and the alarm cannot be "
    "switched off",
    default=cells(ALARM, ALARM, ALARM, ALARM),
    after_s=2.0,
    alarm_rules=frozenset({"attitude"}),
    find=find,
    fixed=NO_FIXED,
)
