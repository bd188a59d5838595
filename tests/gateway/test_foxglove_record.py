"""Live topics beside the record of the same flight: the same schemas, the same values."""

import json
from pathlib import Path
from typing import Any

import numpy as np
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.GeoJSON_pb2 import GeoJSON
from foxglove_schemas_protobuf.LocationFix_pb2 import LocationFix
from foxglove_schemas_protobuf.Log_pb2 import Log
from tests.client.running_station import HOME, running_station
from tests.gateway.foxglove_client import FoxgloveClient, foxglove_client, running_foxglove
from tests.gateway.recorded_station import Message, RecordedStation
from tests.patient_loop import run_patiently

from recon.client import Mission, Order, Station, Waypoint
from recon.model.geo import LocalFrame
from recon.sim.app.camera_feed import FeedSettings, ImageFormat
from recon.sim.camera.frames import StillFrame
from recon.sim.fleet import IMAGER_SERIAL, ImagerSetup

PICTURE = np.random.default_rng(1).integers(0, 256, (36, 64, 3)).astype(np.uint8)
IMAGER = ImagerSetup(StillFrame(PICTURE), FeedSettings(5.0, ImageFormat.JPEG, latency_s=0.05))
LOCATION, MISSION = "/vehicles/SIM-1/location", "/vehicles/SIM-1/mission"
FRAMES = f"/vehicles/{IMAGER_SERIAL}/jpeg"
MS = 1_000_000


def test_live_topics_are_those_of_the_flights_record(tmp_path: Path) -> None:
    recorded = RecordedStation(tmp_path)

    async def main() -> FoxgloveClient:
        imagers = {IMAGER_SERIAL: IMAGER}
        async with (
            running_station(imagers=imagers, kept=recorded.attach) as url,
            running_foxglove(url) as running,
            foxglove_client(running.port) as client,
        ):
            await client.until(LOCATION, 5)
            await client.until("/log")
            await fly(running.station)
            await client.until(MISSION)
            await client.until(FRAMES, 3)
            recorded.detect(LocalFrame(HOME))
            await client.until("/shade")
            await client.until("/forecast")
            return client

    live = run_patiently(main())
    record = recorded.read()
    for topic in (LOCATION, MISSION, FRAMES, "/shade", "/forecast", "/log"):
        assert live.schema(topic) == record[topic][0][:3], topic
        made = [(each.at_ns, each.data) for each in live.received[topic]]
        assert made
        same(topic, made, record[topic])


async def fly(station: Station) -> None:
    corners = [(41.9015, -93.6034), (41.9019, -93.6030), (41.9015, -93.6026)]
    mission = Mission(tuple(Waypoint(*corner, 40.0, 5.0) for corner in corners))
    order = await station.known("SIM-1").fly(mission)
    assert isinstance(order, Order)


def same(topic: str, live: list[tuple[int, bytes]], record: list[Message]) -> None:
    """Every live message is in the record: to the API's digits, and to the bit without any."""
    known = [row[4] for row in record]
    match topic.rpartition("/")[2]:
        case "location":
            fixes = [(place(LocationFix.FromString(row[4])), row[3]) for row in record]
            for at_ns, data in live:
                wanted = place(LocationFix.FromString(data))
                # Taken when it arrived, recorded with the step that came of it.
                late_ns = [step_ns - at_ns for each, step_ns in fixes if each == wanted]
                assert any(-MS <= late < 10_000 * MS for late in late_ns), (wanted, late_ns)
        case "mission":
            lines = [json.loads(GeoJSON.FromString(data).geojson) for data in known]
            assert all(json.loads(GeoJSON.FromString(data).geojson) in lines for _, data in live)
        case "jpeg":
            pictures = [image(data) for data in known]
            assert all(image(data) in pictures for _, data in live)
        case "log":
            lines = [line(data) for data in known]
            assert all(line(data) in lines for _, data in live)
        case _:
            assert all(data in known for _, data in live)


def place(fix: Any) -> tuple[str, float, float, float]:
    """What a location says, with the digits that the API keeps."""
    return fix.frame_id, round(fix.latitude, 8), round(fix.longitude, 8), round(fix.altitude, 3)


def image(data: bytes) -> tuple[str, str, bytes, int]:
    found = CompressedImage.FromString(data)
    return found.frame_id, found.format, found.data, found.timestamp.ToNanoseconds() // MS


def line(data: bytes) -> tuple[str, int, str]:
    found = Log.FromString(data)
    return found.message, found.level, found.name
