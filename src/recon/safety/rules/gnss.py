"""What is set in motion must know where it is."""

from recon.model.command import MOVING_BODIES, Command, Refusal
from recon.safety.gnss_quality import gnss_fault
from recon.safety.situation import Situation
from recon.safety.standstill import is_zero_stick

RULE = "gnss"


def gnss(command: Command, situation: Situation) -> Refusal | None:
    """Refuse motion without a fix of quality; a stick without velocity only stops it."""
    vehicle = situation.vehicle
    if vehicle is None or not isinstance(command.body, MOVING_BODIES):
        return None
    if is_zero_stick(command.body):
        return None
    fault = gnss_fault(vehicle, situation.settings)
    return None if fault is None else Refusal(RULE, f"{vehicle.display_name}: {fault}")
