"""Expired orders are refused, and orders to move that arrive long after they were given."""

from recon.model.command import Command, Refusal
from recon.model.units import ns_to_seconds
from recon.safety.settings import SafetySettings
from recon.safety.situation import Situation

RULE = "not_expired"


def not_expired(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a command from its expiry time on, and one to move that was given too long ago.

    A time of giving in the future is a wrong clock. Stops and camera orders are never late.
    """
    late_ns = situation.now_ns - command.expires_at_ns
    if late_ns >= 0:
        return Refusal(
            RULE,
            f"Order expired {ns_to_seconds(late_ns):.1f} s ago; give it again if still wanted",
            parameters={"late_s": ns_to_seconds(late_ns), "max_s": 0.0},
        )
    if not command.moves:
        return None
    return given_refusal(command.given_at_ns, situation.now_ns, situation.settings)


def given_refusal(given_at_ns: int | None, now_ns: int, limits: SafetySettings) -> Refusal | None:
    """Return why an order to move, given at that time by its person, comes too late, else None."""
    if given_at_ns is None:
        return None
    age_s = ns_to_seconds(now_ns - given_at_ns)
    parameters = {"age_s": age_s, "max_s": limits.given_at_most_s}
    if age_s > limits.given_at_most_s:
        return Refusal(
            RULE,
            f"Order given {age_s:.1f} s ago by its client's clock; motion must be given at most "
            f"{limits.given_at_most_s:g} s before it is sent; give it again if still wanted, and "
            "check that clock",
            parameters=parameters,
        )
    if age_s < -limits.clock_ahead_s:
        return Refusal(
            RULE,
            f"Order given {-age_s:.1f} s in the future: its client's clock is ahead of the "
            "station's; set it, or send the order without its time",
            parameters=parameters,
        )
    return None
