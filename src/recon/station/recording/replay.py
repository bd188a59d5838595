"""Running the step again on a recorded flight, and comparing every output to the bit.

Each recorded event goes through the same step, at its own time, from the recorded first state. The
end of a job is worked out by running the job that the replayed step has started: jobs are pure, and
their budgets count nodes. A job that does more than return a result is not run; its end is taken as
recorded. Then outputs and audit entries are compared as maps and lists, and a difference is
a path into them with the two values.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import zstandard
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage

from recon.model.errors import RecordError
from recon.model.event import Event, PacketReceived
from recon.model.report import ImageReport
from recon.model.units import ns_to_seconds
from recon.record.mcap.codec import Codec
from recon.record.mcap.digest import digest
from recon.record.mcap.flight_messages import START_NAME
from recon.record.mcap.link_bytes import Picture, Pictures
from recon.record.mcap.mcap_file import STEPS_TOPIC
from recon.record.mcap.mcap_read import (
    MOST_RECORD_BYTES,
    McapReading,
    RecordAttachment,
    RecordMessage,
)
from recon.station.audit.entries import Auditing, audit
from recon.station.kernel.fault_isolation import after_fault
from recon.station.kernel.step import TICK_PARTS, step
from recon.station.kernel.worker import AnyJob, JobRunner
from recon.station.recording.recorded_values import (
    DONE,
    FAILED,
    EndOfJob,
    FlightStart,
    FrameReport,
    audit_builtins,
    output_builtins,
    output_with_defaults,
    values_codec,
)
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobDone, JobDropped, JobFailed, Stepped

REPORT_EVERY_STEPS = 2000

OnJob = Callable[[AnyJob, Event], None]

MOST_DIFFERENCES = 20
"""Most differences reported: after the first one the replayed station is in another state."""


@dataclass(frozen=True, slots=True)
class Difference:
    """One value that is not as recorded; `None` stands for nothing there."""

    step: int
    after_s: float
    """Time since the flight's start."""
    event: str
    path: str
    recorded: Any
    now: Any

    def __str__(self) -> str:
        where = f"step {self.step} at {self.after_s:.3f} s, {self.event}: {self.path}"
        return f"{where}: recorded {_shown(self.recorded)}, now {_shown(self.now)}"


@dataclass(slots=True)
class Checked:
    """What a replay found."""

    start: FlightStart | None = None
    steps: int = 0
    jobs: int = 0
    lasted_s: float = 0.0
    differences: list[Difference] = field(default_factory=list)
    trouble: str = ""
    """Why the check ended before the record's end; empty if it did not."""
    skipped: set[str] = field(default_factory=set)
    """Fields in the record that this version does not have, as `Class.field`."""


def check(
    path: Path,
    report: Callable[[Checked], None] | None = None,
    on_start: Callable[[FlightStart], None] | None = None,
    on_job: OnJob | None = None,
) -> Checked:
    """Run a record's steps again; raises `RecordError` for a file that is no record.

    `on_start` is called with what the record begins with, `on_job` with each job that was run and
    its end.
    """
    with path.open("rb") as file:
        reading = McapReading(file)
        replay = Replay(on_start, on_job)
        reported = 0
        for item in reading.items():
            replay.take(item)
            found = replay.found
            if found.trouble or len(found.differences) >= MOST_DIFFERENCES:
                return found
            if report is not None and found.steps >= reported + REPORT_EVERY_STEPS:
                reported = found.steps
                report(found)
    if replay.found.start is None:
        raise RecordError(f"{path}: expected a flight record of Recon, got another MCAP file")
    replay.found.trouble = reading.trouble
    return replay.found


