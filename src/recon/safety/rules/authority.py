"""Who leads a vehicle sets it in motion; hold, land and return come from anybody."""

from recon.model.authority import Leader
from recon.model.command import Command, Refusal
from recon.safety.situation import Situation

RULE = "leader"

_WHAT_TO_DO = {
    Leader.PILOT: "the pilot has the sticks and is not fought: ask the pilot, then take it over",
    Leader.OPERATOR: "a person at the station leads it: guidance flies it once it is given to it",
    Leader.GUIDANCE: "the station's own planning flies it: hold it, or take it over, first",
}


def leader(command: Command, situation: Situation) -> Refusal | None:
    """Refuse an order to move from anybody but the vehicle's leader.

    The station's own zero at the end of a stick is asked as the stick was, so it passes with it.
    """
    lead, vehicle = situation.lead, situation.vehicle
    if vehicle is None or not command.moves:
        return None
    if command.asked_as is lead.leader:
        return None
    return Refusal(
        RULE,
        f"{vehicle.display_name} is led by {lead.leader.value} ({lead.reason}), and the order "
        f"comes as the {command.asked_as.value}'s; {_WHAT_TO_DO[lead.leader]}",
    )
