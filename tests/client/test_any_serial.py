"""Every request about one vehicle, for any serial, over a real HTTP server."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import httpx
import pytest
from tests.api.serving import serving
from tests.client.running_station import background
from tests.link.approved import core, extended
from tests.patient_loop import run_patiently
from tests.ready import ready_site

from recon.api.security import Access, AccessCheck
from recon.client import RequestRefusedError, Station
from recon.link.server import LinkServer
from recon.link.settings import LinkSettings
from recon.model.geo import GeoPoint
from recon.site import Site
from recon.station.api_views.app import create_app
from recon.station.api_views.service import Service
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver, station_clock

SERIALS = [
    "A/B",
    "..",
    ".",
    "/",
    "//host/x",
    "%2F",
    "%2e%2e",
    "a b+c&d=e?f#g;h",
    "serial=..",
    "preflight",
    "\\",
    "Å\u200a無人機",
    "x" * 256,
]


@asynccontextmanager
async def station_with(serial: str) -> AsyncIterator[str]:
    """Run a station with one app that reports a serial and hovers; yield its address."""
    site: Site = ready_site(GeoPoint(41.9012, -93.6034, 275.0), ())
    driver = AsyncioDriver(first_state(site), station_clock())
    driver.links = links = LinkServer(driver.handle, driver.now_ns, LinkSettings())
    await links.start("127.0.0.1", 0)
    _, writer = await asyncio.open_connection("127.0.0.1", links.port)
    writer.write(extended(serial.encode()))
    app = AccessCheck(create_app(Service.around(driver, site, None), None, "test"), Access())
    try:
        async with background(driver.run()), background(_telemetry(writer)), serving(app) as url:
            yield url
    finally:
        writer.close()
        await links.stop()


async def _telemetry(writer: asyncio.StreamWriter) -> None:
    while True:
        writer.write(core())
        await asyncio.sleep(0.1)


@pytest.mark.parametrize("serial", SERIALS)
def test_every_request_reaches_the_vehicle(serial: str) -> None:
    async def main() -> None:
        async with station_with(serial) as url, Station(url) as station:
            vehicle = await station.vehicle(next(iter(await shown(url))), timeout_s=120.0)
            assert (await vehicle.preflight()).serial == vehicle.serial
            assert await vehicle.take() is None
            assert await vehicle.override_preflight("a test") is None
            with pytest.raises(RequestRefusedError, match="it is connected, landed or unknown"):
                await vehicle.dismiss_hazard()

    run_patiently(main())


async def shown(url: str) -> list[str]:
    """Return the serials that the station shows."""
    async with httpx.AsyncClient(base_url=url, trust_env=False) as client:
        while True:
            vehicles = (await client.get("/api/vehicles")).json()
            if vehicles:
                serials = [vehicle["serial"] for vehicle in vehicles]
                for serial in serials:
                    answer = await client.get("/api/vehicle", params={"serial": serial})
                    assert answer.json()["serial"] == serial
                return serials
            await asyncio.sleep(0.01)
