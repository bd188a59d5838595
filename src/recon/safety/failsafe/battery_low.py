"""Battery low: the aircraft's warning, 25 % left, or less left at home than the site's reserve.

Fifteen seconds leave an operator the time to bring it home in a better way (a fleet return).
"""

from recon.model.failsafe_matrix import FailsafeCondition, Reaction
from recon.model.severity import Severity
from recon.model.vehicle import BatteryWarning, VehicleState
from recon.safety.failsafe import battery_critical
from recon.safety.failsafe.row import ALARM, NO_FIXED, FailsafeRow, FlightFacts, cells, recall
from recon.safety.watchdogs.battery_home import RULE as BATTERY_HOME

AFTER_S = 15.0


def words(vehicle: VehicleState, limit_fraction: float) -> str | None:
    """Return what shows a low battery, None while nothing does."""
    if vehicle.battery_warning.value is BatteryWarning.LOW:
        return "battery low, reported by the aircraft: return home"
    left = battery_critical.left_in_flight(vehicle)
    if left <= limit_fraction:
        return f"battery at {left:.0%}, limit {limit_fraction:.0%}: return home"
    return None


def find(facts: FlightFacts) -> int | None:
    """Return since when the battery is low, and not critical."""
    if not facts.is_live or battery_critical.find(facts) is not None:
        return None
    if words(facts.vehicle, facts.limits.low_battery_fraction) is not None:
        return facts.now_ns
    finding = facts.findings.get(BATTERY_HOME)
    if finding is None or finding.severity is not Severity.WARNING:
        return None
    return finding.since_ns


ROW = FailsafeRow(
    condition=FailsafeCondition.BATTERY_LOW,
    begins="the aircraft warns, 25 % are left, or home is reached with less than the reserve",
    ends="an operator orders otherwise",
    reactions=frozenset({Reaction.ALARM, Reaction.RETURN, Reaction.LAND}),
    why_no_other="a hold saves no battery, and the alarm cannot be switched off",
    default=cells(recall(AFTER_S), recall(AFTER_S), recall(AFTER_S), ALARM),
    after_s=AFTER_S,
    alarm_rules=frozenset({"battery", BATTERY_HOME}),
    find=find,
    fixed=NO_FIXED,
    lasts_to_landing=True,
)