class Replay:
    """A station that takes recorded events; its state is that of the recorded one."""

    def __init__(
        self,
        on_start: Callable[[FlightStart], None] | None = None,
        on_job: OnJob | None = None,
    ) -> None:
        """Wait for the record's start."""
        self._on_start, self._on_job = on_start, on_job
        self._codec = values_codec()
        self.found = Checked(skipped=self._codec.skipped)
        self.station = Station()
        self._auditing = Auditing()
        self._runner: JobRunner | None = None
        self._jobs: dict[tuple[str, int], AnyJob] = {}
        self._pictures = Pictures()

    def take(self, item: RecordMessage | RecordAttachment) -> None:
        """Take the next item of the file; raises `RecordError` for one that is damaged."""
        if isinstance(item, RecordAttachment):
            if item.name == START_NAME and self.found.start is None:
                self._begin(item.data)
        elif (
            not self._pictures.take(item)
            and item.topic == STEPS_TOPIC
            and self.found.start is not None
        ):
            self._take_step(item)

    def _begin(self, packed: bytes) -> None:
        start = read_start(self._codec, packed)
        self.found.start, self.station, self._auditing = start, start.station, start.auditing
        self._runner = JobRunner(start.site)
        if self._on_start is not None:
            self._on_start(start)

    def _take_step(self, item: RecordMessage) -> None:
        found = self.found
        if item.sequence != found.steps + 1:
            found.trouble = (
                f"steps {found.steps + 1} to {item.sequence - 1} were not recorded: what follows "
                "cannot be compared"
            )
            return
        assert found.start is not None
        found.lasted_s = ns_to_seconds(item.log_ns - found.start.started_at_ns)
        recorded = step_message(item)
        event = self._event(self._codec.from_builtins(recorded["event"], Event))
        if event is None:
            return
        found.steps = item.sequence
        outputs, entries = self._stepped(event, item.log_ns)
        now = _normal({"outputs": outputs, "audit": entries})
        then = {"outputs": self._outputs_of(recorded), "audit": recorded["audit"]}
        for path, was, is_now in differences("", then, now):
            self._note(path, was, is_now, type(event).__name__)

    def _outputs_of(self, recorded: dict[str, Any]) -> Any:
        """Return recorded outputs, a field that they lack at its default."""
        outputs = recorded["outputs"]
        if not isinstance(outputs, list):
            return outputs
        return _normal([output_with_defaults(self._codec, each) for each in outputs])

    def _note(self, path: str, recorded: Any, now: Any, event: str) -> None:
        found = self.found
        found.differences.append(
            Difference(found.steps, found.lasted_s, event, path, recorded, now)
        )

    def _stepped(self, event: Event, now_ns: int) -> tuple[list[Any], list[Any]]:
        before = self.station
        self.station, outputs = _step(before, event, now_ns)
        self._auditing, entries = audit(self._auditing, before, event, self.station, now_ns)
        for output in outputs:
            if isinstance(output, Job):
                self._jobs[output.kind.name, output.id] = output
        return [output_builtins(self._codec, each) for each in outputs], audit_builtins(entries)

    def _event(self, value: Any) -> Event | None:
        """Return the event of a recorded value; None when it cannot be had."""
        if isinstance(value, EndOfJob):
            return self._end_of_job(value)
        if isinstance(value, PacketReceived) and isinstance(value.report, FrameReport):
            picture = self._pictures.get(value.report.frame)
            if picture is None:
                self.found.trouble = (
                    f"step {self.found.steps + 1}: an image was not recorded, for want of space or "
                    "time: what follows cannot be compared"
                )
                return None
            return replace(value, report=report_of(picture, value.report))
        event: Event = value
        return event

    def _end_of_job(self, end: EndOfJob) -> Event | None:
        job = self._jobs.pop((end.kind, end.job_id), None)
        if job is None:
            start = self.found.start
            began_before = start is not None and start.running_jobs > 0
            self.found.trouble = (
                f"step {self.found.steps + 1}: job {end.job_id} ({end.kind[:40]}) has ended, and "
                + (
                    "it was started before this record: what follows cannot be compared"
                    if began_before
                    else "this version has not started it"
                )
            )
            return None
        if end.how not in (DONE, FAILED):
            return JobDropped(job.id, job.kind)
        if end.input and end.input != (now := digest(job.input).hex()):
            self._note("event.input", end.input, now, type(job).__name__)
        if end.how == FAILED:
            return JobFailed(job.id, job.kind, end.error)
        if job.kind.acts:
            return JobDone(job.id, job.kind, None)
        assert self._runner is not None
        self.found.jobs += 1
        ended = self._runner.run(job)
        if self._on_job is not None:
            self._on_job(job, ended)
        return ended


def _step(station: Station, event: Event, now_ns: int) -> Stepped:
    """Take a step as the driver on the real clock does: a fault costs its event only."""
    try:
        return step(station, event, now_ns)
    except Exception as fault:
        return after_fault(TICK_PARTS, station, event, fault, now_ns)


def report_of(image: Picture, report: FrameReport) -> ImageReport:
    """Return the report of a recorded frame; raises `RecordError` for a damaged one."""
    if isinstance(image, CompressedImage):
        return ImageReport(report.target_fps_hz, jpeg=image.data)
    if len(image.data) != 3 * image.width * image.height:
        raise RecordError(f"frame {report.frame} is damaged: its pixels do not fit its size")
    pixels = np.frombuffer(image.data, np.uint8).reshape(image.height, image.width, 3)
    return ImageReport(report.target_fps_hz, rgb=pixels)


def read_start(codec: Codec, packed: bytes) -> FlightStart:
    """Return what a record begins with; raises `RecordError` for a damaged one."""
    try:
        size = zstandard.frame_content_size(packed)
        if not 0 <= size <= MOST_RECORD_BYTES:
            raise RecordError(f"expected a start of up to {MOST_RECORD_BYTES} bytes")
        data = zstandard.ZstdDecompressor().decompress(packed, max_output_size=size)
    except zstandard.ZstdError as problem:
        raise RecordError(f"the record's start is damaged: {problem}") from problem
    start: FlightStart = codec.decode(data, FlightStart)
    return start


def step_message(item: RecordMessage) -> dict[str, Any]:
    """Return event, outputs and audit of a recorded step; raises `RecordError` for damage."""
    try:
        message = msgspec.msgpack.decode(item.data, type=dict[str, Any])
    except (msgspec.MsgspecError, ValueError, RecursionError) as problem:
        raise RecordError(f"step {item.sequence} is damaged: {problem}") from problem
    if message.keys() != {"event", "outputs", "audit"}:
        raise RecordError(f"step {item.sequence} is damaged: it lacks event, outputs or audit")
    return message


def _normal(builtins: Any) -> Any:
    """Return maps and lists as they come back from a file."""
    return msgspec.msgpack.decode(msgspec.msgpack.encode(builtins))


def differences(path: str, recorded: Any, now: Any) -> Iterator[tuple[str, Any, Any]]:
    """Yield the path of each value that differs, with both values."""
    if isinstance(recorded, dict) and isinstance(now, dict):
        for key in [*recorded, *(key for key in now if key not in recorded)]:
            below = f"{path}.{key}" if path else str(key)
            yield from differences(below, recorded.get(key), now.get(key))
    elif isinstance(recorded, list) and isinstance(now, list):
        for index in range(max(len(recorded), len(now))):
            was = recorded[index] if index < len(recorded) else None
            is_now = now[index] if index < len(now) else None
            yield from differences(f"{path}[{index}]", was, is_now)
    elif msgspec.msgpack.encode(recorded) != msgspec.msgpack.encode(now):
        yield path, recorded, now


def _shown(value: Any) -> str:
    if value is None:
        return "nothing"
    text = repr(value)
    return text if len(text) <= 160 else f"{text[:157]}..."
