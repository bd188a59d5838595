"""Nothing is flown faster than the site allows."""

from recon.model.command import Command, Refusal
from recon.safety.path.order_path import speeds_mps
from recon.safety.situation import Situation

RULE = "speed"


def speed(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a waypoint's, a goto's or a nudge's speed, or a stick's horizontal one, that is more
    than `max_speed_mps`, as the 32-bit floats of the wire have it."""
    limit_mps = situation.airspace.airspace.limits.max_speed_mps
    most_mps = limit_mps + situation.settings.fences.speed_rounding_mps
    for what, speed_mps in speeds_mps(command.body):
        if not speed_mps <= most_mps:
            return Refusal(
                RULE,
                f"{what} must be at most {limit_mps:g} m/s; got {speed_mps:.2f} m/s",
                parameters={"speed_mps": speed_mps, "max_mps": limit_mps},
            )
    return None
