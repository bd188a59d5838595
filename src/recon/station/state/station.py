"""Everything the station knows, as one frozen value."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from recon.fleet.state import Fleet
from recon.model.authority import ControlAuthority
from recon.model.command import Command, VirtualStick
from recon.model.imagery import Frame
from recon.model.intent import Intent
from recon.model.vehicle import VehicleState
from recon.safety import OPEN_AIRSPACE, Override, PreparedAirspace
from recon.station.state.alarm_book import AlarmBook
from recon.station.state.fleet_return_record import FleetReturn
from recon.station.state.imaging import Imaging, ShadePipeline
from recon.station.state.orders import OrderBook
from recon.station.state.setpoint_lease import SetpointLease
from recon.station.state.settings import StationSettings
from recon.station.state.survey_record import Surveys
from recon.station.state.tracking import Tracking
from recon.station.state.vehicle_snapshot import VehicleSnapshot
from recon.station.state.watchdog_state import WatchdogState


@dataclass(frozen=True, slots=True)
class PendingNeutral:
    """A stick that is being held, and when its time is over."""

    command: Command
    body: VirtualStick
    due_at_ns: int


@dataclass(frozen=True, slots=True)
class Clock:
    """The computer's clock as it was last read: what it said, and how far ahead of the station's
    own time it was then, and when the station began."""

    wall_ns: int
    ahead_ns: int
    ahead_at_start_ns: int

    @property
    def set_by_ns(self) -> int:
        """By how much it was set since the start."""
        return self.ahead_ns - self.ahead_at_start_ns


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault in the station's own code: doing what, what came of it, since when, and the last."""

    where: str
    what: str
    since_ns: int
    at_ns: int


@dataclass(frozen=True)
class Station:
    """The state that `step` turns into the next one."""

    settings: StationSettings = field(default_factory=StationSettings)
    fleet: Fleet = field(default_factory=Fleet)
    orders: OrderBook = field(default_factory=OrderBook)
    alarms: AlarmBook = field(default_factory=AlarmBook)
    imaging: Imaging = field(default_factory=Imaging)
    shade: ShadePipeline = field(default_factory=ShadePipeline)
    surveys: Surveys = field(default_factory=Surveys)
    """Of this run; never brought back after a restart."""
    frames: Mapping[str, Frame] = field(default_factory=dict)
    """The newest frame of each vehicle, by serial."""
    next_frame_id: int = 1
    airspace: PreparedAirspace = field(default=OPEN_AIRSPACE, repr=False)
    authorities: Mapping[str, ControlAuthority] = field(default_factory=dict)
    """Who leads each vehicle, by serial; the default for one that nobody has taken."""
    intents: Mapping[str, Intent] = field(default_factory=dict)
    """What each vehicle does on the station's word, by serial."""
    trackings: Mapping[str, Tracking] = field(default_factory=dict)
    """How telemetry follows each vehicle's intent, by serial."""
    preflight_overrides: Mapping[str, Override] = field(default_factory=dict)
    """By serial, until the vehicle has landed."""
    clock: Clock | None = None
    """The computer's clock; None until it was first read."""
    restored_flights: Mapping[str, VehicleSnapshot] = field(default_factory=dict)
    """Vehicles that flew when the last run saw them last, by serial, until each is heard."""
    restored_at_ns: int | None = None
    """When this run took up what the last one knew; None when there was nothing."""
    audit_problem: str | None = None
    """Why the audit cannot be written, while it cannot."""
    next_own_id: int = -1
    """The number of the next command the station gives by itself; see `own_ids`."""
    streams: Mapping[str, SetpointLease] = field(default_factory=dict)
    """Steered orders being carried out, by serial; never brought back after a restart."""
    owners: frozenset[str] = frozenset()
    """Open connections that may hold a steered order."""
    fleet_return: FleetReturn | None = None
    """The newest fleet return, until the station is started anew or another one begins."""
    sticks: Mapping[str, PendingNeutral] = field(default_factory=dict)
    """Sticks being held, by serial: each ends with a zero from the station."""
    watchdog_state: WatchdogState = field(default_factory=WatchdogState)
    """What the watchdogs found, held and were told."""
    faults: Mapping[str, Fault] = field(default_factory=dict)
    """Of the station's own code, lately, by what it was doing."""

    def target(self, serial: str | None, link_id: int | None) -> VehicleState | None:
        """Return the state an order's target has now: a vehicle, or a link without identity.

        A link that has since said its serial stands for its vehicle.
        """
        if serial is not None:
            return self.fleet.vehicles.get(serial)
        link = self.fleet.links.get(link_id if link_id is not None else -1)
        if link is None or not link.is_open:
            return None
        return self.fleet.vehicle_of_link(link.id)
