"""Orders need a vehicle with an undisputed serial, except emergency orders."""

from recon.model.command import Command, Refusal
from recon.safety.situation import Situation


def identified(command: Command, situation: Situation) -> Refusal | None:
    """Refuse all but emergency orders without a serial, or while two links claim it.

    An emergency order that may take off is one order for one known aircraft, and no exception.
    """
    vehicle = situation.vehicle
    if vehicle is None or (command.is_emergency and not command.takeoff):
        return None
    if vehicle.serial is None:
        return Refusal(
            "identified",
            f"Link {command.link_id} has not reported its serial: "
            "only emergency orders without takeoff are accepted",
        )
    if vehicle.rival_link_ids:
        return Refusal(
            "identified",
            f"{vehicle.display_name}: links {_listed(situation)} claim this serial; "
            "only hold, land and return without takeoff are sent until one of them closes or "
            "becomes silent",
        )
    return None


def _listed(situation: Situation) -> str:
    return " and ".join(str(claiming_link.link_id) for claiming_link in situation.claiming_links)
