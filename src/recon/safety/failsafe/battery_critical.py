"""Battery critical: the aircraft's serious warning, 10 % left, or too little for the route home.

It is recalled at once. A returning vehicle is not landed in place by default: that place may
be water, a road or a person, and only the site knows.
"""

from recon.model.failsafe_matrix import FailsafeCondition, Reaction
from recon.model.severity import Severity
from recon.model.vehicle import BatteryWarning, VehicleState
from recon.safety.failsafe.row import ALARM, NO_FIXED, FailsafeRow, FlightFacts, cells, recall
from recon.safety.watchdogs.battery_home import RULE as BATTERY_HOME


def left_in_flight(vehicle: VehicleState) -> float:
    """Return the battery fraction left; 1 on the ground, and while it is unknown."""
    level = vehicle.battery_fraction.value
    return 1.0 if level is None or vehicle.is_flying.value is False else level


def words(vehicle: VehicleState, limit_fraction: float) -> str | None:
    """Return what shows a critically low battery, None while nothing does."""
    if vehicle.battery_warning.value is BatteryWarning.SERIOUS:
        return "battery critically low, reported by the aircraft: land now"
    left = left_in_flight(vehicle)
    if left <= limit_fraction:
        return f"battery at {left:.0%}, limit {limit_fraction:.0%}: land now"
    return None


def find(facts: FlightFacts) -> int | None:
    """Return since when the battery is critical."""
    if not facts.is_live:
        return None
    if words(facts.vehicle, facts.limits.serious_battery_fraction) is not None:
        return facts.now_ns
    finding = facts.findings.get(BATTERY_HOME)
    if finding is None or finding.severity is not Severity.CRITICAL:
        return None
    return finding.since_ns


ROW = FailsafeRow(
    condition=FailsafeCondition.BATTERY_CRITICAL,
    begins="the aircraft warns seriously, 10 % are left, or home may not be reached",
    ends="an operator orders otherwise",
    reactions=frozenset({Reaction.ALARM, Reaction.RETURN, Reaction.LAND}),
    why_no_other="a hold saves no battery, and the alarm cannot be switched off",
    default=cells(recall(), recall(), recall(), ALARM),
    after_s=0.0,
    alarm_rules=frozenset({"battery", BATTERY_HOME}),
    find=find,
    fixed=NO_FIXED,
    lasts_to_landing=True,
)
