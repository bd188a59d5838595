"""No order sets a vehicle in motion after an all stop until a person releases it."""

from recon.model.command import Command, Refusal
from recon.model.units import ns_to_seconds
from recon.safety.situation import Situation

RULE = "stop_latch"


def stop_latch(command: Command, situation: Situation) -> Refusal | None:
    """Refuse what moves a vehicle, takeoff included, while an all stop holds it.

    It does not matter who orders it. Hold, land and return home stay allowed.
    """
    latch, vehicle = situation.stop_latch, situation.vehicle
    if latch is None or not command.moves or not latch.holds(command.serial):
        return None
    name = "this link" if vehicle is None else vehicle.display_name
    age_s = ns_to_seconds(situation.now_ns - latch.at_ns)
    return Refusal(
        RULE,
        f"{name}: stopped by the all stop of {latch.by} {age_s:.0f} s ago; release its stop first. "
        "Hold, land and return home are always accepted",
        parameters={"age_s": age_s, "by": latch.by},
    )
