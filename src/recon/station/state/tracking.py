"""How telemetry follows what a vehicle was told last."""

from dataclasses import dataclass

from recon.fleet.flight_table import Verdict
from recon.model.stamped import Stamped
from recon.model.vehicle import FlightMode


@dataclass(frozen=True)
class Tracking:
    """What the flight table is asked with, beside the intent itself.

    `told_at_ns` is the intent's time: only modes received later count. `mode_before` is the flight
    mode that is no news. `doubt` is a verdict that counts once it has lasted, since the mode
    report of `doubt_since_ns`. `failsafe` says what the aircraft does by itself, until it is told
    something or has landed.
    """

    told_at_ns: int = 0
    command_id: int | None = None
    has_begun: bool = False
    mode_before: FlightMode | None = None
    link_id: int | None = None
    read: Stamped[FlightMode] = Stamped()
    """The mode report that was read last; each is read once, with a place as new."""
    doubt: Verdict | None = None
    doubt_since_ns: int = 0
    core_at_ns: int | None = None
    """When the telemetry came that the mission's passed waypoints were last counted by."""
    failsafe: str | None = None
    is_unbidden: bool = False
    """New here, or on the ground and told nothing: if it moves, nobody at the station made it."""
