"""Default deny: an order type that no rule knows is refused."""

from recon.model.command import BODY_NAMES, Command, Refusal
from recon.safety.situation import Situation


def known_order(command: Command, situation: Situation) -> Refusal | None:
    """Refuse an order type without a name in `BODY_NAMES`."""
    if type(command.body) in BODY_NAMES:
        return None
    kind = type(command.body).__name__
    known = ", ".join(BODY_NAMES.values())
    return Refusal("known_order", f"Order type {kind} is unknown; known types: {known}")
