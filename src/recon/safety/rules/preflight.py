"""Missions and takeoffs need a passed preflight checklist, or an explicit override."""

from recon.model.command import Command, Refusal, mission_of_body
from recon.safety.checks import checklist
from recon.safety.return_missions import leads_home
from recon.safety.situation import Situation

RULE = "preflight"


def preflight(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a mission, or any takeoff, while a point of the checklist fails or is unknown.

    A mission that only brings a vehicle down is not held back: the checklist makes a flight safe
    to begin, and a refusal would only leave the vehicle in the air.
    """
    vehicle, mission = situation.vehicle, mission_of_body(command.body)
    if vehicle is None or (mission is None and not command.takeoff):
        return None
    if situation.preflight_override is not None:
        return None
    if mission is not None and leads_home(mission, vehicle, situation.airspace):
        return None
    unmet = [check for check in checklist(vehicle, situation) if check.holds_back]
    if not unmet:
        return None
    points = "; ".join(f"{check.name}: {check.text} ({check.to_do})" for check in unmet)
    return Refusal(
        RULE,
        f"{vehicle.display_name}: preflight checklist not passed: {points}. Resolve these points, "
        "or override the checklist with a reason",
    )
