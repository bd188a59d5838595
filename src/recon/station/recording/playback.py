"""A recorded flight for the screens: the station as it was at any moment of its record.

The state at a moment is the keyframe before it, and the recorded events since then through the same
pure step. Outputs are thrown away; there is no link, no worker and no audit, so nothing can be sent
or written. Jobs are not run: what they gave comes with the next keyframe, within two seconds.
`replay.check` runs them, and compares every output.
"""

import json
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from threading import RLock
from typing import Any

from recon.camera.decode import decode_frame
from recon.camera.ground import GroundProjector
from recon.model.errors import ReconError, RecordError
from recon.model.event import Event, PacketReceived
from recon.model.imagery import Frame, GroundImage
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.record.mcap.codec import CodecError
from recon.record.mcap.flight_messages import START_NAME
from recon.record.mcap.foxglove import SHADE_TOPIC, SUN_TOPIC
from recon.record.mcap.link_bytes import Pictures
from recon.record.mcap.mcap_file import ABOUT_NAME, KEYFRAMES_TOPIC, STEPS_TOPIC
from recon.record.mcap.mcap_read import RecordMessage
from recon.record.mcap.record_file import RecordFile
from recon.station.kernel.step import step
from recon.station.recording.keyframe import (
    KEYFRAME_S,
    MapFacts,
    MapMessages,
    maps_of,
    read_keyframe,
    restored,
)
from recon.station.recording.recorded_values import (
    EndOfJob,
    FlightStart,
    FrameReport,
    values_codec,
)
from recon.station.recording.replay import read_start, report_of, step_message
from recon.station.state.station import Station

STEPS_AHEAD_NS = seconds_to_ns(1.25 * KEYFRAME_S)
"""Distance ahead beyond which a keyframe is nearer than the present state."""
LONGEST_NS = seconds_to_ns(14 * 86_400.0)
LATE_NS = seconds_to_ns(5.0)
"""Time from a capture within which its frame is projected, or its map recorded."""


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """The station as it was at a moment of the record."""

    station: Station
    at_ns: int


