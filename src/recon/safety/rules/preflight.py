"""A mission is flown by a vehicle whose checklist is passed, or overridden in so many words."""

from recon.model.command import Command, FlyMission, Refusal
from recon.safety.homewards import leads_home
from recon.safety.preflight import checklist
from recon.safety.situation import Situation

RULE = "preflight"


def preflight(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a mission while a point of the checklist fails or is unknown.

    A mission that only brings a vehicle down ends a flight, and is not held back.
    """
    vehicle, body = situation.vehicle, command.body
    if vehicle is None or not isinstance(body, FlyMission):
        return None
    if situation.preflight_override is not None:
        return None
    if leads_home(body.mission, vehicle, situation.airspace):
        return None
    unmet = [check for check in checklist(vehicle, situation) if check.holds_back]
    if not unmet:
        return None
    points = "; ".join(f"{check.name}: {check.text} ({check.to_do})" for check in unmet)
    return Refusal(
        RULE,
        f"{vehicle.display_name}: its preflight checklist is not passed: {points}. Mend that, or "
        "override the checklist with a reason",
    )
