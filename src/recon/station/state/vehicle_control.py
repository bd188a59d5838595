"""What the station commands one vehicle to do, and by whose authority: one value per vehicle.

Each field has one writer, the module named beside it; `tests/architecture` proves it. Everything
else reads `station.control(serial)`.
"""

from dataclasses import dataclass
from typing import TypedDict

from recon.model.authority import ControlAuthority
from recon.model.command import Command, VirtualStick
from recon.model.intent import Intent
from recon.safety import Override
from recon.station.state.setpoint_lease import SetpointLease
from recon.station.state.tracking import Tracking
from recon.station.state.vehicle_snapshot import VehicleSnapshot

NEVER_TAKEN = ControlAuthority()
NO_INTENT = Intent()


@dataclass(frozen=True, slots=True)
class PendingNeutral:
    """A single virtual stick in effect, and when its neutral setpoint is due."""

    command: Command
    body: VirtualStick
    due_at_ns: int


@dataclass(frozen=True)
class VehicleControl:
    """The control state of one vehicle. The default is that of a vehicle never commanded."""

    authority: ControlAuthority = NEVER_TAKEN
    """Who may set it in motion. Writer: `control/authority.py`."""
    intent: Intent = NO_INTENT
    """What it was last commanded to do. Writer: `control/intents.py`."""
    tracking: Tracking | None = None
    """How telemetry is compared with the intent; None before its first telemetry.
    Writer: `control/mode_tracking.py`."""
    lease: SetpointLease | None = None
    """The steered order being carried out; not restored after a restart.
    Writer: `steering/stream_ends.py`."""
    neutral: PendingNeutral | None = None
    """The neutral setpoint that ends a single stick. Writer: `steering/neutral_setpoint.py`."""
    preflight_override: Override | None = None
    """Until the vehicle has landed. Writer: `control/preflight.py`."""
    restored: VehicleSnapshot | None = None
    """From the last run, when it was flying then; until its first telemetry in this run.
    Writer: `recovery/restart.py`."""

    @property
    def is_taken(self) -> bool:
        """Whether anybody has taken or been given authority since the station started."""
        return self.authority != NEVER_TAKEN


class ControlChanges(TypedDict, total=False):
    """The fields of `VehicleControl` that a writer changes."""

    authority: ControlAuthority
    intent: Intent
    tracking: Tracking | None
    lease: SetpointLease | None
    neutral: PendingNeutral | None
    preflight_override: Override | None
    restored: VehicleSnapshot | None


NO_CONTROL = VehicleControl()
