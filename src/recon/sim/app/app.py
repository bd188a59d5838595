"""One simulated companion app and its aircraft, without sockets or clock.

A driver (`recon.sim.run` on sockets, or a test in virtual time) opens links (`connected`), passes
in the bytes it reads (`receive`) and sends the packets that `advance` returns.

Theory of operation
-------------------
The app is a timetable. Each kind of work has the time at which it is due next: commands that were
acknowledged and wait for the SDK call, one-off faults, slow reads, core telemetry (10 Hz), extended
telemetry (2 Hz), frames to take, rendered frames to send. Every call first runs all that is due up
to `now_ns`, in order of time (ties: in the order of `_next_work`), and moves the aircraft to each
of these times. So the result does not depend on when the driver calls, only on what it passed in:
the same seed and commands give the same bytes.

A command is acknowledged at once and acts `ACTION_DELAY_NS` later, as with real apps: a positive
acknowledgment promises nothing. What DJI's SDK would reject is dropped silently after the positive
acknowledgment. A mission first stops what the aircraft flies; it is uploaded, and started some
seconds later, unless another command has come by then.

Faults act in three places: on what is sent (`FaultSchedule`: held back, damaged), on the aircraft
(`AircraftFaults`), and on the connection itself, which only the driver can close or open; those
come out as `LinkOrder`s.
"""

from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import Enum
from functools import partial
from operator import itemgetter
from random import Random

from recon import wire
from recon.camera import TelemetryReference
from recon.model.geo import GeoPoint
from recon.model.imagery import CameraPose
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.sim.app.camera_feed import CameraFeed, Shot
from recon.sim.app.commands import AppBehaviour, AppResponse, CommandHandler, MissionStart
from recon.sim.app.fault_effects import AircraftFaults, FaultSchedule
from recon.sim.app.faults import (
    AIRCRAFT_FAULTS,
    JUMP_DEG,
    LINK_FAULTS,
    PLACEHOLDER_SERIAL,
    FaultKind,
    InjectedFault,
)
from recon.sim.app.link_buffers import AppInbox, AppOutbox
from recon.sim.app.reporting import AppReporter
from recon.sim.app.telemetry import (
    HomeAltitude,
    TelemetrySensors,
    TelemetrySensorSettings,
    position_deg,
)
from recon.sim.camera.rig import CameraRig
from recon.sim.flight.aircraft import Aircraft

CORE_PERIOD_NS = 100_000_000
EXTENDED_PERIOD_NS = 500_000_000
ACTION_DELAY_NS = 120_000_000
"""Time from the acknowledgment to the effect: the duration of a call of DJI's SDK."""

NEVER_NS = 2**63 - 1

HELLO = b"recon-sim simulated vehicle"
MESSAGE_INFO = 1
MAIN_LINK = 0


class LinkOrderKind(Enum):
    """What the driver must do with the app's connection."""

    RECONNECT = "reconnect"
    """Close it; after `seconds` open it again."""
    ABANDON = "abandon"
    """Keep it open for `seconds` without reading or writing, and open a new one at once."""
    SECOND = "second"
    """Open another one beside it, for `seconds`."""


@dataclass(frozen=True, slots=True)
class LinkOrder:
    """One action on the connection, and its duration."""

    kind: LinkOrderKind
    seconds: float


_DUE_NS = itemgetter(0)
_LINK_ORDERS = {
    FaultKind.RESTART: LinkOrderKind.RECONNECT,
    FaultKind.HALF_OPEN: LinkOrderKind.ABANDON,
    FaultKind.SECOND_LINK: LinkOrderKind.SECOND,
}


@dataclass(frozen=True, slots=True)
class AppSettings:
    """Identity, home and behaviour of one simulated app."""

    serial: str
    home: GeoPoint
    seed: int = 0
    behaviour: AppBehaviour = field(default_factory=AppBehaviour)
    faults: tuple[InjectedFault, ...] = ()
    sensors: TelemetrySensorSettings = field(default_factory=TelemetrySensorSettings)
    renders_inline: bool = True
    """False: the driver takes the shots and renders them in a thread."""


