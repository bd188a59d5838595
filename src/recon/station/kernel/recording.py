"""What a run leaves: every step with its outputs and audit, all link bytes, and topics to look at.

`Recorder` takes steps and bytes from a driver, on its thread, and hands them to the writer's queue;
`RecordTranslator` makes messages of them on the writer's thread.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from recon import version
from recon.link.tap import Direction
from recon.model.command import FlyMission
from recon.model.event import Event, PacketReceived, RecordFailed, Tick
from recon.model.report import CoreReport, ImageReport
from recon.model.shade import ShadeMap, SunForecast
from recon.record import foxglove
from recon.record.audit import AuditEntry
from recon.record.link_bytes import LINKS_TOPIC, LinkMessage
from recon.record.mcap_file import ABOUT_NAME, STEPS_TOPIC, compressor
from recon.record.record_writer import RecordWriter, Topics
from recon.station.kernel.recorded_values import (
    MSGPACK,
    START_NAME,
    START_TYPE,
    FlightStart,
    audit_builtins,
    output_builtins,
    values_codec,
)
from recon.station.state.steps import Job, Output, SendCommand, StepTaken

STEP_BYTES = 1000
"""What a step without pixels holds, more or less."""
JOB_BYTES = 4 * 1024 * 1024
"""What the input of a job of the imaging pipeline holds, more or less."""

_LOG_LEVELS = {"alarm.raised": "warning", "alarm.worse": "error", "order.failed": "error"}


@dataclass(frozen=True, slots=True, eq=False)
class StepItem:
    """One step, as far as it is recorded: not the states, which would keep old images in memory."""

    number: int
    event: Event
    now_ns: int
    outputs: tuple[Output, ...]
    entries: tuple[AuditEntry, ...]
    vehicle: str
    """The vehicle that sent a packet, for its topic; empty without one."""
    shade: ShadeMap | None
    """A new one."""
    sun: SunForecast | None
    with_inputs: bool


@dataclass(frozen=True, slots=True)
class LinkItem:
    """Bytes of one read or one write of a link."""

    link_id: int
    direction: Direction
    data: bytes
    at_ns: int


class Recorder:
    """Takes a driver's steps and its links' bytes; never waits."""

    def __init__(
        self,
        writer: RecordWriter,
        handle: Callable[[Event], None],
        entries_of: Callable[[StepTaken], tuple[AuditEntry, ...]],
    ) -> None:
        """`handle` is the driver's queue, for `RecordFailed`; `entries_of` is asked once a step."""
        self._writer = writer
        self._handle = handle
        self._entries_of = entries_of
        self._reported: str | None = None
        self._step = 0

    def take(self, step: StepTaken) -> None:
        """Record a step; once a tick, report what is not recorded."""
        event, now_ns = step.event, step.now_ns
        entries = self._entries_of(step)
        shade, vehicle = step.after.shade, ""
        is_new = shade.number != step.before.shade.number
        size_bytes, has_room = STEP_BYTES, self._writer.has_room
        if isinstance(event, PacketReceived):
            vehicle = _vehicle_name(step, event.link_id)
            if isinstance(event.report, ImageReport):
                size_bytes += _pixel_bytes(event)
                if not has_room:
                    self._writer.dropped_bytes += _pixel_bytes(event)
                    event, size_bytes = without_pixels(event), STEP_BYTES
        with_inputs = self._writer.has_time
        if with_inputs:
            size_bytes += JOB_BYTES * sum(isinstance(each, Job) for each in step.outputs)
        self._step += 1
        item = StepItem(
            self._step,
            event,
            now_ns,
            step.outputs,
            entries,
            vehicle,
            shade.shade if is_new else None,
            shade.sun if is_new else None,
            with_inputs,
        )
        if not self._writer.put(item, size_bytes):
            self._writer.dropped_steps += 1
        if isinstance(event, Tick) and self._writer.problem != self._reported:
            self._reported = self._writer.problem
            self._handle(RecordFailed(self._reported))

    def tap(self, link_id: int, direction: Direction, data: bytes, at_ns: int) -> None:
        """Record a link's bytes, unless too many wait for the disk."""
        item = LinkItem(link_id, direction, data, at_ns)
        if not self._writer.has_room or not self._writer.put(item, len(data)):
            self._writer.dropped_bytes += len(data)


def without_pixels(event: PacketReceived) -> PacketReceived:
    """Return an image's event without the image."""
    assert isinstance(event.report, ImageReport)
    return replace(event, report=ImageReport(event.report.target_fps_hz))


def _pixel_bytes(event: Event) -> int:
    if not isinstance(event, PacketReceived) or not isinstance(event.report, ImageReport):
        return 0
    rgb, jpeg = event.report.rgb, event.report.jpeg
    return (0 if rgb is None else rgb.nbytes) + (0 if jpeg is None else len(jpeg))


def _vehicle_name(step: StepTaken, link_id: int) -> str:
    vehicle = step.after.fleet.vehicle_of_link(link_id)
    return vehicle.serial if vehicle is not None and vehicle.serial else f"link-{link_id}"


