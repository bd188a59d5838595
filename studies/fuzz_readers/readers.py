"""The readers that are fuzzed, each with the one kind of error that it documents.

A reader takes the bytes of a file. What is read in a process of its own is read here in this one:
the limits of that process would only hide what goes wrong. NetCDF is not among them: its library
ends the process that reads some files, which is why one of its own does.
"""

import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from pymavlink.dialects.v20 import common as mavlink
from tests.gateway.fleet_state import Stepping
from tests.gateway.test_hostile import HANDLED, packed

from recon.basemap.map_process import OpenMaps
from recon.basemap.web_mercator import MapArea
from recon.camera.errors import FrameDecodeError
from recon.camera.photo_files import photo_size, read_photo
from recon.cli.mission_file import MissionFileError, read_mission
from recon.fields.field_file import _imported, _put_safely
from recon.fields.process import read_documents
from recon.fields.shape import FieldFileError
from recon.gateway.mavlink.frames import FrameReader
from recon.gateway.mavlink.values import Sender
from recon.light.files import read_points
from recon.light.lines import LightLines
from recon.model.errors import ReconError, RecordError, SiteError
from recon.model.geo import GeoPoint, LatLon, LocalFrame
from recon.product.flight_reader import read_flight
from recon.product.photos.photo import read_photo_facts
from recon.product.photos.photo_error import PhotoError
from recon.record.mcap.mcap_read import McapReading
from recon.record.mcap.mcap_repair import repair
from recon.site.geojson import point_of, read_features, regions_of
from recon.site.height_file import opened
from recon.site.load import SITE_FILE, load_site
from recon.site.open_meteo import decoded, hours_of, read_answer
from studies.fuzz_readers import seeds

FRAME = LocalFrame(GeoPoint(41.9012, -93.6034, 275.0))
FIELD = MapArea(((-93.604, 41.900), (-93.600, 41.900), (-93.600, 41.903), (-93.604, 41.903)))
Read = Callable[[bytes, Path], None]
"""Reads bytes; the folder is empty, and may be written to."""


@dataclass(frozen=True, slots=True)
class FuzzedReader:
    """A reader, the errors that it may raise, and valid files for it."""

    read: Read
    errors: tuple[type[ReconError], ...]
    seeds: Callable[[Path], list[bytes]]
    longest_bytes: int = 8_192


def _fields(data: bytes, folder: Path) -> None:
    import os

    documents = _put_safely(data, folder)
    before = Path.cwd()
    os.chdir(folder)
    try:
        answer = read_documents(documents, close_paths=False)
    finally:
        os.chdir(before)
    _imported("file", answer)


def _heights(data: bytes, folder: Path) -> None:
    path = _file(data, folder, "heights.tif")
    with opened(path) as heights:
        rows, cols = min(heights.dataset.height, 64), min(heights.dataset.width, 64)
        heights.heights_m((0, 0), (rows, cols))


def _map(suffix: str) -> Read:
    ring = [list(each) for each in FIELD.ring_deg]

    def read(data: bytes, folder: Path) -> None:
        _file(data, folder, f"a.{suffix}")
        maps = OpenMaps(folder)
        for question in ({"ring": ring}, {"tile": [15, 7865, 12187]}):
            maps.answer({"name": f"a.{suffix}", **question})
        for each in maps._open.values():
            each.close()

    return read


def _photo(data: bytes, folder: Path) -> None:
    read_photo_facts(_file(data, folder, "a.jpg"), "a")


def _pixels(data: bytes, folder: Path) -> None:
    path = _file(data, folder, "a.jpg")
    # The pixels of a large picture are bounded, and take a second.
    if photo_size(path)[0] < 2_000:
        read_photo(path)


def _record(data: bytes, folder: Path) -> None:
    path = _file(data, folder, "a.mcap")
    for _item in McapReading(io.BytesIO(data)).items():
        pass
    repair(path)


