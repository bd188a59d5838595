"""An aircraft on the ground takes off only if the order includes takeoff.

Apps in the field answer hover, return and missions on the ground with a takeoff. A hover goes out
without fresh telemetry as long as the vehicle cannot have landed since the last report.
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
from recon.safety.landing_time import cannot_have_landed
from recon.safety.situation import ClaimingLink, Situation

RULE = "flying"
_NEEDS_FLIGHT = (Hover, ReturnHome, FlyMission, VirtualStick, *STEERED_BODIES)


def flying(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a moving order unless fresh telemetry shows flight, or the order includes takeoff.

    A hover passes on older telemetry too, while a landing since then is physically impossible.
    Takeoff is accepted with hover, mission and stick only, and for a vehicle whose app reports
    whether it flies.
    """
    vehicle = situation.vehicle
    if command.takeoff:
        return _no_takeoff(command, vehicle)
    if vehicle is None or not isinstance(command.body, _NEEDS_FLIGHT):
        return None
    if any(_shows_flight(claiming_link, situation) for claiming_link in situation.claiming_links):
        return None
    if isinstance(command.body, Hover) and cannot_have_landed(situation):
        return None
    return _not_flying(vehicle, situation)


def _no_takeoff(command: Command, vehicle: VehicleState | None) -> Refusal | None:
    if isinstance(command.body, TAKEOFF_BODIES):
        if vehicle is None or vehicle.is_flying.value is not None:
            return None
        reason = f"{_uncertain(vehicle)}, so takeoff is uncertain"
        return Refusal(RULE, f"{vehicle.display_name}: {reason}; check the app")
    can = ", ".join(BODY_NAMES[body] for body in TAKEOFF_BODIES)
    return Refusal(
        RULE,
        f"Takeoff is accepted with {can} only; got {command.name}. Give the order again without "
        "takeoff",
    )


def _shows_flight(claiming_link: ClaimingLink, situation: Situation) -> bool:
    age_s = claiming_link.is_flying.age_s(situation.now_ns)
    is_fresh = age_s is not None and age_s <= situation.settings.fresh_telemetry_s
    return is_fresh and claiming_link.is_flying.value is True


def _not_flying(vehicle: VehicleState, situation: Situation) -> Refusal:
    """Why flight is not certain; stale when it was last known to fly."""
    name, limit_s = vehicle.display_name, situation.settings.fresh_telemetry_s
    age_s = vehicle.is_flying.age_s(situation.now_ns)
    if age_s is None:
        return Refusal(RULE, f"{name}: no telemetry shows flight; the order could start a takeoff")
    if age_s > limit_s:
        return Refusal(
            RULE,
            f"{name}: telemetry must be at most {limit_s:g} s old; got {age_s:.1f} s; if it has "
            "landed, the order would start a takeoff. Land is always sent",
            is_stale=vehicle.is_flying.value is True,
            parameters={"age_s": age_s, "max_s": limit_s},
        )
    if vehicle.is_flying.value is None:
        return Refusal(RULE, f"{name}: {_uncertain(vehicle)}; the order could start a takeoff")
    return Refusal(RULE, f"{name}: on the ground; takeoff was not allowed")


def _uncertain(vehicle: VehicleState) -> str:
    if vehicle.reported_is_flying.value is None:
        return "its app does not report whether it flies"
    return "it reports on the ground, and no landing was seen"
