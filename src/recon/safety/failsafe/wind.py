"""Strong wind, by the aircraft's own warning level. Where it is calmer only a person knows."""

from recon.model.failsafe_matrix import FailsafeCondition, Reaction
from recon.model.vehicle import VehicleState
from recon.safety.failsafe.row import ALARM, NO_FIXED, ORDERS, FailsafeRow, FlightFacts, cells


def words(vehicle: VehicleState, limit: int) -> str | None:
    """Return what the aircraft reports of strong wind, None while it reports none."""
    level = vehicle.wind_level.value
    if level is None or level < limit:
        return None
    return (
        f"strong wind, reported by the aircraft (level {level}, limit {limit}), near what it "
        "can fly in: bring it lower and home, or land it"
    )


def find(facts: FlightFacts) -> int | None:
    """Return now while the aircraft reports strong wind."""
    if not facts.is_live or words(facts.vehicle, facts.limits.strong_wind_level) is None:
        return None
    return facts.now_ns


ROW = FailsafeRow(
    condition=FailsafeCondition.WIND,
    begins="the aircraft reports strong wind",
    ends="the wind drops",
    reactions=ORDERS | {Reaction.ALARM},
    why_no_other="the alarm of strong wind cannot be switched off",
    default=cells(ALARM, ALARM, ALARM, ALARM),
    after_s=30.0,
    alarm_rules=frozenset({"strong_wind"}),
    find=find,
    fixed=NO_FIXED,
)