class RecordTranslator:
    """Makes messages of steps and bytes."""

    def __init__(self, start: FlightStart) -> None:
        self._start: FlightStart | None = start
        self._frame = self._event_frame = 0
        self._image_links: set[int] = set()
        self._codec = values_codec(lambda _report: self._event_frame)

    def begin(self, topics: Topics) -> None:
        """Write what a replay starts from, and the same for a person to read."""
        start = self._start
        assert start is not None
        at_ns = start.started_at_ns
        packed = compressor().compress(self._codec.encode(start, FlightStart))
        topics.file.add_attachment(START_NAME, START_TYPE, packed, at_ns)
        about = {
            "version": version(),
            "python": start.python,
            "numpy": np.__version__,
            "machine": start.machine,
            "site": start.site.name,
            "origin": None if start.site.frame is None else asdict(start.site.frame.origin),
            "imagers": list(start.site.imagers),
            "vehicles": {s: each.display_name for s, each in start.site.profiles.items()},
            "settings": asdict(start.station.settings),
        }
        text = msgspec.json.encode(about, enc_hook=str)
        topics.file.add_attachment(ABOUT_NAME, "application/json", text, at_ns)
        self._start = None

    def write(self, item: Any, topics: Topics, *, with_images: bool) -> None:
        """Write one step or the bytes of one read."""
        if isinstance(item, LinkItem):
            self._write_bytes(item, topics, with_images)
        else:
            self._write_step(item, topics, with_images)

    def _write_bytes(self, item: LinkItem, topics: Topics, with_images: bool) -> None:
        is_from_app = item.direction is Direction.FROM_APP
        if not with_images and is_from_app and item.link_id in self._image_links:
            return
        message = LinkMessage(item.link_id, is_from_app, item.data)
        topics.add(LINKS_TOPIC, MSGPACK, msgspec.msgpack.encode(message), item.at_ns)

    def _write_step(self, item: StepItem, topics: Topics, with_images: bool) -> None:
        event = item.event
        self._event_frame = 0
        if isinstance(event, PacketReceived):
            self._write_report(event, item, topics, with_images)
        message = {
            "event": self._codec.to_builtins(event, Event),
            "outputs": [
                output_builtins(self._codec, each, with_input=item.with_inputs)
                for each in item.outputs
            ],
            "audit": audit_builtins(item.entries),
        }
        data = msgspec.msgpack.encode(message)
        topics.add(STEPS_TOPIC, MSGPACK, data, item.now_ns, number=item.number)
        self._write_topics(item, topics)

    def _write_report(
        self, event: PacketReceived, item: StepItem, topics: Topics, with_images: bool
    ) -> None:
        report, place, at_ns = event.report, f"/vehicles/{item.vehicle}", item.now_ns
        if isinstance(report, CoreReport) and report.position is not None:
            fix = foxglove.location(
                report.position, report.reported_altitude_m, item.vehicle, at_ns
            )
            _add(topics, f"{place}/location", fix, at_ns)
        if isinstance(report, ImageReport):
            self._image_links.add(event.link_id)
            if with_images and _pixel_bytes(event):
                self._frame = self._event_frame = self._frame + 1
                self._write_frame(report, item, topics)

    def _write_frame(self, report: ImageReport, item: StepItem, topics: Topics) -> None:
        place, at_ns = f"/vehicles/{item.vehicle}", item.now_ns
        if report.rgb is None:
            jpeg = foxglove.jpeg_image(report.jpeg or b"", item.vehicle, at_ns)
            _add(topics, f"{place}/jpeg", jpeg, at_ns, self._frame)
            return
        topics.add(
            f"{place}/image",
            foxglove.ENCODING,
            foxglove.raw_image_bytes(report.rgb, item.vehicle, at_ns),
            at_ns,
            number=self._frame,
            schema=lambda: foxglove.schema_of(foxglove.RAW_IMAGE),
        )

    def _write_topics(self, item: StepItem, topics: Topics) -> None:
        at_ns = item.now_ns
        for entry in item.entries:
            level = _LOG_LEVELS.get(entry.kind, "info")
            name = entry.vehicle or "station"
            _add(topics, "/log", foxglove.log(entry.text, level, name, at_ns), at_ns)
        for output in item.outputs:
            command = output.approved.command if isinstance(output, SendCommand) else None
            if command is not None and isinstance(command.body, FlyMission):
                path = foxglove.mission_path(command.body.mission, command.serial)
                _add(topics, f"/vehicles/{command.serial}/mission", path, at_ns)
        if item.shade is not None:
            _add(topics, foxglove.SHADE_TOPIC, foxglove.shade_grid(item.shade), at_ns)
        if item.sun is not None:
            _add(topics, "/forecast", foxglove.forecast_grid(item.sun), at_ns)


def _add(topics: Topics, topic: str, message: Any, at_ns: int, number: int | None = None) -> None:
    topics.add(
        topic,
        foxglove.ENCODING,
        message.SerializeToString(),
        at_ns,
        number=number,
        schema=lambda: foxglove.schema_of(message),
    )


def record_writer(folder: Path, start: FlightStart) -> RecordWriter:
    """Return the writer of a run's record into a folder."""
    return RecordWriter(folder, RecordTranslator(start), f"recon {version()}")
