"""Nothing makes an aircraft on the ground take off unless the order says so.

Apps in the field answer hover, return and missions on the ground with a takeoff.
"""

from recon.model.command import (
    BODY_NAMES,
    STEERED_BODIES,
    TAKEOFF_BODIES,
    Command,
    FlyMission,
    Hover,
    Refusal,
    ReturnHome,
    VirtualStick,
)
from recon.model.vehicle import VehicleState
from recon.safety.situation import ClaimingLink, Situation

RULE = "flying"
_NEEDS_FLIGHT = (Hover, ReturnHome, FlyMission, VirtualStick, *STEERED_BODIES)


def flying(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a moving order unless fresh telemetry says flying, or the order says takeoff.

    Takeoff is a word for hover, mission and stick alone, and for a vehicle whose app says whether
    it flies: else it is refused.
    """
    vehicle = situation.vehicle
    if command.takeoff:
        return _no_takeoff(command, vehicle)
    if vehicle is None or not isinstance(command.body, _NEEDS_FLIGHT):
        return None
    if any(_says_flying(claiming_link, situation) for claiming_link in situation.claiming_links):
        return None
    reason = f"{vehicle.display_name}: {_why(vehicle, situation)}"
    return Refusal(RULE, reason, is_stale=_is_telemetry_lost(vehicle, situation))


def _no_takeoff(command: Command, vehicle: VehicleState | None) -> Refusal | None:
    if isinstance(command.body, TAKEOFF_BODIES):
        if vehicle is None or vehicle.is_flying.value is not None:
            return None
        reason = "its app does not say whether it flies, so not whether it would take off"
        return Refusal(RULE, f"{vehicle.display_name}: {reason}: look at the app")
    can = ", ".join(BODY_NAMES[body] for body in TAKEOFF_BODIES)
    return Refusal(
        RULE,
        f"takeoff was said with {command.name}, which never takes off; it goes with {can} only. "
        "Give the order again without it",
    )


def _says_flying(claiming_link: ClaimingLink, situation: Situation) -> bool:
    age_s = claiming_link.is_flying.age_s(situation.now_ns)
    is_fresh = age_s is not None and age_s <= situation.settings.fresh_telemetry_s
    return is_fresh and claiming_link.is_flying.value is True


def _is_telemetry_lost(vehicle: VehicleState, situation: Situation) -> bool:
    """Whether the vehicle was last known to fly and its telemetry is too old to say so now."""
    age_s = vehicle.is_flying.age_s(situation.now_ns)
    is_old = age_s is not None and age_s > situation.settings.fresh_telemetry_s
    return is_old and vehicle.is_flying.value is True


def _why(vehicle: VehicleState, situation: Situation) -> str:
    age_s = vehicle.is_flying.age_s(situation.now_ns)
    if age_s is None:
        return "no telemetry says that it flies, and the order could start a takeoff"
    if age_s > situation.settings.fresh_telemetry_s:
        return (
            f"telemetry is {age_s:.1f} s old; if it has landed, the order would start a takeoff. "
            "Land is always sent"
        )
    if vehicle.is_flying.value is None:
        return "its app does not say whether it flies, and the order could start a takeoff"
    return "it is on the ground, and the order does not say takeoff"
