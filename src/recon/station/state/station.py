"""The whole state of the station, as one frozen value."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Unpack

from recon.fleet.state import Fleet
from recon.model.control import StopLatch
from recon.model.imagery import Frame
from recon.model.replacing import replace
from recon.model.vehicle import VehicleState
from recon.safety import OPEN_AIRSPACE, PreparedAirspace
from recon.station.state import alarm_book
from recon.station.state.alarm_book import AlarmBook, Condition
from recon.station.state.failsafe_state import FailsafeState
from recon.station.state.fleet_return_record import FleetReturn
from recon.station.state.imager_motion import ImagerMotions
from recon.station.state.imager_relief import Reliefs
from recon.station.state.imaging import Imaging, ShadePipeline
from recon.station.state.light_sensors import LightSensors
from recon.station.state.orders import OrderBook
from recon.station.state.setpoint_stream import SetpointStream
from recon.station.state.settings import StationSettings
from recon.station.state.survey_record import Surveys
from recon.station.state.temporary_zones import TemporaryZones
from recon.station.state.vehicle_control import NO_CONTROL, ControlChanges, VehicleControl
from recon.station.state.watchdog_state import WatchdogState


@dataclass(frozen=True, slots=True)
class Clock:
    """The computer's clock when last read, and how far it was ahead of station time then and at
    the start."""

    wall_ns: int
    ahead_ns: int
    ahead_at_start_ns: int

    @property
    def set_by_ns(self) -> int:
        """Return by how much it was set since the start."""
        return self.ahead_ns - self.ahead_at_start_ns


@dataclass(frozen=True, slots=True)
class Presence:
    """The open streams of a person, and since when all are closed."""

    streams: int = 0
    left_at_ns: int | None = None


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault in the station's own code: where, the error, first and last time."""

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
    """Surveys of this run; not restored after a restart."""
    frames: Mapping[str, Frame] = field(default_factory=dict)
    """The newest frame of each vehicle, by serial."""
    next_frame_id: int = 1
    airspace: PreparedAirspace = field(default=OPEN_AIRSPACE, repr=False)
    """The site's, with the temporary zones in force."""
    temporary_zones: TemporaryZones = field(default_factory=TemporaryZones)
    """Writer: `control/temporary_zones.py`."""
    controls: Mapping[str, VehicleControl] = field(default_factory=dict)
    """Control state by serial; read with `control`, changed with `with_control` only."""
    streaming: tuple[str, ...] = ()
    """Serials of the vehicles with a setpoint stream, kept by `with_control`: read at every
    event, and few of many vehicles."""
    neutral_pending: tuple[str, ...] = ()
    """Serials of the vehicles with a pending neutral setpoint, kept likewise."""
    clock: Clock | None = None
    """The computer's clock; None until it was first read."""
    restored_at_ns: int | None = None
    """Time at which the last run's snapshot was restored; None without one."""
    audit_problem: str | None = None
    """Why the audit cannot be written, while it cannot."""
    record_problem: str | None = None
    """What of the flight is not recorded, and why, while that is so."""
    app_list_problem: str | None = None
    """Why the list of apps cannot be written, while it cannot."""
    link_limits: Mapping[str, str] = field(default_factory=dict)
    """Limits that the link server has reached, with what it does about it."""
    next_own_id: int = -1
    """The number of the next command the station gives automatically; see `take_id`."""
    owners: frozenset[str] = frozenset()
    """Open API streams that steered orders may depend on."""
    persons: Mapping[str, Presence] = field(default_factory=dict)
    """Persons with a stream of states, or who had one. Writer: `control/operator_lease.py`."""
    stop_latch: StopLatch | None = None
    """The all stop in force. Writer: `control/stop_latch.py`."""
    fleet_return: FleetReturn | None = None
    """The newest fleet return of this run."""
    imager_motions: ImagerMotions = field(default_factory=ImagerMotions)
    """Motions of this run. Writers: `operations/imager_motion` and `operations/imager_relief`."""
    reliefs: Reliefs = field(default_factory=Reliefs)
    """Reliefs of this run. Writer: `operations/imager_relief`."""
    watchdog_state: WatchdogState = field(default_factory=WatchdogState)
    """Findings, holds and switches of the watchdogs."""
    failsafe_state: FailsafeState = field(default_factory=FailsafeState)
    """Occurrences of the failsafe matrix's conditions. Writer: `failsafe/runner.py`."""
    light_sensors: LightSensors = field(default_factory=LightSensors)
    """Light sensors on the ground. Writer: `imaging/light_sensors.py`."""
    faults: Mapping[str, Fault] = field(default_factory=dict)
    """Recent faults in the station's own code, by where they arose."""

    def control(self, serial: str | None) -> VehicleControl:
        """Return the control state of a vehicle; the default for one never commanded."""
        return self.controls.get(serial or "", NO_CONTROL)

    def with_control(self, serial: str, **changes: Unpack[ControlChanges]) -> "Station":
        """Return the station with fields of one vehicle's control state changed.

        Only a field's writer changes it, see `VehicleControl`. Without a change nothing is copied.
        """
        before = self.control(serial)
        if all(getattr(before, name) is value for name, value in changes.items()):
            return self
        control = replace(before, **changes)
        return replace(
            self,
            controls={**self.controls, serial: control},
            streaming=_with_member(self.streaming, serial, control.stream is not None),
            neutral_pending=_with_member(self.neutral_pending, serial, control.neutral is not None),
        )

    def with_alarm(self, condition: Condition, now_ns: int) -> "Station":
        """Return the station with the alarm of an event; it stays until it is acknowledged."""
        book = alarm_book.note(self.alarms, condition, now_ns, self.settings.alarms_kept)
        return replace(self, alarms=book)

    def with_fleet(self, fleet: Fleet) -> "Station":
        """Return the station with another fleet; drop the control states of forgotten vehicles.

        A forgotten vehicle that returns is a new one: no old authority, intent or tracking.
        """
        gone = self.fleet.vehicles.keys() - fleet.vehicles.keys()
        if gone.isdisjoint(self.controls):
            return replace(self, fleet=fleet)
        return replace(
            self,
            fleet=fleet,
            controls={key: value for key, value in self.controls.items() if key not in gone},
            streaming=tuple(serial for serial in self.streaming if serial not in gone),
            neutral_pending=tuple(s for s in self.neutral_pending if s not in gone),
        )

    def is_stopped(self, serial: str | None) -> bool:
        """Return whether an all stop holds a vehicle, or a link without a serial."""
        return self.stop_latch is not None and self.stop_latch.holds(serial)

    def streams(self) -> Iterator[tuple[str, SetpointStream]]:
        """Yield the setpoint streams with their vehicles' serials, the oldest first."""
        for serial in self.streaming:
            stream = self.control(serial).stream
            assert stream is not None, "`streaming` names the vehicles with a stream"
            yield serial, stream

    def controls_changed_since(self, before: "Station") -> tuple[tuple[str, VehicleControl], ...]:
        """Return the control states, by serial, that are not the same values as in `before`."""
        if self.controls is before.controls:
            return ()
        known = before.controls
        return tuple(item for item in self.controls.items() if known.get(item[0]) is not item[1])

    def target(self, serial: str | None, link_id: int | None) -> VehicleState | None:
        """Return the state an order's target has now: a vehicle, or a link without identity.

        A link that has since reported its serial stands for its vehicle.
        """
        if serial is not None:
            return self.fleet.vehicles.get(serial)
        link = self.fleet.links.get(link_id if link_id is not None else -1)
        if link is None or not link.is_open:
            return None
        return self.fleet.vehicle_of_link(link.id)


def _with_member(serials: tuple[str, ...], serial: str, is_member: bool) -> tuple[str, ...]:
    if (serial in serials) is is_member:
        return serials
    return (*serials, serial) if is_member else tuple(s for s in serials if s != serial)


def take_id(station: Station) -> tuple[Station, int]:
    """Return the station without its next own command number, and that number.

    Numbers of the station's own commands go below zero, each used once; orders of operators and
    programs are numbered from 1 up.
    """
    return replace(station, next_own_id=station.next_own_id - 1), station.next_own_id
