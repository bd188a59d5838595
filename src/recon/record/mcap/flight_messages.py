"""The messages of a record, made of the items that the station hands over.

A step comes encoded; what a person looks at, the topics in Foxglove's schemas, is made of it here,
in the writer's process.
"""

from collections.abc import Iterable, Mapping
from typing import Any

import msgspec

from recon import wire
from recon.model.geo import LatLon
from recon.model.mission import Mission
from recon.model.shade import ShadeMap, SunForecast
from recon.record.mcap import foxglove
from recon.record.mcap.codec import TAG, Codec
from recon.record.mcap.items import (
    BULK_BYTES,
    LINK_HEAD,
    STEP_HEAD,
    Beginning,
    Item,
    ItemKind,
    TimedValue,
)
from recon.record.mcap.link_bytes import (
    LINKS_TOPIC,
    FrameBytes,
    LinkMessage,
    LinkStream,
    PlainBytes,
)
from recon.record.mcap.mcap_file import ABOUT_NAME, KEYFRAMES_TOPIC, STEPS_TOPIC
from recon.record.mcap.topics import Topics

START_NAME = "recon/start"
START_TYPE = "application/vnd.recon.start+zstd"
MSGPACK = "msgpack"

MOST_HELD_BYTES = 256 * 1024**2
"""Limit of all links with incomplete packets: ten of the largest images."""


