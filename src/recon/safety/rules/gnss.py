"""What is set in motion must know where it is."""

from recon.model.command import Command, Refusal
from recon.safety.gnss_quality import gnss_fault
from recon.safety.situation import Situation
from recon.safety.standstill import is_stop

RULE = "gnss"


def gnss(command: Command, situation: Situation) -> Refusal | None:
    """Refuse motion without a fix of quality; what only stops it needs none."""
    vehicle = situation.vehicle
    if vehicle is None or not command.moves:
        return None
    if is_stop(command, situation):
        return None
    fault = gnss_fault(vehicle, situation.settings)
    return None if fault is None else Refusal(RULE, f"{vehicle.display_name}: {fault}")
