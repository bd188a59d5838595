"""A command needs a known vehicle and an open link."""

from recon.model.command import Command, Refusal
from recon.safety.situation import Situation


def reachable(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a command without a known vehicle or without an open link to it."""
    target = command.serial if command.serial is not None else f"link {command.link_id}"
    if situation.waiting_link_ids and not situation.claiming_links:
        return Refusal("reachable", _waits(target, situation))
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


def _waits(target: str, situation: Situation) -> str:
    links = ", ".join(str(link_id) for link_id in situation.waiting_link_ids)
    waits = f"its app waits to be admitted (link {links}); admit it first. Until then only"
    if situation.vehicle is None:
        return f"{target}: {waits} an all stop reaches it"
    return f"{situation.vehicle.display_name}: {waits} hold, land and return are sent to it"
