"""What a run leaves: every step with its outputs and audit, all link bytes, topics to look at.

`Recorder` takes steps and bytes from a driver, on its thread. It only keeps them until the next
tick, so that no order waits; then they are encoded and handed to the process that writes, or wait
for the file's beginning, up to `WAITING_BYTES`.

Theory of operation. One file is one flight, with the time on the ground before it:

    on the ground --the first vehicle takes off--> in flight
    in flight --nothing has flown for AFTER_LANDING_S--> on the ground, in a new file
    in flight --RecordDetail.flight_file_s--> in flight, in a new file
    on the ground --GROUND_FILE_S--> on the ground, in a new file

A file begins with the state of the station, for replays, which a thread encodes while steps wait.
Results of jobs are not recorded, so a file begins at a moment at which no job runs. When the
process that writes has died, another one begins a new file, also in flight; where jobs never pause
for `RESTART_WITHIN_S`, beside running jobs, and a replay of it is then compared up to the first
result of them.
"""

import threading
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from itertools import chain
from pathlib import Path
from typing import Any, Protocol

import msgspec
import zstandard

from recon import version
from recon.link.tap import Direction
from recon.model.errors import describe_fault
from recon.model.event import Event, LinkClosed, PacketReceived, RecordFailed, Tick
from recon.model.shade import ShadeMap, SunForecast
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.record.audit.audit import AuditEntry
from recon.record.mcap.items import (
    BULK_BYTES,
    COMPRESSION,
    HEAD,
    LINK_HEAD,
    STEP_HEAD,
    Beginning,
    ItemKind,
    TimedValue,
    packed,
)
from recon.record.mcap.record_process import BULK_SHARE, CLOSE_WITHIN_S, RING_BYTES, RecordProcess
from recon.site import Site
from recon.station.audit.entries import Auditing
from recon.station.recording.keyframe import (
    EVERYTHING,
    DueKeyframe,
    DueMaps,
    Keyframes,
    RecordDetail,
    keyframe_pieces,
)
from recon.station.recording.recorded_values import (
    FlightStart,
    audit_builtins,
    output_builtins,
    survey_facts,
    values_codec,
)
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobDone, JobDropped, JobFailed, Output, StepTaken

AFTER_LANDING_S = 30.0
"""Time in which vehicles that change batteries and fly again belong to one flight."""
GROUND_FILE_S = 300.0
"""Longest time before a flight that its file has."""
RESTART_AFTER_S = 5.0
RESTART_WITHIN_S = 30.0
"""A record that cannot be replayed is better than none."""

WAITING_BYTES = RING_BYTES // 4
"""Limit while a file's first state is encoded: minutes of telemetry, a second of raw frames."""
WAITING_BULK_BYTES = int(BULK_SHARE * WAITING_BYTES)


class Audited(Protocol):
    """The audit of the newest step, and what it remembers."""

    @property
    def entries(self) -> tuple[AuditEntry, ...]:
        """The entries of the newest step."""

    @property
    def memory(self) -> Auditing:
        """What the entries of the next step depend on."""


@dataclass(frozen=True, slots=True, eq=False)
class _TakenStep:
    """One step, as far as it is recorded: not the states, which would keep old images in memory."""

    number: int
    event: Event
    now_ns: int
    outputs: tuple[Output, ...]
    entries: tuple[AuditEntry, ...]
    vehicle: str
    """The vehicle that sent a packet, for its topic; empty without one."""


@dataclass(frozen=True, slots=True)
class _TakenBytes:
    """Bytes of one read or one write of a link."""

    link_id: int
    direction: Direction
    data: bytes
    at_ns: int
    start: int
    """Bytes that came from the app before these."""


_Taken = _TakenStep | _TakenBytes | DueMaps | DueKeyframe


