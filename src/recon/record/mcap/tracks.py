"""Where the vehicles of a flight record were, as GPX, GeoJSON and CSV."""

import csv
import io
import json
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from xml.sax.saxutils import escape

from foxglove_schemas_protobuf.LocationFix_pb2 import LocationFix
from google.protobuf.message import DecodeError

from recon.model.errors import RecordError
from recon.model.units import NS_PER_S
from recon.record.mcap.mcap_read import McapReading, RecordMessage

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


def read_tracks(path: Path) -> Tracks:
    """Return the tracks of a record; raises `RecordError` for a file without one, and OSError."""
    tracks = Tracks()
    with path.open("rb") as file:
        reading = McapReading(file)
        for item in reading.items():
            if isinstance(item, RecordMessage) and item.topic.endswith(SUFFIX):
                name = item.topic.removeprefix(PREFIX).removesuffix(SUFFIX)
                tracks.points.setdefault(name, []).append(_point(item))
    if not tracks.points:
        raise RecordError(f"{path}: expected a record with positions of vehicles, got none")
    tracks.trouble = reading.trouble
    return tracks


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