@dataclass(slots=True)
class _Link:
    deframer: wire.Deframer = field(default_factory=wire.Deframer)
    inbox: AppInbox = field(default_factory=AppInbox)
    outbox: AppOutbox = field(default_factory=AppOutbox)


class SimulatedApp:
    """A companion app: telemetry out, commands in, frames if it has a camera feed."""

    def __init__(
        self,
        settings: AppSettings,
        aircraft: Aircraft,
        feed: CameraFeed | None = None,
        rig: CameraRig | None = None,
    ) -> None:
        self.settings = settings
        self.aircraft = aircraft
        self.feed = feed
        self.rig = rig
        self._start_ns = aircraft.now_ns
        home, behaviour = settings.home, settings.behaviour
        self._altitude = HomeAltitude(home.ellipsoid_height_m, behaviour.altitude_bias_m)
        random = Random(f"{settings.seed}/{settings.serial}/sensors")
        self._sensors = TelemetrySensors(home, self._altitude, settings.sensors, random)
        self._commands = CommandHandler(home, aircraft, feed, behaviour, self._altitude)
        self.reporter = self._reporter()
        """Its facts and photos; None: a plain app."""
        if self.reporter is not None:
            self._commands.lock_camera = self.reporter.lock
        self._links: dict[int, _Link] = {}
        self._pending: deque[tuple[int, AppResponse]] = deque()
        self._start: tuple[int, MissionStart] | None = None
        """The mission being uploaded, and when it is flown."""
        self._link_orders: deque[LinkOrder] = deque()
        name = f"{settings.seed}/{settings.serial}/faults"
        self._plan = FaultSchedule(name, self._start_ns)
        self._aircraft_faults = AircraftFaults(aircraft, self._altitude, name)
        self._is_silent = False
        self._now_ns = self._start_ns
        self._fault_events: list[tuple[int, Callable[[], None]]] = []
        for fault in settings.faults:
            self.inject(fault)
        self._log: deque[str] = deque(maxlen=64)
        # Real apps are not synchronised: telemetry starts at a random phase of the first period.
        phase_ns = random.randrange(CORE_PERIOD_NS)
        self._next_core_ns = self._start_ns + phase_ns
        self._next_extended_ns = self._start_ns + phase_ns

    def _reporter(self) -> AppReporter | None:
        settings, interval_s = self.settings, self.settings.behaviour.photo_interval_s
        if interval_s is None:
            return None
        random = Random(f"{settings.seed}/{settings.serial}/shutter")
        return AppReporter(
            settings.serial,
            settings.home,
            self.aircraft,
            interval_s,
            settings.behaviour.takes_missions,
            random.randrange(2**32),
            random,
            self._has,
        )

    def inject(self, fault: InjectedFault) -> None:
        """Add a fault to those that are to happen, or have."""
        self._plan.add(fault)
        self._fault_events += self._one_off_events(fault)
        self._fault_events.sort(key=_DUE_NS)

    def connected(self, now_ns: int, link: int = MAIN_LINK) -> None:
        """Start a connection with the greeting; it replaces an older one of this number."""
        self._run_until(now_ns)
        self._links[link] = _Link()
        if self.feed is not None and link == MAIN_LINK:
            # No frames were taken while there was no link to send them on.
            self.feed.skip_to(now_ns)
        if self.reporter is not None:
            self.reporter.connected()
        self._send(wire.encode(wire.MessageString(type=MESSAGE_INFO, text=HELLO)), link, now_ns)

    def disconnected(self, link: int = MAIN_LINK) -> None:
        """Drop a connection and what it still had to send."""
        self._links.pop(link, None)

    def receive(self, data: bytes, now_ns: int, link: int = MAIN_LINK) -> None:
        """Take bytes read from a connection: acknowledge now, act a little later."""
        self._run_until(now_ns)
        if link not in self._links or self._is_silent:
            return
        self._links[link].inbox.keep(data, now_ns)
        if not self._plan.has(FaultKind.SLOW_READER, now_ns):
            self._read(link, now_ns)

    def advance(self, now_ns: int, link: int = MAIN_LINK) -> list[bytes]:
        """Advance to a time and return the packets to send on a connection, in order."""
        self._run_until(now_ns)
        waiting = self._links.get(link)
        if waiting is None:
            return []
        return waiting.outbox.pop_due(now_ns)

    def takes_more(self, link: int = MAIN_LINK) -> bool:
        """Return whether to read on; if not, TCP flow control stops the station."""
        waiting = self._links.get(link)
        return waiting is None or (not self._is_silent and waiting.inbox.has_room)

    @property
    def next_due_ns(self) -> int:
        """Return when `advance` has work next, if nothing is received before."""
        due_ns, _ = self._next_work()
        for link in self._links.values():
            held_until_ns = link.outbox.next_after_ns(self._now_ns)
            if held_until_ns is not None and held_until_ns < due_ns:
                due_ns = held_until_ns
        return due_ns

    def take_shots(self) -> list[Shot]:
        """Return frames taken but not rendered (unless rendered inline); see `add_image`."""
        return [] if self.feed is None else self.feed.take_shots()

    def add_image(self, shot: Shot, packet: bytes | None) -> None:
        """Take back a rendered shot's packet; None when rendering failed."""
        if self.feed is None:
            return
        if packet is None:
            self.feed.lose()
        else:
            self.feed.add(shot, packet)

    def take_link_orders(self) -> list[LinkOrder]:
        """Return what faults require of the connection since the last call."""
        orders = list(self._link_orders)
        self._link_orders.clear()
        return orders

    def take_log(self) -> list[str]:
        """Return log lines since the last call."""
        lines = list(self._log)
        self._log.clear()
        return lines

    def true_reference(self) -> TelemetryReference:
        """Return the true position and attitude, in the units of telemetry."""
        motion = self.aircraft.motion
        latitude, longitude = position_deg(self.settings.home, motion.north_m, motion.east_m)
        return TelemetryReference(
            latitude,
            longitude,
            motion.height_m,
            motion.yaw_deg,
            motion.pitch_deg,
            motion.roll_deg,
        )

    def _next_work(self) -> tuple[int, Callable[[int], None]]:
        """Return when work is due next, and which; on a tie the kind named first here.

        Compared one by one, without a list of them all: it is asked for with every packet.
        """
        due_ns, work = NEVER_NS, self._send_core
        if self._pending:
            due_ns, work = self._pending[0][0], self._execute
        if self._start is not None and self._start[0] < due_ns:
            due_ns, work = self._start[0], self._start_mission
        if self._fault_events and self._fault_events[0][0] < due_ns:
            due_ns, work = self._fault_events[0][0], self._run_fault_event
        for number, link in self._links.items():
            read_ns = link.inbox.next_read_ns
            if read_ns is not None and read_ns < due_ns:
                due_ns, work = read_ns, partial(self._read_on, number)
        if self._next_core_ns < due_ns:
            due_ns, work = self._next_core_ns, self._send_core
        if self._next_extended_ns < due_ns:
            due_ns, work = self._next_extended_ns, self._send_extended
        reporter = self.reporter
        if reporter is not None and reporter.next_due_ns < due_ns:
            due_ns, work = max(reporter.next_due_ns, self._now_ns), self._send_reports
        return self._next_camera_work(due_ns, work)

    def _next_camera_work(
        self, due_ns: int, work: Callable[[int], None]
    ) -> tuple[int, Callable[[int], None]]:
        feed = self.feed
        if feed is None:
            return due_ns, work
        if feed.is_on and MAIN_LINK in self._links and feed.next_shot_ns < due_ns:
            due_ns, work = feed.next_shot_ns, partial(self._take_picture, feed)
        if feed.next_send_ns is not None and feed.next_send_ns < due_ns:
            due_ns, work = feed.next_send_ns, partial(self._send_images, feed)
        return due_ns, work

    def _run_until(self, now_ns: int) -> None:
        while True:
            due_ns, work = self._next_work()
            if due_ns > now_ns:
                break
            self._advance_aircraft(due_ns)
            work(due_ns)
        self._now_ns = max(self._now_ns, now_ns)
        self._advance_aircraft(now_ns)

    def _advance_aircraft(self, now_ns: int) -> None:
        aircraft = self.aircraft
        if now_ns < aircraft.next_tick_ns:
            return
        mode = aircraft.flight_mode
        aircraft.advance(now_ns)
        if aircraft.flight_mode is not mode:
            self._log.append(f"mode {aircraft.flight_mode.name}")

    def _read_on(self, link: int, now_ns: int) -> None:
        """Read a few of the waiting bytes, or all of them once the fault is over."""
        self._read(link, now_ns, self._plan.has(FaultKind.SLOW_READER, now_ns))

    def _read(self, link: int, now_ns: int, slowly: bool = False) -> None:
        waiting = self._links[link]
        for packet in waiting.deframer.feed(waiting.inbox.read(slowly), now_ns):
            self._respond(packet, link, now_ns)

    def _respond(self, packet: wire.Packet, link: int, now_ns: int) -> None:
        response = self._commands.response(packet)
        if response is None:
            self._log.append(f"ignored a {type(packet).__name__}")
            return
        # Refusal and acknowledgment are separate faults: each may be active without the other.
        refuses = self._has(FaultKind.NEGATIVE_ACK, now_ns)
        if not self._has(FaultKind.NO_ACK, now_ns):
            positive = response.is_positive and not refuses
            answer = wire.Acknowledgment(positive=int(positive), source_pid=response.source_pid)
            self._send(wire.encode(answer), link, now_ns, self._plan.ack_time_ns(now_ns))
        is_mission = isinstance(packet, wire.ExecuteWaypointMission)
        ignores = is_mission and self._has(FaultKind.IGNORED_MISSIONS, now_ns)
        if refuses or ignores or self._has(FaultKind.ACK_THEN_NOTHING, now_ns):
            self._log.append(f"command {response.source_pid}: not executed (fault)")
        else:
            self._pending.append((now_ns + ACTION_DELAY_NS, response))

    def _execute(self, now_ns: int) -> None:
        _, response = self._pending.popleft()
        if response.moves:
            self._start = None
        with self._mode_logged():
            done = response.act(now_ns)
            if isinstance(done, MissionStart):
                self._start = (now_ns + seconds_to_ns(done.after_s), done)
            else:
                self._log.append(done)

    def _start_mission(self, now_ns: int) -> None:
        assert self._start is not None  # or it would not be due
        (_, mission), self._start = self._start, None
        with self._mode_logged():
            self._log.append(mission.start())

    @contextmanager
    def _mode_logged(self) -> Iterator[None]:
        mode = self.aircraft.flight_mode
        yield
        if self.aircraft.flight_mode is not mode:
            self._log.append(f"mode {self.aircraft.flight_mode.name}")

    def _send_core(self, now_ns: int) -> None:
        self._next_core_ns = now_ns + CORE_PERIOD_NS
        packet = self._sensors.core(
            self.aircraft,
            CORE_PERIOD_NS / NS_PER_S,
            is_flying=self.aircraft.is_flying and not self._has(FaultKind.FALSE_GROUND, now_ns),
            north_deg=JUMP_DEG if self._has(FaultKind.POSITION_JUMP, now_ns) else 0.0,
        )
        self._broadcast(self._plan.as_frozen(packet, now_ns), now_ns)

    def _send_extended(self, now_ns: int) -> None:
        self._next_extended_ns = now_ns + EXTENDED_PERIOD_NS
        is_placeholder = self._has(FaultKind.PLACEHOLDER_SERIAL, now_ns)
        serial = PLACEHOLDER_SERIAL if is_placeholder else self.settings.serial.encode()
        reports_id = self.settings.behaviour.reports_mission_id
        packet = self._sensors.extended(self.aircraft, self.feed, serial, reports_id)
        self._broadcast(self._plan.as_frozen(packet, now_ns), now_ns)

    def _send_reports(self, now_ns: int) -> None:
        assert self.reporter is not None  # or it would not be due
        for packet in self.reporter.texts(now_ns, bool(self._links)):
            for link in self._links:
                self._send(packet, link, now_ns)

    def _take_picture(self, feed: CameraFeed, now_ns: int) -> None:
        if self._has(FaultKind.CAMERA_STOPS, now_ns):
            feed.miss()
            return
        repeats = self._has(FaultKind.FRAMES_REPEATED, now_ns)
        feed.take(self._camera_pose(), self._plan.frame_flaw(now_ns), repeats)
        if self.settings.renders_inline:
            for shot in feed.take_shots():
                feed.add(shot, shot.packet())

    def _camera_pose(self) -> CameraPose | None:
        return None if self.rig is None else self.rig.pose_at(self.true_reference())

    def _send_images(self, feed: CameraFeed, now_ns: int) -> None:
        # Taken from the feed even when not sent: frames of a dropout are lost, not delayed.
        packets = feed.due(now_ns)
        if MAIN_LINK in self._links and not self._has(FaultKind.TELEMETRY_DROPOUT, now_ns):
            for packet in packets:
                self._send(packet, MAIN_LINK, now_ns)

    def _one_off_events(self, fault: InjectedFault) -> Iterator[tuple[int, Callable[[], None]]]:
        """Yield begin and end times of a one-off fault, each with its action."""
        begin_ns = self._start_ns + seconds_to_ns(fault.start_s)
        if fault.kind in LINK_FAULTS:
            yield begin_ns, partial(self._begin_link_fault, fault)
        elif fault.kind in AIRCRAFT_FAULTS:
            yield begin_ns, partial(self._begin_aircraft_fault, fault)
            end_ns = fault.end_ns(self._start_ns)
            if end_ns is not None:
                yield end_ns, partial(self._aircraft_faults.end, fault.kind)

    def _run_fault_event(self, now_ns: int) -> None:
        _due_ns, action = self._fault_events.pop(0)
        action()

    def _begin_aircraft_fault(self, fault: InjectedFault) -> None:
        self._log.append(f"fault {fault.kind.value}")
        self._aircraft_faults.begin(fault.kind)
        self._is_silent = self._is_silent or fault.kind is FaultKind.FALLS_SILENT

    def _begin_link_fault(self, fault: InjectedFault) -> None:
        self._log.append(f"fault {fault.kind.value}")
        self._link_orders.append(LinkOrder(_LINK_ORDERS[fault.kind], fault.duration_s))
        # The first link stays open: both report the same serial.
        if fault.kind is FaultKind.SECOND_LINK:
            return
        self.disconnected()
        if fault.kind is FaultKind.RESTART:
            self._pending.clear()
            self._start = None
            self.aircraft.forget_mission_numbers()

    def _has(self, kind: FaultKind, now_ns: int) -> bool:
        return self._plan.has(kind, now_ns)

    def _broadcast(self, packet: wire.Packet, now_ns: int) -> None:
        if self._has(FaultKind.TELEMETRY_DROPOUT, now_ns):
            return
        encoded = wire.encode(packet)
        for link in self._links:
            self._send(encoded, link, now_ns)

    def _send(self, packet: bytes, link: int, now_ns: int, due_ns: int | None = None) -> None:
        """Queue a packet for `due_ns`, by default now; active faults may delay or damage it."""
        if self._is_silent:
            return
        due_ns = self._plan.send_time_ns(now_ns) if due_ns is None else due_ns
        self._links[link].outbox.add(self._plan.damaged(packet, now_ns), due_ns)