class Recorder:
    """Takes a driver's steps and its links' bytes; never waits."""

    def __init__(
        self,
        new_process: Callable[[], RecordProcess],
        handle: Callable[[Event], None],
        audited: Audited,
        site: Site,
        scenario: str = "",
        detail: RecordDetail = EVERYTHING,
    ) -> None:
        """`handle` is the driver's queue, for `RecordFailed`."""
        self.process = new_process()
        self._new_process = new_process
        self._handle = handle
        self._audited = audited
        self._site, self._scenario, self._detail = site, scenario, detail
        self._codec = values_codec()
        self._kept: list[_Taken] = []
        self._encoding: threading.Thread | None = None
        self._beginning: bytes | None = None
        self._waiting: list[tuple[bytes, ...]] = []
        """Encoded items that wait for the file's beginning."""
        self._waiting_bytes = 0
        self._ends: dict[int, int] = {}
        """Bytes that came from the app of each open link."""
        self._jobs: set[tuple[str, int]] = set()
        self._number = self._dropped_bytes = 0
        self._has_flown = self._reports_flown = False
        self._began_ns = self._quiet_since_ns = 0
        """Start of the file; and, if it has a flight, when a vehicle was last seen flying."""
        self._keyframes = Keyframes(detail)
        self._pieces: Iterator[bytes] | None = None
        """Pieces of the keyframe being encoded, which is the first of the queued items."""
        self._died_at_ns: int | None = None
        self._restart_at_ns = 0
        self._reported: str | None = None
        self._fault: str | None = None

    def start(self, station: Station, now_ns: int) -> None:
        """Begin the first file, with the station before its first event."""
        self.process.start()
        self._begin_file(station, now_ns)

    def take(self, step: StepTaken) -> None:
        """Record a step; once a tick, hand over what was taken since the last one."""
        self._number += 1
        self._kept.append(_recorded(step, self._number, self._audited.entries))
        self._follow_jobs(step)
        if isinstance(step.event, LinkClosed):
            self._ends.pop(step.event.link_id, None)
        self._kept += self._keyframes.due(step, self._number)
        if isinstance(step.event, Tick):
            self._hand_over()
            self._follow_flight(step.after, step.now_ns)
            self._report_problem()

    def tap(self, link_id: int, direction: Direction, data: bytes, at_ns: int) -> None:
        """Record a link's bytes."""
        start = 0
        if direction is Direction.FROM_APP:
            start = self._ends.get(link_id, 0)
            self._ends[link_id] = start + len(data)
        self._kept.append(_TakenBytes(link_id, direction, data, at_ns, start))

    def close(self, within_s: float = CLOSE_WITHIN_S) -> None:
        """Hand over the rest, and have the file finished, as far as the disk takes it in time."""
        if self._encoding is not None:
            self._encoding.join()
        self._hand_over(has_time=True)
        self.process.close(within_s)

    @property
    def dropped_bytes(self) -> int:
        """Bytes of links that are in no record of this run."""
        return self._dropped_bytes + self.process.dropped_bytes

    def _hand_over(self, *, has_time: bool = False) -> None:
        """Encode what was taken since the last tick; hand it over, or let it wait.

        Without `has_time` a keyframe is encoded over some ticks, and what came after it waits.
        """
        begins = self._begin_parts()
        if begins is None:
            self._encode_kept(WAITING_BYTES, WAITING_BULK_BYTES, has_time)
            return
        process, used = self.process, sum(map(len, begins))
        self._encode_kept(process.room_bytes - used, process.bulk_room_bytes - used, has_time)
        process.put(chain(begins, *self._waiting))
        self._waiting, self._waiting_bytes = [], 0

    def _begin_parts(self) -> tuple[bytes, ...] | None:
        """Return what comes first of all, None while the file's beginning is not ready for it."""
        if self._encoding is not None:
            if self._encoding.is_alive():
                return None
            self._encoding = None
        begins: tuple[bytes, ...] = ()
        if self._beginning is not None:
            begins += packed(ItemKind.BEGIN, self._beginning)
        if self._reports_flown:
            begins += packed(ItemKind.FLOWN)
        if begins and sum(map(len, begins)) + self._waiting_bytes > self.process.room_bytes:
            return None
        self._beginning, self._reports_flown = None, False
        return begins

    def _encode_kept(self, limit_bytes: int, bulk_limit_bytes: int, has_time: bool) -> None:
        """Encode what was taken as far as all that waits stays within limits; drop the rest."""
        kept, self._kept = self._kept, []
        for number, item in enumerate(kept):
            if isinstance(item, _TakenBytes):
                most_bytes = bulk_limit_bytes if len(item.data) >= BULK_BYTES else limit_bytes
                parts = _bytes_parts(item)
            elif isinstance(item, DueKeyframe):
                most_bytes, parts = bulk_limit_bytes, self._state_parts(item, has_time)
                if self._pieces is not None:
                    self._kept = kept[number:]
                    return
            elif isinstance(item, DueMaps):
                most_bytes, parts = limit_bytes, self._map_parts(item)
            else:
                most_bytes, parts = limit_bytes, self._step_parts(item)
            if parts:
                self._let_wait(item, parts, most_bytes)

    def _let_wait(self, item: _Taken, parts: tuple[bytes, ...], most: int) -> None:
        total_bytes = self._waiting_bytes + sum(map(len, parts))
        if total_bytes > most:
            self._drop(item)
            return
        self._waiting.append(parts)
        self._waiting_bytes = total_bytes

    def _drop(self, item: _Taken) -> None:
        if isinstance(item, _TakenStep | DueMaps):
            self.process.dropped_steps += 1
        elif isinstance(item, _TakenBytes):  # the next keyframe stands for one that is dropped
            self.process.dropped_bytes += len(item.data)

    def _step_parts(self, item: _TakenStep) -> tuple[bytes, ...]:
        message = {
            "event": self._codec.to_builtins(item.event, Event),
            "outputs": [output_builtins(self._codec, each) for each in item.outputs],
            "audit": audit_builtins(item.entries),
        }
        vehicle = item.vehicle.encode()
        head = STEP_HEAD.pack(item.number, item.now_ns, len(vehicle))
        return packed(ItemKind.STEP, head, vehicle, msgspec.msgpack.encode(message))

    def _map_parts(self, item: DueMaps) -> tuple[bytes, ...]:
        parts = self._value_parts(ItemKind.SHADE, item.now_ns, item.shade, ShadeMap)
        if item.sun is not None:
            parts += self._value_parts(ItemKind.SUN, item.now_ns, item.sun, SunForecast)
        return parts

    def _state_parts(self, item: DueKeyframe, has_time: bool) -> tuple[bytes, ...]:
        """Return a keyframe's parts; while it has `_pieces`, it is not whole."""
        data = b""
        try:
            self._pieces = self._pieces or keyframe_pieces(self._codec, item)
            data = next(filter(None, self._pieces)) if has_time else next(self._pieces)
            if not data:
                return ()
        except Exception as fault:  # steps continue: they are what a flight is explained by
            self._fault = f"a replay in the console lacks states: {describe_fault(fault)}"
        self._pieces = None
        head = STEP_HEAD.pack(item.number, item.now_ns, 0)
        return packed(ItemKind.KEYFRAME, head, data) if data else ()

    def _value_parts(self, kind: ItemKind, at_ns: int, value: Any, hint: Any) -> tuple[bytes, ...]:
        timed = TimedValue(at_ns, self._codec.to_builtins(value, hint))
        return packed(kind, msgspec.msgpack.encode(timed))

    def _follow_jobs(self, step: StepTaken) -> None:
        event = step.event
        if isinstance(event, JobDone | JobFailed | JobDropped):
            self._jobs.discard((event.kind.name, event.job_id))
        for output in step.outputs:
            if isinstance(output, Job):
                self._jobs.add((output.kind.name, output.id))

    def _follow_flight(self, station: Station, now_ns: int) -> None:
        if self.process.is_dead:
            self._restart(station, now_ns)
            return
        if is_flying(station):
            self._quiet_since_ns = now_ns
            if not self._has_flown:
                self._has_flown = self._reports_flown = True
            is_due = self._is_long_enough(station, now_ns)
        else:
            lasts_s = AFTER_LANDING_S if self._has_flown else GROUND_FILE_S
            is_due = now_ns - self._quiet_since_ns >= seconds_to_ns(lasts_s)
        if is_due and not self._jobs and not self._is_beginning:
            self._hand_over(has_time=True)
            self._begin_file(station, now_ns)

    def _is_long_enough(self, station: Station, now_ns: int) -> bool:
        """Return whether the file of a flight should end in the air."""
        lasted_s, longest_s = ns_to_seconds(now_ns - self._began_ns), self._detail.flight_file_s
        surveys = station.surveys.records.values()
        return lasted_s >= (longest_s if all(e.is_over for e in surveys) else 2.0 * longest_s)

    @property
    def _is_beginning(self) -> bool:
        """Whether the newest file's beginning has not been handed over."""
        return self._encoding is not None or self._beginning is not None

    def _restart(self, station: Station, now_ns: int) -> None:
        """Have another process begin a new file; try again later if it cannot be started."""
        if self._died_at_ns is None:
            self._died_at_ns = now_ns
            self._restart_at_ns = now_ns + seconds_to_ns(RESTART_AFTER_S)
        waits_for_jobs = self._jobs and now_ns < self._died_at_ns + seconds_to_ns(RESTART_WITHIN_S)
        if now_ns < self._restart_at_ns or waits_for_jobs or self._encoding is not None:
            return
        process = self._new_process()
        try:
            process.start()
        except OSError:
            self._restart_at_ns = now_ns + seconds_to_ns(RESTART_AFTER_S)
            return
        self._died_at_ns = None
        self._forget_drops()
        self.process.close(0.0)
        self.process = process
        self._begin_file(station, now_ns)

    def _begin_file(self, station: Station, now_ns: int) -> None:
        """Begin a file with this state; what is taken from now on waits for it.

        What still waits came before this state, for a file that never began: it is dropped.
        """
        self._drop_waiting()
        self._forget_drops()
        self._fault = None
        self._number = 0
        self._began_ns = self._quiet_since_ns = now_ns
        self._keyframes.begin(station, now_ns)
        self._has_flown = self._reports_flown = False
        memory, jobs = self._audited.memory, len(self._jobs)
        start = FlightStart.now(self._site, station, now_ns, memory, self._scenario, jobs)
        self._encoding = threading.Thread(target=self._encode, args=(start,), name="record-start")
        self._encoding.start()

    def _drop_waiting(self) -> None:
        for item in self._kept:
            self._drop(item)
        for head, *_ in self._waiting:
            kind, size_bytes = HEAD.unpack(head)
            if kind == ItemKind.LINK:
                self.process.dropped_bytes += size_bytes - LINK_HEAD.size
        self._kept, self._waiting, self._waiting_bytes = [], [], 0
        self._pieces = None

    def _forget_drops(self) -> None:
        """What one file lacks is no problem of the next one."""
        self._dropped_bytes += self.process.dropped_bytes
        self.process.dropped_bytes = self.process.dropped_steps = 0

    def _encode(self, start: FlightStart) -> None:
        state, text = b"", b"{}"
        try:
            about = _about(start) | {"is_demo": self._detail.is_demo}
            text = msgspec.json.encode(about, enc_hook=str)
            # A codec of its own: it compiles types as it meets them.
            state = zstandard.compress(values_codec().encode(start, FlightStart), COMPRESSION)
        except Exception as fault:
            self._fault = f"the record begins without the station's state: {describe_fault(fault)}"
        self._beginning = msgspec.msgpack.encode(Beginning(start.started_at_ns, state, text))

    def _report_problem(self) -> None:
        problem = self.process.problem or self._fault
        if problem != self._reported:
            self._reported = problem
            self._handle(RecordFailed(problem))


