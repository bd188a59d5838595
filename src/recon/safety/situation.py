"""The one snapshot all rules look at."""

from dataclasses import dataclass

from recon.model.vehicle import VehicleState
from recon.safety.settings import SafetySettings


@dataclass(frozen=True, slots=True)
class Situation:
    """What is known when a command is judged.

    `vehicle` is the state of the command's vehicle, or of the unidentified link it names; None when
    there is neither. `link_ids` are the open links it would be sent to.
    """

    now_ns: int
    vehicle: VehicleState | None
    link_ids: tuple[int, ...]
    settings: SafetySettings = SafetySettings()
