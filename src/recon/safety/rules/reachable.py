"""A command needs a vehicle that is known and a link that is open."""

from recon.model.command import Command, Refusal
from recon.safety.situation import Situation


def reachable(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a command to nobody."""
    who = command.serial if command.serial is not None else f"link {command.link_id}"
    if situation.vehicle is None:
        return Refusal("reachable", f"{who} is not known: no app has said this serial")
    if not situation.claiming_links:
        name = situation.vehicle.display_name
        return Refusal(
            "reachable",
            f"{name} has no connection: its app must connect first",
            is_stale=situation.vehicle.is_flying.value is True,
        )
    return None
