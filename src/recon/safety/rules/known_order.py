"""Deny by default: what no rule knows, no rule has judged."""

from recon.model.command import BODY_NAMES, Command, Refusal
from recon.safety.situation import Situation


def known_order(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a body that is none of the station's orders."""
    if type(command.body) in BODY_NAMES:
        return None
    kind = type(command.body).__name__
    known = ", ".join(BODY_NAMES.values())
    return Refusal("known_order", f"{kind} is no order the gate can judge; known are {known}")
