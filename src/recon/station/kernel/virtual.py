"""The driver in virtual time: the same sessions, bytes and steps without sockets or clock.

Used by tests and studies. Everything happens at whole steps of 10 ms, and idle steps are skipped.
The order is always the same: the same peers and seeds give the same run to the bit.
"""

import heapq
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from recon.fleet.step import CloseLink
from recon.link.session import Session
from recon.link.settings import LinkSettings
from recon.link.tap import Direction, Tap
from recon.model.command import Refusal
from recon.model.event import (
    ClockRead,
    CommandDropped,
    Event,
    LinkClosed,
    LinkOpened,
    SetpointsDue,
    Tick,
)
from recon.model.units import seconds_to_ns
from recon.safety import ApprovedCommand
from recon.sim.fake_link import FakeLink
from recon.station.control import dispatch
from recon.station.kernel.event_queue import EventQueue
from recon.station.kernel.step import step
from recon.station.kernel.worker import AnyJob, JobRunner
from recon.station.state.station import Station
from recon.station.state.steps import (
    Job,
    JobFailed,
    Output,
    SendCommand,
    StepTaken,
    WithdrawMotion,
)
from recon.station.steering.setpoint_streams import next_due_ns

STEP_NS = 10_000_000
TICK_EVERY_NS = 50_000_000
EPOCH_NS = 1_780_000_000_000_000_000
"""What the computer's clock shows when virtual time begins, by default: a day in 2026."""


class Peer(Protocol):
    """An app at the other end of a link: bytes and times in, bytes out."""

    def receive(self, data: bytes, now_ns: int) -> None:
        """Take bytes from the station."""

    def advance(self, now_ns: int) -> list[bytes]:
        """Return the bytes that it sends now."""

    @property
    def next_due_ns(self) -> int:
        """Return when `advance` is due next, if nothing is received before then."""


@dataclass(slots=True)
class _Wire:
    """One connection: a peer, the link between, and the station's session."""

    peer: Peer
    link: FakeLink
    session: Session
    to_station_at_ns: int = 0
    to_peer_at_ns: int = 0
    peer_due_ns: int = 0


@dataclass(frozen=True, slots=True)
class ToStation:
    """Bytes under way from a peer."""

    link_id: int
    data: bytes


@dataclass(frozen=True, slots=True)
class ToPeer:
    """Bytes under way to a peer."""

    link_id: int
    data: bytes


@dataclass(frozen=True, slots=True)
class JobEnd:
    """The end of a job whose work takes until then."""

    event: Event


Due: TypeAlias = ToStation | ToPeer | JobEnd
"""What the driver does at a later time."""


