"""Where the vehicles of a flight record were, as GPX, GeoJSON and CSV."""

import csv
import io
import json
import math
import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from xml.sax.saxutils import escape

import msgspec
from foxglove_schemas_protobuf.LocationFix_pb2 import LocationFix
from google.protobuf.message import DecodeError

from recon.model.errors import RecordError
from recon.model.units import NS_PER_S
from recon.record.mcap.mcap_file import STEPS_TOPIC
from recon.record.mcap.mcap_read import McapReading, Opener, RecordMessage, opened

LINK_NAME = re.compile(r"link-\d+")
PREFIX, SUFFIX = "/vehicles/", "/location"


@dataclass(frozen=True, slots=True)
class RecordedPosition:
    """One reported position; the altitude is the app's own, NaN where it reported none."""

    at_ns: int
    latitude_deg: float
    longitude_deg: float
    reported_altitude_m: float


@dataclass(slots=True)
class Tracks:
    """The positions of each vehicle by serial, and why reading ended early; empty if it did not."""

    points: dict[str, list[RecordedPosition]] = field(default_factory=dict)
    trouble: str = ""


def read_tracks(path: Path, open_record: Opener = opened) -> Tracks:
    """Return the tracks of a record; raises `RecordError` for a file without one, and OSError."""
    tracks, names = Tracks(), _LinkNames()
    with open_record(path) as file:
        reading = McapReading(file)
        for item in reading.items():
            if not isinstance(item, RecordMessage):
                continue
            names.take(item)
            if item.topic.endswith(SUFFIX):
                tracks.points.setdefault(_name_of(item), []).append(_point(item))
    tracks.points = names.named(tracks.points)
    if not tracks.points:
        raise RecordError(f"{path}: expected a record with positions of vehicles, got none")
    tracks.trouble = reading.trouble
    return tracks


class _PacketEvent(msgspec.Struct, frozen=True):
    link_id: int | None = None


class _PacketStep(msgspec.Struct, frozen=True):
    event: _PacketEvent


class _LinkNames:
    """Which vehicle each link turned out to be: its first packets came before its serial did.

    A packet's position is recorded right before its step, at the same time.
    """

    def __init__(self) -> None:
        self._unnamed: set[str] = set()
        self._serials: dict[str, str] = {}
        self._newest: RecordMessage | None = None

    def take(self, item: RecordMessage) -> None:
        """Take the next message of the record."""
        newest, self._newest = self._newest, item if item.topic.endswith(SUFFIX) else None
        if newest is None or item.topic != STEPS_TOPIC or item.log_ns != newest.log_ns:
            return
        name = _name_of(newest)
        if LINK_NAME.fullmatch(name):
            self._unnamed.add(name)
        elif len(self._serials) < len(self._unnamed):
            with suppress(msgspec.MsgspecError):
                link_id = msgspec.msgpack.decode(item.data, type=_PacketStep).event.link_id
                if (link := f"link-{link_id}") in self._unnamed:
                    self._serials[link] = name

    def named(
        self, points: Mapping[str, list[RecordedPosition]]
    ) -> dict[str, list[RecordedPosition]]:
        """Return tracks by serial; a link that never became a vehicle keeps its own name."""
        found: dict[str, list[RecordedPosition]] = {}
        for name, track in points.items():
            found.setdefault(self._serials.get(name, name), []).extend(track)
        return {name: sorted(track, key=lambda point: point.at_ns) for name, track in found.items()}


def _name_of(item: RecordMessage) -> str:
    return item.topic.removeprefix(PREFIX).removesuffix(SUFFIX)


def _point(item: RecordMessage) -> RecordedPosition:
    try:
        fix = LocationFix.FromString(item.data)
    except DecodeError as problem:
        raise RecordError(f"a position of {item.topic} is damaged: {problem}") from problem
    return RecordedPosition(item.log_ns, fix.latitude, fix.longitude, fix.altitude)


def utc_text(at_ns: int) -> str:
    """Return a time as ISO 8601 in UTC, to the millisecond."""
    whole = datetime.fromtimestamp(at_ns // NS_PER_S, UTC)
    return f"{whole:%Y-%m-%dT%H:%M:%S}.{at_ns % NS_PER_S // 1_000_000:03d}Z"


NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML cannot hold, not even escaped."""


def xml_text(text: str) -> str:
    """Return a text for the inside of an XML element."""
    return escape(NO_XML.sub("\ufffd", text))


def gpx(points: Mapping[str, list[RecordedPosition]]) -> str:
    """Return a track for each vehicle; without elevations, whose datum no app states."""
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<gpx version="1.1" creator="Recon" xmlns="http://www.topografix.com/GPX/1/1">',
    ]
    for name, track in points.items():
        lines.append(f"<trk><name>{xml_text(name)}</name><trkseg>")
        lines += (
            f'<trkpt lat="{p.latitude_deg:.8f}" lon="{p.longitude_deg:.8f}">'
            f"<time>{utc_text(p.at_ns)}</time></trkpt>"
            for p in track
        )
        lines.append("</trkseg></trk>")
    return "\n".join((*lines, "</gpx>", ""))


def geojson(points: Mapping[str, list[RecordedPosition]]) -> str:
    """Return a line for each vehicle, with the time of each of its points."""
    features = [
        {
            "type": "Feature",
            "properties": {"serial": name, "utc": [utc_text(p.at_ns) for p in track]},
            "geometry": {
                "type": "LineString",
                # A line has two points at least.
                "coordinates": [
                    [p.longitude_deg, p.latitude_deg]
                    for p in (track * 2 if len(track) == 1 else track)
                ],
            },
        }
        for name, track in points.items()
    ]
    return json.dumps({"type": "FeatureCollection", "features": features}) + "\n"


def csv_text(points: Mapping[str, list[RecordedPosition]]) -> str:
    """Return a row for each position, in the order of time."""
    out = io.StringIO()
    rows = csv.writer(out, lineterminator="\n")
    rows.writerow(("utc", "serial", "latitude_deg", "longitude_deg", "reported_altitude_m"))
    every = sorted(
        ((point, name) for name, track in points.items() for point in track),
        key=lambda row: (row[0].at_ns, row[1]),
    )
    for p, name in every:
        altitude = "" if math.isnan(p.reported_altitude_m) else f"{p.reported_altitude_m:.3f}"
        place = (f"{p.latitude_deg:.8f}", f"{p.longitude_deg:.8f}")
        rows.writerow((utc_text(p.at_ns), name, *place, altitude))
    return out.getvalue()


FORMATS: Mapping[str, Callable[[Mapping[str, list[RecordedPosition]]], str]] = {
    ".gpx": gpx,
    ".geojson": geojson,
    ".csv": csv_text,
}
"""Formats by the extension of the file to write."""
