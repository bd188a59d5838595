"""`recon gateway mavlink` as a process, beside a station with a real site."""

import asyncio
from pathlib import Path

import pytest
from tests.cli.processes import started
from tests.cli.station_process import StationProcess, station_process
from tests.gateway.running_gateway import Client
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.gateway.mavlink.dialect import mavlink


def test_it_shows_the_vehicles_and_the_sites_fence(tmp_path: Path) -> None:
    with station_process(tmp_path / "audit", 1) as station:
        words = ("gateway", "mavlink", "--tcp", "127.0.0.1:0", "--station", station.url)
        with started(*words) as gateway:
            port = int(gateway.line_with("MAVLink clients: 127.0.0.1:").rpartition(":")[2])
            # The demonstration's ground lies 275 m above the ellipsoid, the sea 30.1 m below that.
            gateway.line_with("takeoff points: 305.1 m above sea level")
            gateway.line_with("orders: none, read-only")
            shown = asyncio.run(_fence(port))
            drawn = _drawn(station)
    assert shown == drawn
    assert len(drawn) >= 4


async def _fence(port: int) -> list[tuple[int, int]]:
    client = Client(*await asyncio.open_connection("127.0.0.1", port))
    await client.until("HEARTBEAT")
    assert "--allow-orders" in (await client.command(176, 1, 4, 3))[1]
    client.send(mavlink.MAVLink_mission_request_list_message(1, 1, 1))
    count = (await client.until("MISSION_COUNT")).count
    items = []
    for seq in range(count):
        client.send(mavlink.MAVLink_mission_request_int_message(1, 1, seq, 1))
        items.append(await client.until("MISSION_ITEM_INT"))
    await client.close()
    return [(item.x, item.y) for item in items]


def _drawn(station: StationProcess) -> list[tuple[int, int]]:
    """Corners of boundary and keep-out zones in the site's folder, in units of 1e-7 degrees."""
    features = station.get("/api/site/drawing")["features"]
    rings = [
        feature["geometry"]["coordinates"][0]
        for feature in features
        if feature["layer"] in ("boundary", "keep_out")
    ]
    return [(round(lat * 1e7), round(lon * 1e7)) for ring in rings for lon, lat in ring[:-1]]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--tcp", "0.0.0.0:5760", "--allow-orders"), "--signing-key"),
        (("--tcp", "nowhere"), "HOST:PORT"),
        (("--tcp", "127.0.0.1:1") * 9, "up to 8 addresses"),
        (("--udp-to", "127.0.0.1:0"), "--udp-to: expected HOST:PORT"),
    ],
)
def test_what_it_does_not_start_with(words: tuple[str, ...], sentence: str) -> None:
    result = CliRunner().invoke(app, ["gateway", "mavlink", *words])
    assert sentence in result.output
    assert result.exit_code == 2
