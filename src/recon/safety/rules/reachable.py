"""A command needs a known vehicle and an open link."""

from recon.model.command import Command, Refusal
from recon.safety.situation import Situation


def reachable(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a command without a known vehicle or without an open link to it."""
    target = command.serial if command.serial is not None else f"link {command.link_id}"
    if situation.vehicle is None:
        return Refusal("reachable", f"{target} is unknown: no app has reported this serial")
    if not situation.claiming_links:
        name = situation.vehicle.display_name
        return Refusal(
            "reachable",
            f"{name} is not connected: its companion app must connect first",
            is_stale=situation.vehicle.is_flying.value is True,
        )
    return None
