"""A station that goes away and comes back: one line at each change."""

import asyncio
import time

from tests.api.fake_station import FakeStation, application
from tests.api.serving import serving
from tests.client.running_station import background
from tests.gateway.running_gateway import PATIENCE_S
from tests.patient_loop import run_patiently

from recon.client import Station
from recon.gateway.contact import StationContact
from recon.gateway.mavlink.run import MavlinkGateway
from recon.gateway.mavlink.values import GatewaySettings


def test_a_line_at_each_change_with_its_times() -> None:
    contact = StationContact("{:g}".format)
    assert contact.change(100.0, 100.9) is None
    assert contact.change(100.0, 101.0) == (
        "station unreachable since 100: no vehicle is shown until it is back"
    )
    assert contact.change(100.0, 170.0) is None
    assert contact.change(172.0, 172.1) == ("station connected again at 172.1, after 72 s")
    assert contact.change(172.2, 172.3) is None


def test_a_station_that_was_stopped_is_said_and_its_return_too() -> None:
    async def main() -> None:
        lines: asyncio.Queue[str] = asyncio.Queue()
        station = FakeStation()
        app = application(station)
        async with serving(app) as url:
            client = Station(url, is_operator=False)
            await client.__aenter__()
            station.driver.now_ns = time.monotonic_ns
            gateway = MavlinkGateway(client, GatewaySettings(), say=lines.put_nowait)
            running = background(gateway.run())
            await running.__aenter__()
            port = int(url.rpartition(":")[2])
        async with asyncio.timeout(PATIENCE_S):
            assert (await lines.get()).startswith("station unreachable since ")
            async with serving(app, port):
                assert (await lines.get()).startswith("station connected again at ")
                await running.__aexit__(None, None, None)
                await client.close()
        assert lines.empty()

    run_patiently(main())