class Playback:
    """A record's states by time. Safe on several threads: one call runs at a time."""

    def __init__(self, path: Path) -> None:
        """Open a record at its beginning.

        Raises OSError, and `RecordError` for a file that is no record or cannot be replayed.
        """
        self._file = RecordFile(path)
        self._lock = RLock()
        self._codec = values_codec()
        try:
            self.start = self._read_start()
            self.begins_ns = self.start.started_at_ns
            self.ends_ns = max(self.begins_ns, self._file.last_ns)
            self._require_playable(self.ends_ns - self.begins_ns)
        except BaseException:
            self._file.close()
            raise
        images = {t for t in self._file.topics if t.endswith(("/image", "/jpeg"))}
        self._played_topics = {STEPS_TOPIC, KEYFRAMES_TOPIC, SHADE_TOPIC, SUN_TOPIC, *images}
        self._projector: tuple[str, GroundProjector] | None = None
        self._projected: GroundImage | None = None
        self._is_astray = False
        """Whether a move ended at damage: what comes after it in the file is not the next event."""
        self._begin()
        self.moment = Moment(self._station, self.begins_ns)

    @property
    def trouble(self) -> str:
        """Why the file ends early; empty if it does not."""
        return self._file.trouble

    @property
    def skipped(self) -> list[str]:
        """Fields in what was read that this version does not have, as `Class.field`."""
        return sorted(self._codec.skipped)

    def close(self) -> None:
        """Close the file."""
        with self._lock:
            self._file.close()

    def move(self, to_ns: int, *, is_exact: bool = True) -> Moment:
        """Go to a moment, forwards or back, and return it.

        Without `is_exact` it may stop at the keyframe before: so it plays faster than a computer
        steps. Raises `RecordError` where the file is damaged.
        """
        with self._lock:
            to_ns = min(max(to_ns, self.begins_ns), self.ends_ns)
            ahead_ns, before_ns = to_ns - self._at_ns, self._at_ns
            is_far, self._is_astray = self._is_astray or ahead_ns < 0, True
            if is_far or ahead_ns > STEPS_AHEAD_NS:
                self._seek(to_ns)
            if is_exact or self._at_ns <= before_ns:
                self._play(to_ns)
            self._is_astray = False
            self.moment = Moment(self._station, self._at_ns)
            return self.moment

    def frame(self, newest: Frame | None) -> Frame | None:
        """Return a frame of the state with its pixels; None if they were not recorded."""
        if newest is None or newest.rgb is not None or newest.jpeg is not None:
            return newest
        topics = {f"/vehicles/{newest.serial}/{kind}" for kind in ("image", "jpeg")}
        with self._lock, suppress(RecordError):
            for item in self._messages_at(newest.received_at_ns, topics):
                report = self._picture(item)
                return replace(newest, rgb=report.rgb, jpeg=report.jpeg)
        return None

    def projected(self, image: GroundImage) -> GroundImage | None:
        """Return a ground image of the state with its pixels: its frame, projected again."""
        with self._lock:
            kept = self._projected
            if kept is None or (kept.serial, kept.frame_id) != (image.serial, image.frame_id):
                kept = self._projected = self._project(image)
        if kept is None:
            return None
        return replace(image, rgb=kept.rgb, valid=kept.valid)

    def _project(self, image: GroundImage) -> GroundImage | None:
        site, imager = self.start.site, self.start.site.imagers.get(image.serial)
        grid, profile = site.ground_grid, site.profiles.get(image.serial)
        if imager is None or grid is None:
            return None
        latency_ns = 0 if profile is None else seconds_to_ns(profile.video_latency_s)
        at_ns = image.captured_at_ns
        newest = Frame(image.frame_id, image.serial, at_ns + latency_ns, at_ns, 0.0)
        frame = self.frame(newest)
        if frame is None:
            return None
        if self._projector is None or self._projector[0] != image.serial:
            projector = GroundProjector(grid, imager.camera, imager.image_circle)
            self._projector = image.serial, projector
        with suppress(ReconError, ValueError):
            return self._projector[1].project_decoded(frame, decode_frame(frame), image.pose)
        return None

    def _read_start(self) -> FlightStart:
        path, found = self._file.path, self._file.attachments
        if START_NAME not in found:
            raise RecordError(f"{path}: expected a flight record of Recon, got another MCAP file")
        packed = found[START_NAME].data
        if not packed:
            raise RecordError(f"{path}: the record has no first state: it cannot be replayed")
        try:
            return read_start(self._codec, packed)
        except CodecError as problem:
            raise RecordError(
                f"{path}: {self._versions()} cannot be replayed by this one: {problem}"
            ) from problem

    def _versions(self) -> str:
        with suppress(KeyError, ValueError, TypeError, RecursionError):
            about = json.loads(self._file.attachments[ABOUT_NAME].data)
            return f"a record of version {about['version']!s:.40}"
        return "a record of another version"

    def _require_playable(self, lasts_ns: int) -> None:
        if STEPS_TOPIC not in self._file.topics:
            raise RecordError(f"{self._file.path}: the record ends before its first event")
        if lasts_ns > LONGEST_NS:
            raise RecordError(f"{self._file.path}: the record is damaged: it lasts for weeks")
        if KEYFRAMES_TOPIC not in self._file.topics and lasts_ns > STEPS_AHEAD_NS:
            raise RecordError(
                f"{self._file.path}: {self._versions()} has no keyframes for the console; recon "
                "replay --check reads it"
            )

    def _begin(self, first: int = 0) -> None:
        """Go to the file's first state, or before a chunk of it."""
        self._items = self._file.messages(first, None, self._played_topics)
        self._next: RecordMessage | None = None
        self._pictures = Pictures()
        self._newest: dict[str, RecordMessage] = {}
        self._maps_at_ns: int | None = None
        self._station, self._at_ns = self.start.station, self.begins_ns

    def _seek(self, to_ns: int) -> None:
        """Go to the last keyframe up to a moment, at the file's beginning without one."""
        last = self._file.chunk_before(to_ns)
        first = min(last, self._file.chunk_reaching(to_ns - STEPS_AHEAD_NS))
        while True:
            found = None
            for number in range(first, last + 1):
                for item in self._file.messages(number, number + 1, {KEYFRAMES_TOPIC}):
                    if item.log_ns <= to_ns:
                        found = number, item.log_ns, item.sequence
            if found is not None or first == 0:
                break
            last, first = first - 1, max(0, first - 2 * (last - first + 1))
        if found is None:
            self._begin()
            return
        number, at_ns, sequence = found
        self._begin(number)
        for item in self._items:
            if item.topic == KEYFRAMES_TOPIC and (item.log_ns, item.sequence) == (at_ns, sequence):
                self._apply(item)
                break
            self._note(item)
        self._at_ns = at_ns

    def _play(self, to_ns: int) -> None:
        """Step through the events up to a moment."""
        while (item := self._next or next(self._items, None)) is not None:
            self._next = item
            if item.log_ns > to_ns:
                break
            self._apply(item)
            self._next = None
        self._at_ns = to_ns

    def _note(self, item: RecordMessage) -> None:
        """Keep a frame or a map for the events and keyframes behind it."""
        if item.topic in (SHADE_TOPIC, SUN_TOPIC):
            self._newest[item.topic] = item
        else:
            self._pictures.take(item)

    def _apply(self, item: RecordMessage) -> None:
        if item.topic == KEYFRAMES_TOPIC:
            self._station = self._keyframe_station(item)
        elif item.topic != STEPS_TOPIC:
            self._note(item)
        else:
            event = self._event(item)
            if event is not None:
                # The state between keyframes lacks what jobs gave. An event that it cannot take
                # is excluded: the next keyframe has what it did.
                with suppress(Exception):
                    self._station, _ = step(self._station, event, item.log_ns)

    def _event(self, item: RecordMessage) -> Event | None:
        value: Any = self._codec.from_builtins(step_message(item)["event"], Event)
        if isinstance(value, EndOfJob):
            return None
        if isinstance(value, PacketReceived) and isinstance(value.report, FrameReport):
            picture = self._pictures.get(value.report.frame)
            if picture is None:
                return None
            return replace(value, report=report_of(picture, value.report))
        event: Event = value
        return event

    def _keyframe_station(self, item: RecordMessage) -> Station:
        keyframe, maps = read_keyframe(self._codec, item.data), None
        facts, frame = keyframe.maps, self.start.site.frame
        if facts is not None and frame is not None:
            line = self._station.shade
            if facts.at_ns == self._maps_at_ns and line.shade is not None:
                maps = line.shade, line.sun
            elif (recorded := self._recorded_maps(facts)) is not None:
                maps = maps_of(recorded, facts, frame)
                self._maps_at_ns = facts.at_ns
        return restored(keyframe, self.start.station, maps)

    def _recorded_maps(self, facts: MapFacts) -> MapMessages | None:
        """Return the messages of a moment's maps, from behind if they were not passed."""
        found = self._newest
        if SHADE_TOPIC not in found or found[SHADE_TOPIC].log_ns != facts.at_ns:
            topics = (SHADE_TOPIC, SUN_TOPIC)
            found = {each.topic: each for each in self._messages_at(facts.at_ns, topics)}
        shade, sun = found.get(SHADE_TOPIC), found.get(SUN_TOPIC)
        if shade is None:
            return None
        is_same = sun is not None and sun.log_ns == facts.at_ns
        return MapMessages(shade.data, sun.data if sun is not None and is_same else None)

    def _messages_at(self, at_ns: int, topics: Any) -> Iterator[RecordMessage]:
        first = self._file.chunk_reaching(at_ns)
        past = 1 + max(first, self._file.chunk_before(at_ns + LATE_NS))
        for item in self._file.messages(first, past, topics):
            if item.log_ns == at_ns:
                yield item

    def _picture(self, item: RecordMessage) -> Any:
        pictures = Pictures()
        pictures.take(item)
        picture = pictures.get(item.sequence)
        assert picture is not None
        return report_of(picture, FrameReport(None, item.sequence))
