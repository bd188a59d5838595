"""Expired orders are refused."""

from recon.model.command import Command, Refusal
from recon.model.units import ns_to_seconds
from recon.safety.situation import Situation


def not_expired(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a command from its expiry time on."""
    late_ns = situation.now_ns - command.expires_at_ns
    if late_ns < 0:
        return None
    return Refusal(
        "not_expired",
        f"Order expired {ns_to_seconds(late_ns):.1f} s ago; give it again if still wanted",
        parameters={"late_s": ns_to_seconds(late_ns), "max_s": 0.0},
    )
