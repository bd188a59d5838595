"""What an app reports of its aircraft, from its socket to every place that shows it.

The app is bytes on a socket; station and replay are processes.
"""

import asyncio
import json
import signal
import socket
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tests.cli.processes import PATIENCE_S, Started, started
from tests.cli.station_process import addresses, run_options

from recon import wire
from recon.client import Station, Telemetry
from recon.model.app_report import AppOrder, RtkState

PLACE = (41.9012, -93.6034)
FACTS = {
    "kind": "facts",
    "go_home_height_m": 30,
    "failsafe": "hover",
    "home_latitude_deg": PLACE[0] + 0.003,
    "home_longitude_deg": PLACE[1],
    "max_height_m": 120,
    "storage_left_photos": 700,
    "rtk": "fixed",
    "exposure_locked": True,
    "dji_check_passed": False,
    "dji_check": "no network",
    "reports_photos": True,
    "orders": ["lock_camera"],
    "a_newer_key": [1, 2],
}
PHOTOS = {"kind": "photos", "series": 7, "photos": [{"index": 3, "age_s": 1}]}


def text(found: dict[str, Any]) -> bytes:
    packet = wire.MessageString(type=0, text=b"recon 1 " + json.dumps(found).encode())
    return wire.encode(packet)


TELEMETRY = [
    wire.encode(
        wire.CoreTelemetry(
            is_flying=1,
            latitude_deg=PLACE[0],
            longitude_deg=PLACE[1],
            altitude_m=315.0,
            height_above_takeoff_m=40.0,
            velocity_north_mps=0.0,
            velocity_east_mps=0.0,
            velocity_down_mps=0.0,
            yaw_deg=0.0,
            pitch_deg=0.0,
            roll_deg=0.0,
        )
    ),
    wire.encode(
        wire.ExtendedTelemetry(
            gnss_satellite_count=15,
            gnss_signal_level=5,
            max_height_reached=0,
            max_distance_reached=0,
            battery_percent=90,
            battery_warning=0,
            wind_level=0,
            camera_state=1,
            flight_mode=3,
            mission_id=0,
            serial=b"SIM-1",
        )
    ),
]


@contextmanager
def connected(port: int) -> Iterator[socket.socket]:
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S) as app:
        for packet in reversed(TELEMETRY):
            app.sendall(packet)
        yield app


def get(url: str, path: str) -> Any:
    with urllib.request.urlopen(f"{url}{path}", timeout=PATIENCE_S) as response:
        return json.load(response)


def vehicle_once(url: str, key: str) -> dict[str, Any]:
    """The vehicle, once this is known of it."""
    given_up_s = time.monotonic() + PATIENCE_S
    while True:
        vehicles = get(url, "/api/state")["vehicles"]
        if vehicles and vehicles[0][key] is not None:
            return vehicles[0]  # type: ignore[no-any-return]
        assert time.monotonic() < given_up_s
        time.sleep(0.05)


async def by_the_client(url: str) -> Telemetry:
    async with Station(url) as station:
        async for telemetry in (await station.vehicle("SIM-1")).telemetry():
            return telemetry
    raise AssertionError("no telemetry")


@contextmanager
def station(folder: Path) -> Iterator[tuple[Started, str, int]]:
    options = [word for word in run_options(folder / "audit") if word != "--no-record"]
    with started(*options, "--record", str(folder / "records")) as process:
        yield process, *addresses(process)


def test_facts_and_photos_reach_preflight_client_record_and_replay(tmp_path: Path) -> None:
    with station(tmp_path) as (process, url, port):
        with connected(port) as app:
            app.sendall(text(FACTS) + text(PHOTOS))
            shown = vehicle_once(url, "photos")
            points = {
                each["key"]: each
                for each in get(url, "/api/vehicle/preflight?serial=SIM-1")["points"]
            }
            telemetry = asyncio.run(by_the_client(url))
            app.sendall(b"".join(TELEMETRY))
        assert process.end(signal.SIGINT) == 0

    assert shown["app_facts"]["go_home_height_m"] == 30
    assert shown["app_facts"]["dji_check"] == "no network"
    assert 0.0 <= shown["app_facts_age_s"] < PATIENCE_S
    assert (shown["photos"]["count"], shown["photos"]["missing"]) == (3, 0)

    texts = {key: point["text"] for key, point in points.items()}
    assert texts["go_home_height"] == "the aircraft reports 30 m; site.toml states 48 m"
    assert texts["failsafe"] == "the aircraft reports hover; site.toml states go_home"
    assert texts["home_point"].endswith(" m from where it took off: a return ends there")
    assert texts["storage"] == "has room for 700 photos"
    assert texts["dji_check"] == "failed: no network"
    assert points["go_home_height"]["holds_back"]

    assert telemetry.app_facts is not None
    assert telemetry.app_facts.rtk is RtkState.FIXED
    assert telemetry.app_facts.orders == (AppOrder.LOCK_CAMERA,)
    assert telemetry.app_facts_age_s is not None
    assert telemetry.photos is not None
    assert telemetry.photos.count == 3

    (record,) = (tmp_path / "records").glob("flight-*.mcap")
    with started("replay", str(record), "--http-port", "0") as replay:
        console = replay.line_with("console: http://127.0.0.1:").partition(": ")[2]
        end = urllib.request.Request(
            f"{console}/api/replay",
            json.dumps({"position_s": 1e7}).encode(),
            {"content-type": "application/json"},
            method="POST",
        )
        urllib.request.urlopen(end, timeout=PATIENCE_S).close()
        again = vehicle_once(console, "photos")
        assert replay.end(signal.SIGINT) == 0
    assert again["app_facts"] == shown["app_facts"]
    assert again["photos"]["count"] == 3


def test_a_plain_app_is_a_full_citizen_with_the_checklist_it_had(tmp_path: Path) -> None:
    with station(tmp_path) as (process, url, port), connected(port):
        shown = vehicle_once(url, "telemetry_age_s")
        points = get(url, "/api/vehicle/preflight?serial=SIM-1")["points"]
        assert process.end(signal.SIGINT) == 0
    assert (shown["app_facts"], shown["photos"]) == (None, None)
    assert [each["key"] for each in points][-2:] == ["camera_interval", "app"]
    assert len(points) == 15