def _about(start: FlightStart) -> dict[str, Any]:
    """Return the start as a person reads it."""
    return {
        "version": start.version,
        "python": start.python,
        "numpy": start.numpy,
        "machine": start.machine,
        "site": start.site.name,
        "origin": None if start.site.frame is None else asdict(start.site.frame.origin),
        "imagers": list(start.site.imagers),
        "vehicles": {s: each.display_name for s, each in start.site.profiles.items()},
        "scenario": start.scenario,
        "surveys": [
            survey_facts(each)
            for each in start.station.surveys.records.values()
            if not each.is_over
        ],
        "running_jobs": start.running_jobs,
        "settings": asdict(start.station.settings),
    }


def is_flying(station: Station) -> bool:
    """Return whether any vehicle, identified or not, is or may be in flight."""
    fleet = station.fleet
    states = [*fleet.vehicles.values(), *(link.own_state for link in fleet.unbound_links())]
    return bool(station.watchdog_state.lost) or any(s.is_flying.value is True for s in states)


def _bytes_parts(item: _TakenBytes) -> tuple[bytes, ...]:
    is_from_app = item.direction is Direction.FROM_APP
    head = LINK_HEAD.pack(item.link_id, is_from_app, item.at_ns, item.start)
    return packed(ItemKind.LINK, head, item.data)


def _recorded(step: StepTaken, number: int, entries: tuple[AuditEntry, ...]) -> _TakenStep:
    event, vehicle = step.event, ""
    if isinstance(event, PacketReceived):
        known = step.after.fleet.vehicle_of_link(event.link_id)
        serial = None if known is None else known.serial
        vehicle = serial or f"link-{event.link_id}"
    return _TakenStep(number, event, step.now_ns, step.outputs, entries, vehicle)


def record_process(folder: Path) -> RecordProcess:
    """Return the process that writes a run's records into a folder; it is not started."""
    return RecordProcess(folder, f"recon {version()}")
