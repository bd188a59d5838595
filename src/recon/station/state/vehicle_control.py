"""What the station commands one vehicle to do, and by whose authority: one value per vehicle.

Each field has one writer, the module named beside it; `tests/architecture` proves it. Everything
else reads `station.control(serial)`.
"""

from dataclasses import dataclass
from typing import Annotated, TypedDict

import msgspec

from recon.fleet.flight_table import Verdict
from recon.model.command import Command, VirtualStick
from recon.model.control import ControlAuthority, Intent, OperatorLease
from recon.model.units import Stamped
from recon.model.vehicle import FlightMode
from recon.safety import Override
from recon.station.state.setpoint_stream import SetpointStream

LARGEST_M = 20_000.0
LARGEST_MPS = 150.0

Latitude = Annotated[float, msgspec.Meta(ge=-90.0, le=90.0)]
Longitude = Annotated[float, msgspec.Meta(ge=-180.0, le=180.0)]
Metres = Annotated[float, msgspec.Meta(ge=-LARGEST_M, le=LARGEST_M)]
Speed = Annotated[float, msgspec.Meta(ge=-LARGEST_MPS, le=LARGEST_MPS)]
Fraction = Annotated[float, msgspec.Meta(ge=0.0, le=1.0)]


class PositionSnapshot(msgspec.Struct, frozen=True):
    """A position (WGS84)."""

    latitude_deg: Latitude
    longitude_deg: Longitude


class VehicleSnapshot(msgspec.Struct, frozen=True, kw_only=True):
    """A vehicle's last telemetry. Heights are above its takeoff point; None is unknown.

    `altitude_offset_m` is altitude minus height above takeoff. It stays constant during a flight,
    so a different offset means a different flight.
    """

    received_at_ns: int
    is_flying: bool | None
    is_simulated: bool
    position: PositionSnapshot | None
    height_above_takeoff_m: Metres | None
    velocity_north_mps: Speed | None
    velocity_east_mps: Speed | None
    velocity_down_mps: Speed | None
    battery_fraction: Fraction | None
    altitude_offset_m: Metres | None
    takeoff_point: PositionSnapshot | None
    altitude_offset_at_takeoff_m: Metres | None


NEVER_TAKEN = ControlAuthority()
NO_INTENT = Intent()


@dataclass(frozen=True, slots=True)
class PendingNeutral:
    """A single virtual stick, and when its neutral setpoint or the hold after that is due."""

    command: Command
    body: VirtualStick
    due_at_ns: int
    is_hold: bool = False


@dataclass(frozen=True)
class Tracking:
    """How far telemetry has confirmed the intent, for the flight table.

    Only modes received after `since_ns`, the intent's time, count. `mode_before` is the mode that
    is not new. `doubt` is a verdict that counts once it has lasted since `doubt_since_ns`.
    `failsafe` describes the active failsafe, until the next command or the landing.
    """

    since_ns: int = 0
    command_id: int | None = None
    has_begun: bool = False
    mode_before: FlightMode | None = None
    link_id: int | None = None
    read: Stamped[FlightMode] = Stamped()
    """The last mode report evaluated; each is evaluated once."""
    doubt: Verdict | None = None
    doubt_since_ns: int = 0
    core_at_ns: int | None = None
    """Receive time of the telemetry that last counted the mission's passed waypoints."""
    failsafe: str | None = None
    is_unbidden: bool = False
    """First telemetry, or on the ground without a command: its motion is not the station's."""


@dataclass(frozen=True)
class VehicleControl:
    """The control state of one vehicle. The default is that of a vehicle never commanded."""

    authority: ControlAuthority = NEVER_TAKEN
    """Who may set it in motion. Writer: `control/authority.py`."""
    lease: OperatorLease | None = None
    """The person who operates it; None: free, and after a restart. Writer:
    `control/operator_lease.py`."""
    intent: Intent = NO_INTENT
    """What it was last commanded to do. Writer: `control/intents.py`."""
    tracking: Tracking | None = None
    """How telemetry is compared with the intent; None before its first telemetry.
    Writer: `control/mode_tracking.py`."""
    stream: SetpointStream | None = None
    """The steered order being carried out; not restored after a restart.
    Writer: `steering/stream_ends.py`."""
    neutral: PendingNeutral | None = None
    """The neutral setpoint that ends a single stick. Writer: `steering/neutral_setpoint.py`."""
    preflight_override: Override | None = None
    """Override until the vehicle has landed. Writer: `control/preflight.py`."""
    restored: VehicleSnapshot | None = None
    """Snapshot of a vehicle that flew in the last run, until its first telemetry in this run.
    Writer: `recovery/restart.py`."""

    @property
    def is_taken(self) -> bool:
        """Whether authority was ever taken or transferred since the station started."""
        return self.authority != NEVER_TAKEN


class ControlChanges(TypedDict, total=False):
    """The fields of `VehicleControl` that a writer changes."""

    authority: ControlAuthority
    lease: OperatorLease | None
    intent: Intent
    tracking: Tracking | None
    stream: SetpointStream | None
    neutral: PendingNeutral | None
    preflight_override: Override | None
    restored: VehicleSnapshot | None


NO_CONTROL = VehicleControl()
