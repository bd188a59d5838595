"""An order that comes late is not an order any more."""

from recon.model.command import Command, Refusal
from recon.model.units import ns_to_seconds
from recon.safety.situation import Situation


def not_expired(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a command whose time is over."""
    late_ns = situation.now_ns - command.expires_at_ns
    if late_ns < 0:
        return None
    return Refusal(
        "not_expired",
        f"the order expired {ns_to_seconds(late_ns):.1f} s ago: give it again if it still holds",
    )
