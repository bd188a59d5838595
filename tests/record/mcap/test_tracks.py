"""Tracks of a record: read back by the formats' own rules, compared with what was reported."""

import csv
import io
import json
import math
import xml.etree.ElementTree as ET
from pathlib import Path

import msgspec
import pytest
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.model.errors import RecordError
from recon.model.geo import LatLon
from recon.record.mcap import foxglove
from recon.record.mcap.mcap_file import STEPS_TOPIC, McapFile
from recon.record.mcap.tracks import FORMATS, RecordedPosition, read_tracks, utc_text

AT_NS = 1_780_000_000_123_000_000
PLACES = {
    'A<&"1': [(45.0, -93.0, 300.0), (45.00000001, -93.5, None)],
    "B": [(-45.0, 179.9, 1.5)],
}


@pytest.fixture
def record(tmp_path: Path) -> Path:
    file = McapFile(tmp_path / "a.mcap", "test")
    for name, places in PLACES.items():
        channel = file.add_channel(f"/vehicles/{name}/location", "protobuf")
        for number, (latitude_deg, longitude_deg, height_m) in enumerate(places):
            at_ns = AT_NS + number * 500_000_000
            fix = foxglove.location(LatLon(latitude_deg, longitude_deg), height_m, name, at_ns)
            file.add_message(channel, number, at_ns, fix.SerializeToString())
    file.finish()
    return file.path


def test_tracks_are_read(record: Path) -> None:
    points = read_tracks(record).points
    assert points["B"] == [RecordedPosition(AT_NS, -45.0, 179.9, 1.5)]
    assert math.isnan(points['A<&"1'][1].reported_altitude_m)
    assert utc_text(AT_NS) == "2026-05-28T20:26:40.123Z"


def test_gpx(record: Path) -> None:
    root = ET.fromstring(FORMATS[".gpx"](read_tracks(record).points))
    space = {"g": "http://www.topografix.com/GPX/1/1"}
    assert [each.text for each in root.findall("g:trk/g:name", space)] == list(PLACES)
    found = [(p.get("lat"), p.get("lon")) for p in root.findall(".//g:trkpt", space)]
    assert found[1] == ("45.00000001", "-93.50000000")
    assert root.find(".//g:ele", space) is None


def test_characters_that_xml_cannot_hold_are_replaced() -> None:
    root = ET.fromstring(FORMATS[".gpx"]({"A\x00\x1b": [RecordedPosition(AT_NS, 1.0, 2.0, 3.0)]}))
    assert root.findtext(".//{*}name") == "A\ufffd\ufffd"


def test_geojson(record: Path) -> None:
    first, second = json.loads(FORMATS[".geojson"](read_tracks(record).points))["features"]
    assert first["properties"]["serial"] == 'A<&"1'
    assert first["geometry"]["coordinates"] == [[-93.0, 45.0], [-93.5, 45.00000001]]
    assert first["properties"]["utc"][1] == "2026-05-28T20:26:40.623Z"
    assert second["geometry"]["coordinates"] == [[179.9, -45.0]] * 2


def test_csv(record: Path) -> None:
    rows = list(csv.DictReader(io.StringIO(FORMATS[".csv"](read_tracks(record).points))))
    assert [(row["serial"], row["reported_altitude_m"]) for row in rows] == [
        ('A<&"1', "300.000"),
        ("B", "1.500"),
        ('A<&"1', ""),
    ]


def test_the_command_writes_and_replaces_nothing(record: Path, tmp_path: Path) -> None:
    out = tmp_path / "tracks.gpx"
    ended = CliRunner().invoke(app, ["export", str(record), str(out)])
    assert ended.exit_code == 0
    assert "B: 1 positions" in ended.output
    before = out.read_bytes()
    ended = CliRunner().invoke(app, ["export", str(record), str(out)])
    assert ended.exit_code == 2
    assert "exists" in ended.stderr
    assert out.read_bytes() == before
    assert CliRunner().invoke(app, ["export", str(record), "x.shp"]).exit_code == 2


def test_a_record_without_positions_is_refused(tmp_path: Path) -> None:
    file = McapFile(tmp_path / "a.mcap", "test")
    file.finish()
    with pytest.raises(RecordError, match="expected a record with positions"):
        read_tracks(file.path)


def test_a_link_has_the_name_that_its_vehicle_turned_out_to_have(tmp_path: Path) -> None:
    """Positions come before serials; another link never becomes a vehicle."""
    file = McapFile(tmp_path / "a.mcap", "test")
    steps = file.add_channel(STEPS_TOPIC, "msgpack")
    rows = (("link-1", 1), ("link-2", 2), ("A", 1), ("link-2", 2), ("A", 1))
    topics = {name: file.add_channel(f"/vehicles/{name}/location", "protobuf") for name, _ in rows}
    for number, (name, link_id) in enumerate(rows):
        fix = foxglove.location(LatLon(45.0, float(number)), None, name, number)
        file.add_message(topics[name], number, number, fix.SerializeToString())
        step = msgspec.msgpack.encode({"event": {"is": "PacketReceived", "link_id": link_id}})
        file.add_message(steps, number, number, step)
    file.finish()
    points = read_tracks(file.path).points
    found = {name: [p.longitude_deg for p in track] for name, track in points.items()}
    assert found == {"A": [0.0, 2.0, 4.0], "link-2": [1.0, 3.0]}
