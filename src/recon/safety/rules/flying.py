"""Nothing makes an aircraft on the ground take off unless the order says so.

Apps in the field answer hover, return and missions on the ground with a takeoff.
"""

from recon.model.command import Command, FlyMission, Hover, Refusal, ReturnHome, VirtualStick
from recon.model.vehicle import VehicleState
from recon.safety.situation import Situation

RULE = "flying"
_NEEDS_FLIGHT = (Hover, ReturnHome, FlyMission, VirtualStick)
_MAY_TAKE_OFF = (Hover, FlyMission, VirtualStick)


def flying(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a moving order unless fresh telemetry says flying, or the order says takeoff."""
    vehicle = situation.vehicle
    if vehicle is None or not isinstance(command.body, _NEEDS_FLIGHT):
        return None
    if command.takeoff and isinstance(command.body, _MAY_TAKE_OFF):
        return None
    age_s = vehicle.is_flying.age_s(situation.now_ns)
    is_fresh = age_s is not None and age_s <= situation.settings.fresh_telemetry_s
    if is_fresh and vehicle.is_flying.value is True:
        return None
    return Refusal(RULE, f"{vehicle.display_name}: {_why(vehicle, age_s, is_fresh)}")


def _why(vehicle: VehicleState, age_s: float | None, is_fresh: bool) -> str:
    if age_s is None:
        return "no telemetry says that it flies, and the order could start a takeoff"
    if not is_fresh:
        return (
            f"telemetry is {age_s:.1f} s old; if it has landed, the order would start a takeoff. "
            "Land is always sent"
        )
    if vehicle.is_flying.value is None:
        return "its app does not say whether it flies, and the order could start a takeoff"
    return "it is on the ground, and the order does not say takeoff"