class FlightMessages:
    """Makes the messages of a record of items."""

    def __init__(self) -> None:
        self._streams: dict[int, LinkStream] = {}
        self._names: dict[int, str] = {}
        self._frame = 0
        self._latest_ns = 0
        self._codec = Codec()

    def begin(self, item: Item, topics: Topics) -> None:
        """Write what a replay starts from, and the same for a person to read."""
        begins = msgspec.msgpack.decode(item.content, type=Beginning)
        topics.file.add_attachment(START_NAME, START_TYPE, begins.start, begins.at_ns)
        topics.file.add_attachment(ABOUT_NAME, "application/json", begins.about, begins.at_ns)
        self._frame = 0

    def write(self, item: Item, topics: Topics, *, with_images: bool) -> None:
        """Write one item."""
        content = item.content
        match item.kind:
            case ItemKind.LINK:
                self._write_bytes(content, topics, with_images)
            case ItemKind.STEP:
                self._write_step(content, topics, with_images)
            case ItemKind.SHADE | ItemKind.SUN:
                self._write_map(item, topics)
            case ItemKind.KEYFRAME:
                number, at_ns, _name_bytes = STEP_HEAD.unpack_from(content)
                data = content[STEP_HEAD.size :]
                topics.add(KEYFRAMES_TOPIC, MSGPACK, data, at_ns, number=number)

    def flush(self, topics: Topics, *, with_images: bool) -> None:
        """Write bytes that have waited too long for the end of their packet."""
        for link_id, stream in self._streams.items() if with_images else ():
            self._write_parts(link_id, stream.overdue(self._latest_ns), topics, with_images)
        while sum(each.held_bytes for each in self._streams.values()) > MOST_HELD_BYTES:
            link_id, stream = max(self._streams.items(), key=lambda each: each[1].held_bytes)
            self._write_parts(link_id, stream.forget(), topics, with_images)

    def finish(self, topics: Topics, *, with_images: bool) -> None:
        """Write what still waits: the file ends."""
        for link_id, stream in self._streams.items():
            self._write_parts(link_id, stream.rest(), topics, with_images)

    def _write_bytes(self, content: bytes, topics: Topics, with_images: bool) -> None:
        link_id, is_from_app, at_ns, start = LINK_HEAD.unpack_from(content)
        data = content[LINK_HEAD.size :]
        self._latest_ns = at_ns
        if not is_from_app:
            message = LinkMessage(link_id, False, data)
            topics.add(LINKS_TOPIC, MSGPACK, msgspec.msgpack.encode(message), at_ns)
            return
        stream = self._streams.setdefault(link_id, LinkStream())
        self._write_parts(link_id, stream.take(start, data, at_ns), topics, with_images)

    def _write_parts(
        self,
        link_id: int,
        parts: Iterable[PlainBytes | FrameBytes],
        topics: Topics,
        with_images: bool,
    ) -> int:
        """Write bytes of a link; return the number of the frame in them, 0 without one."""
        number = 0
        for part in parts:
            if isinstance(part, FrameBytes):
                if with_images:
                    number = self._frame = self._frame + 1
                    self._write_frame(self._names.get(link_id, f"link-{link_id}"), part, topics)
                    message = LinkMessage(link_id, True, part.around, number, part.skip, part.lost)
                else:
                    message = LinkMessage(
                        link_id, True, b"", lost=part.lost + part.size_bytes - part.skip
                    )
            elif with_images or len(part.data) < BULK_BYTES:
                message = LinkMessage(link_id, True, part.data, lost=part.lost)
            else:
                message = LinkMessage(link_id, True, b"", lost=part.lost + len(part.data))
            topics.add(LINKS_TOPIC, MSGPACK, msgspec.msgpack.encode(message), part.at_ns)
        return number

    def _write_frame(self, vehicle: str, frame: FrameBytes, topics: Topics) -> None:
        at_ns, packet = frame.at_ns, frame.packet
        if isinstance(packet, wire.CompressedImage):
            jpeg = foxglove.jpeg_image(packet.jpeg, vehicle, at_ns)
            _add(topics, foxglove.vehicle_topic(vehicle, "jpeg"), jpeg, at_ns, self._frame)
            return
        topics.add(
            foxglove.vehicle_topic(vehicle, "image"),
            foxglove.ENCODING,
            foxglove.raw_image_bytes(packet.pixels, vehicle, at_ns),
            at_ns,
            number=self._frame,
            schema=lambda: foxglove.schema_of(foxglove.RAW_IMAGE),
        )

    def _write_step(self, content: bytes, topics: Topics, with_images: bool) -> None:
        number, at_ns, name_bytes = STEP_HEAD.unpack_from(content)
        at = STEP_HEAD.size + name_bytes
        vehicle, data = content[STEP_HEAD.size : at].decode(), content[at:]
        self._latest_ns = at_ns
        message = msgspec.msgpack.decode(data)
        event = message["event"]
        if event[TAG] == "PacketReceived":
            self._names[event["link_id"]] = vehicle
            number_of_frame = self._write_packet(event, at_ns, topics, with_images)
            if event["report"][TAG] == "ImageReport":
                event["report"]["frame"] = number_of_frame
                data = msgspec.msgpack.encode(message)
            elif event["report"][TAG] == "CoreReport":
                _add_location(topics, event["report"], vehicle, at_ns)
        elif event[TAG] == "LinkClosed":
            self._names.pop(event["link_id"], None)
            rest = self._streams.pop(event["link_id"], LinkStream()).rest()
            self._write_parts(event["link_id"], rest, topics, with_images)
        topics.add(STEPS_TOPIC, MSGPACK, data, at_ns, number=number)
        _add_log(topics, message["audit"], at_ns)
        self._add_missions(topics, message["outputs"], at_ns)

    def _write_packet(
        self, event: Mapping[str, Any], at_ns: int, topics: Topics, with_images: bool
    ) -> int:
        """Write the bytes of a packet; return the number of its frame, 0 without one."""
        stream = self._streams.get(event["link_id"])
        if stream is None:
            return 0
        parts: Iterable[PlainBytes | FrameBytes] = stream.packet(event["stream_end"])
        if event["report"][TAG] == "ImageReport":
            arrived_at_ns = event["arrived_at_ns"]
            came_ns = at_ns if arrived_at_ns is None else arrived_at_ns
            parts = stream.image(event["stream_start"], event["stream_end"], came_ns)
        return self._write_parts(event["link_id"], parts, topics, with_images)

    def _add_missions(self, topics: Topics, outputs: Iterable[Any], at_ns: int) -> None:
        for output in outputs:
            command = output["send"]["command"] if "send" in output else None
            if command is not None and command["body"].get(TAG) == "FlyMission":
                mission = self._codec.from_builtins(command["body"]["mission"], Mission)
                path = foxglove.mission_path(mission, command["serial"])
                topic = foxglove.vehicle_topic(command["serial"], "mission")
                _add(topics, topic, path, at_ns)

    def _write_map(self, item: Item, topics: Topics) -> None:
        found = msgspec.msgpack.decode(item.content, type=TimedValue)
        if item.kind is ItemKind.SHADE:
            shade = self._codec.from_builtins(found.value, ShadeMap)
            _add(topics, foxglove.SHADE_TOPIC, foxglove.shade_grid(shade), found.at_ns)
        else:
            sun = self._codec.from_builtins(found.value, SunForecast)
            _add(topics, foxglove.SUN_TOPIC, foxglove.forecast_grid(sun), found.at_ns)


def _add_location(topics: Topics, core: Mapping[str, Any], vehicle: str, at_ns: int) -> None:
    place = core["position"]
    if place is not None:
        point = LatLon(place["latitude_deg"], place["longitude_deg"])
        fix = foxglove.location(point, core["reported_altitude_m"], vehicle, at_ns)
        _add(topics, foxglove.vehicle_topic(vehicle, "location"), fix, at_ns)


def _add_log(topics: Topics, entries: Iterable[Mapping[str, Any]], at_ns: int) -> None:
    for entry in entries:
        line = foxglove.audit_log(entry["kind"], entry["text"], entry["vehicle"], at_ns)
        _add(topics, foxglove.LOG_TOPIC, line, at_ns)


def _add(topics: Topics, topic: str, message: Any, at_ns: int, number: int | None = None) -> None:
    topics.add(
        topic,
        foxglove.ENCODING,
        message.SerializeToString(),
        at_ns,
        number=number,
        schema=lambda: foxglove.schema_of(message),
    )
