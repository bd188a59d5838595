"""Missions and takeoffs ask for a checklist that is passed, or overridden in so many words."""

from recon.model.command import Command, FlyMission, Refusal
from recon.safety.preflight import checklist
from recon.safety.return_missions import leads_home
from recon.safety.situation import Situation

RULE = "preflight"


def preflight(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a mission, or any takeoff, while a point of the checklist fails or is unknown.

    A mission that only brings a vehicle down ends a flight, and is not held back: what the list
    asks for makes a flight safe to begin, and a refusal would only leave the vehicle in the air.
    """
    vehicle, body = situation.vehicle, command.body
    if vehicle is None or not (isinstance(body, FlyMission) or command.takeoff):
        return None
    if situation.preflight_override is not None:
        return None
    if isinstance(body, FlyMission) and leads_home(body.mission, vehicle, situation.airspace):
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
