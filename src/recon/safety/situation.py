"""The one snapshot all rules look at."""

from dataclasses import dataclass

from recon.model.stamped import Stamped
from recon.model.vehicle import VehicleState
from recon.safety.settings import SafetySettings


@dataclass(frozen=True, slots=True)
class Claimant:
    """An open link that says it is the vehicle, and what it says about flying."""

    link_id: int
    is_flying: Stamped[bool]


@dataclass(frozen=True, slots=True)
class Situation:
    """What is known when a command is judged.

    `vehicle` is the state of the command's vehicle, or of the unidentified link it names; None when
    there is neither. `claimants` are its open links, its own first; more than one while its
    identity is unsettled.
    """

    now_ns: int
    vehicle: VehicleState | None
    claimants: tuple[Claimant, ...]
    settings: SafetySettings = SafetySettings()
