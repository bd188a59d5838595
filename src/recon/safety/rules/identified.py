"""Orders go to vehicles that are who they say; only emergency orders go further."""

from recon.model.command import Command, Refusal
from recon.safety.situation import Situation


def identified(command: Command, situation: Situation) -> Refusal | None:
    """Refuse anything but an emergency order without a serial, or while its owner is unsettled.

    An emergency order that may take off is one order for one known aircraft, and no exception.
    """
    vehicle = situation.vehicle
    if vehicle is None or (command.is_emergency and not command.takeoff):
        return None
    if vehicle.serial is None:
        return Refusal(
            "identified",
            f"link {command.link_id} has not said its serial: "
            "it takes emergency orders without takeoff only",
        )
    if vehicle.rival_link_ids:
        return Refusal(
            "identified",
            f"{vehicle.display_name}: links {_listed(situation)} claim this serial; "
            "only hold, land and return, none with takeoff, are sent until one of them closes or "
            "falls silent",
        )
    return None


def _listed(situation: Situation) -> str:
    return " and ".join(str(claiming_link.link_id) for claiming_link in situation.claiming_links)
