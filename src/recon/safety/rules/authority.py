"""Only the holder of control authority sets a vehicle in motion; any client may stop it."""

from recon.model.command import Command, Refusal
from recon.model.control import AuthorityHolder
from recon.safety.situation import Situation

RULE = "authority"

_WHAT_TO_DO = {
    AuthorityHolder.PILOT: "ask the pilot, then take control",
    AuthorityHolder.OPERATOR: "give control to guidance first",
    AuthorityHolder.GUIDANCE: "hold the vehicle, or take control, first",
}


def authority(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a motion order not issued by the vehicle's authority holder.

    The station's own neutral setpoint carries the authority of the stick it ends, so it passes too.
    """
    held, vehicle = situation.authority, situation.vehicle
    if vehicle is None or not command.moves:
        return None
    if command.role is held.holder:
        return None
    return Refusal(
        RULE,
        f"{vehicle.display_name} is controlled by {held.holder.value} ({held.reason}), and the "
        f"order comes from {command.role.value}: {_WHAT_TO_DO[held.holder]}",
    )