class VirtualDriver:
    """Runs the station and its peers in virtual time; `recon.sim.fork` copies it."""

    def __init__(
        self,
        station: Station,
        *,
        jobs: JobRunner | None = None,
        link_settings: LinkSettings | None = None,
        work_takes_s: float = 0.05,
        keeps_log: bool = True,
        epoch_ns: int = EPOCH_NS,
    ) -> None:
        self.station = station
        self.now_ns = 0
        self.log: list[Event] = []
        """Every event of the station, in order; not kept in long studies, images fill memory."""
        self.observe: Callable[[StepTaken], None] | None = None
        """Called with every step, as the asyncio driver's observer is."""
        self.record: Callable[[StepTaken], None] | None = None
        """Called with every step, as the asyncio driver's is."""
        self.tap: Tap | None = None
        """Called with all bytes of all links, as the link server's is."""
        self._keeps_log = keeps_log
        self.jobs = jobs
        self._settings = link_settings or LinkSettings()
        self._work_takes_ns = seconds_to_ns(work_takes_s)
        self._wires: dict[int, _Wire] = {}
        self._next_link_id = 1
        self._due: list[tuple[int, int, Due]] = []
        self._sequence = 0
        self._queue = EventQueue(self._step)
        self.handle(ClockRead(epoch_ns))

    def connect(self, peer: Peer, link: FakeLink | None = None) -> int:
        """Open a connection for a peer; return its link id."""
        link_id = self._next_link_id
        self._next_link_id += 1
        session = Session(link_id, self._settings, self.now_ns)
        self._wires[link_id] = _Wire(peer, link or FakeLink(), session)
        self.handle(LinkOpened(link_id, f"virtual:{link_id}"))
        return link_id

    def disconnect(self, link_id: int, reason: str = "the app closed the connection") -> None:
        """End a connection as a FIN would."""
        wire = self._wires.pop(link_id, None)
        if wire is not None:
            self._handle_all(wire.session.finish(reason))
            self.handle(LinkClosed(link_id, reason))

    def is_connected(self, link_id: int) -> bool:
        """Return whether a connection is open."""
        return link_id in self._wires

    def handle(self, event: Event) -> None:
        """Step the station by an event now; events caused by its outputs are queued behind it."""
        self._queue.put(event)

    def run_for(self, seconds: float) -> None:
        """Let virtual time pass, in whole steps; every peer is advanced to its end."""
        end_ns = _step_from(self.now_ns + seconds_to_ns(seconds))
        for wire in self._wires.values():  # a test may have changed a peer meanwhile
            wire.peer_due_ns = min(wire.peer_due_ns, wire.peer.next_due_ns)
        while self.now_ns < end_ns:
            now_ns = min(end_ns, self._next_step_ns())
            self._advance(now_ns, asks_all=now_ns == end_ns)

    def run_until(self, is_reached: Callable[[Station], bool], at_most_s: float) -> bool:
        """Let virtual time pass until a state is reached; return whether it was."""
        end_ns = self.now_ns + seconds_to_ns(at_most_s)
        while self.now_ns < end_ns and not is_reached(self.station):
            self._advance(self.now_ns + STEP_NS, asks_all=True)
        return is_reached(self.station)

    def _step(self, event: Event) -> None:
        if self._keeps_log:
            self.log.append(event)
        before = self.station
        self.station, outputs = step(before, event, self.now_ns)
        taken = StepTaken(event, self.now_ns, before, self.station, outputs)
        if self.observe is not None:
            self.observe(taken)
        for output in outputs:
            self._carry_out(output)
        if self.record is not None:
            self.record(taken)

    def _next_step_ns(self) -> int:
        """Return the next step at which anything is due."""
        due_ns = (self.now_ns // TICK_EVERY_NS + 1) * TICK_EVERY_NS
        if self._due and self._due[0][0] < due_ns:
            due_ns = self._due[0][0]
        sticks_ns = next_due_ns(self.station)
        if sticks_ns is not None and sticks_ns < due_ns:
            due_ns = sticks_ns
        for wire in self._wires.values():
            if wire.peer_due_ns < due_ns:
                due_ns = wire.peer_due_ns
        return max(_step_from(due_ns), self.now_ns + STEP_NS)

    def _advance(self, now_ns: int, *, asks_all: bool) -> None:
        self.now_ns = now_ns
        for link_id, wire in tuple(self._wires.items()):
            if asks_all or wire.peer_due_ns <= now_ns:
                for chunk in wire.peer.advance(now_ns):
                    self._post_to_station(link_id, wire, chunk)
                wire.peer_due_ns = wire.peer.next_due_ns
        while self._due and self._due[0][0] <= now_ns:
            self._do(heapq.heappop(self._due)[2])
        sticks_ns = next_due_ns(self.station)
        if sticks_ns is not None and sticks_ns <= now_ns:
            self.handle(SetpointsDue())
        if now_ns % TICK_EVERY_NS == 0:
            self._tick()

    def _do(self, due: Due) -> None:
        match due:
            case ToStation(link_id, data):
                self._arrive(link_id, data)
            case ToPeer(link_id, data):
                self._reach_peer(link_id, data)
            case JobEnd(event):
                self.handle(event)

    def _tick(self) -> None:
        for link_id, wire in tuple(self._wires.items()):
            self._handle_all(wire.session.tick(self.now_ns))
            while wire.session.is_busy:
                self._handle_all(wire.session.resume())
            self._pump(wire)
            if wire.session.closing_reason is not None:
                self.disconnect(link_id, wire.session.closing_reason)
        self.handle(Tick())

    def _post_to_station(self, link_id: int, wire: _Wire, chunk: bytes) -> None:
        link = wire.link
        if link.is_dead:
            return
        arriving = chunk if link.damage is None else link.damage(chunk, link.rng)
        wire.to_station_at_ns = max(wire.to_station_at_ns, self.now_ns + self._delay_ns(link))
        self._at(wire.to_station_at_ns, ToStation(link_id, arriving))

    def _arrive(self, link_id: int, data: bytes) -> None:
        wire = self._wires.get(link_id)
        if wire is not None and data and not wire.link.is_dead:
            self._tap(link_id, Direction.FROM_APP, data)
            self._handle_all(wire.session.receive(data, self.now_ns))
            while wire.session.is_busy:
                self._handle_all(wire.session.resume())
            self._pump(wire)

    def _pump(self, wire: _Wire) -> None:
        def objection(approved: ApprovedCommand) -> Refusal | None:
            return dispatch.objection(self.station, approved, self.now_ns)

        while (outgoing := wire.session.next_packet(self.now_ns, objection)) is not None:
            if isinstance(outgoing, CommandDropped):
                self.handle(outgoing)
                continue
            self._tap(wire.session.link_id, Direction.TO_APP, outgoing.data)
            self.handle(outgoing.event)
            if not wire.link.is_dead:
                self._post_to_peer(wire, outgoing.data)

    def _tap(self, link_id: int, direction: Direction, data: bytes) -> None:
        if self.tap is not None:
            self.tap(link_id, direction, data, self.now_ns)

    def _post_to_peer(self, wire: _Wire, data: bytes) -> None:
        arrives_at_ns = self.now_ns + self._delay_ns(wire.link)
        wire.to_peer_at_ns = max(wire.to_peer_at_ns, arrives_at_ns)
        self._at(wire.to_peer_at_ns, ToPeer(wire.session.link_id, data))

    def _reach_peer(self, link_id: int, data: bytes) -> None:
        # Bytes under way when a connection ended never arrive: its number is not used again.
        wire = self._wires.get(link_id)
        if wire is not None and not wire.link.is_dead:
            wire.peer.receive(data, self.now_ns)
            wire.peer_due_ns = self.now_ns  # it may have an answer

    def _carry_out(self, output: Output) -> None:
        match output:
            case SendCommand(approved):
                for link_id in approved.link_ids:
                    wire = self._wires.get(link_id)
                    if wire is not None:
                        self._handle_all(wire.session.submit(approved))
                        self._pump(wire)
            case WithdrawMotion(link_ids, reason):
                for link_id in link_ids:
                    wire = self._wires.get(link_id)
                    if wire is not None:
                        self._handle_all(wire.session.withdraw_motion(reason))
            case CloseLink(link_id, reason):
                self.disconnect(link_id, reason)
            case Job():
                self._at(self.now_ns + self._work_takes_ns, JobEnd(self._run(output)))

    def _run(self, job: AnyJob) -> Event:
        if self.jobs is None:
            return JobFailed(job.id, job.kind, "this driver runs no jobs")
        return self.jobs.run(job)

    def _delay_ns(self, link: FakeLink) -> int:
        return seconds_to_ns(link.delay_s + link.jitter_s * link.rng.random())

    def _handle_all(self, events: Iterable[Event]) -> None:
        for event in events:
            self.handle(event)

    def _at(self, at_ns: int, due: Due) -> None:
        self._sequence += 1
        heapq.heappush(self._due, (at_ns, self._sequence, due))


def _step_from(at_ns: int) -> int:
    """Return the first whole step that is not before a time."""
    return -(-at_ns // STEP_NS) * STEP_NS