def _flight(data: bytes, folder: Path) -> None:
    read_flight(_file(data, folder, "a.mcap"))


def _light_lines(data: bytes, folder: Path) -> None:
    lines = LightLines(FRAME)
    for at in range(0, len(data), 100):
        lines.push(data[at : at + 100], 1_700_000_000_000_000_000)
    lines.taken("fuzzed")


def _light_file(suffix: str) -> Read:
    def read(data: bytes, folder: Path) -> None:
        read_points(_file(data, folder, f"a{suffix}"))

    return read


def _gateway(data: bytes, folder: Path) -> None:
    reader = FrameReader()
    for at in range(0, len(data), 100):
        reader.read(data[at : at + 100])


def _gateway_messages(data: bytes, folder: Path) -> None:
    """Messages that the gateway handles, with right checksums: kind, then payload, and so on."""
    gateway, at = Stepping(), 0
    while at < len(data):
        kind = mavlink.mavlink_map[HANDLED[data[at] % len(HANDLED)]]
        size = kind.unpacker.size
        payload = data[at + 1 : at + 1 + size].ljust(size, b"\0")
        mav = mavlink.MAVLink(None, 255, 190)
        for frame in FrameReader().read(packed(mav, kind, payload)):
            sender = Sender(1 + data[at] // 128, 255, 190)
            gateway.receive(frame.message, sender)
        at += 1 + size
    assert len(gateway.state.uploads) <= 2


def _weather(data: bytes, folder: Path) -> None:
    site = LatLon(41.9012, -93.6034)
    hours_of("weather", read_answer("weather", decoded("weather", data), site))


def _layer(data: bytes, folder: Path) -> None:
    for feature in read_features(_file(data, folder, "layer.geojson")):
        try:
            point_of(feature, FRAME)
        except SiteError:
            regions_of(feature, FRAME)


def _site(data: bytes, folder: Path) -> None:
    load_site(_file(data, folder, SITE_FILE).parent)


def _mission(data: bytes, folder: Path) -> None:
    read_mission(_file(data, folder, "mission.json"), 40.0, 5.0)


def _file(data: bytes, folder: Path, name: str) -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


READERS: Mapping[str, FuzzedReader] = {
    "fields": FuzzedReader(_fields, (FieldFileError, SiteError), seeds.fields),
    "layer": FuzzedReader(_layer, (SiteError,), seeds.layers),
    "site": FuzzedReader(_site, (SiteError,), seeds.sites),
    "mission": FuzzedReader(_mission, (MissionFileError,), seeds.missions),
    "weather": FuzzedReader(_weather, (SiteError,), seeds.weather),
    "heights": FuzzedReader(_heights, (SiteError,), seeds.heights),
    "mbtiles": FuzzedReader(_map("mbtiles"), (), seeds.mbtiles, 65_536),
    "pmtiles": FuzzedReader(_map("pmtiles"), (), seeds.pmtiles),
    "geotiff-map": FuzzedReader(_map("tif"), (), seeds.map_pictures, 65_536),
    "photo": FuzzedReader(_photo, (PhotoError,), seeds.photos, 16_384),
    "pixels": FuzzedReader(_pixels, (FrameDecodeError,), seeds.pictures, 16_384),
    "record": FuzzedReader(_record, (RecordError,), seeds.records, 32_768),
    "flight": FuzzedReader(_flight, (RecordError,), seeds.flights, 131_072),
    "light-lines": FuzzedReader(_light_lines, (), seeds.light_tables),
    "light-csv": FuzzedReader(_light_file(".csv"), (RecordError,), seeds.light_tables),
    "light-npz": FuzzedReader(_light_file(".npz"), (RecordError,), seeds.light_arrays),
    "gateway": FuzzedReader(_gateway, (), seeds.mavlink_frames),
    "gateway-messages": FuzzedReader(_gateway_messages, (), seeds.mavlink_payloads, 2_048),
}
