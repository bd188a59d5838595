"""A real station on loopback sockets with simulated apps, in this process."""

import asyncio
from collections.abc import AsyncIterator, Callable, Coroutine, Mapping
from contextlib import AsyncExitStack, asynccontextmanager
from typing import Any

from tests.api.serving import serving
from tests.persons import user
from tests.ready import ready_profile, ready_site

from recon.api.login import Login
from recon.api.security import Access, AccessCheck
from recon.geo import point_from_enu
from recon.link.server import LinkServer
from recon.link.settings import LinkSettings
from recon.model.geo import GeoPoint, LocalFrame
from recon.sim.app.faults import parse_fault
from recon.sim.fleet import Airborne, ImagerSetup, SimulationConfig
from recon.sim.run import run_fleet
from recon.site import Site
from recon.station.api_views.app import create_app
from recon.station.api_views.audit_service import KeptEntries
from recon.station.api_views.service import Service
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver, station_clock
from recon.station.kernel.worker import JobRunner, ThreadWorker

HOME = GeoPoint(41.9012, -93.6034, 275.0)
SERIALS = ("SIM-1", "SIM-2")
PADS = {
    serial: point_from_enu(LocalFrame(HOME), (20.0 * number, 0.0, 0.0))
    for number, serial in enumerate(SERIALS)
}


@asynccontextmanager
async def background(work: Coroutine[Any, Any, None]) -> AsyncIterator[None]:
    """Run work in the background; cancel it at the end and wait."""
    task = asyncio.create_task(work)
    try:
        yield
    finally:
        task.cancel()
        await asyncio.wait((task,))


@asynccontextmanager
async def running_station(
    *,
    airborne: bool = True,
    token: str | None = None,
    vehicles: int = 2,
    faults: tuple[str, ...] = (),
    imagers: Mapping[str, ImagerSetup] | None = None,
    prepared: Callable[[Site], Site] = lambda site: site,
    kept: Callable[[AsyncioDriver, Site], KeptEntries | None] = lambda driver, site: None,
) -> AsyncIterator[str]:
    """Run a station and its simulated apps; yield the station's address.

    The site is ready to fly; `prepared` may change it. `kept` may record the driver, and returns
    the audit.
    """
    site = ready_site(HOME, (ready_profile(s, PADS[s], n) for n, s in enumerate(SERIALS)))
    driver = AsyncioDriver(first_state(prepared(site)), station_clock())
    driver.links = links = LinkServer(driver.handle, driver.now_ns, LinkSettings())
    async with AsyncExitStack() as stack:
        audit_log = kept(driver, site)
        await links.start("127.0.0.1", 0)
        stack.push_async_callback(links.stop)
        driver.worker = worker = ThreadWorker(JobRunner(site), driver.handle_from_thread)
        worker.start()
        stack.callback(worker.stop)
        await stack.enter_async_context(background(driver.run()))
        config = SimulationConfig(
            home=HOME,
            station_port=links.port,
            vehicle_count=vehicles,
            imagers=imagers or {},
            pads=PADS,
            airborne=Airborne.ALL if airborne else Airborne.NONE,
            faults=tuple(parse_fault(text) for text in faults),
        )
        await stack.enter_async_context(background(run_fleet(config, say=lambda line: None)))
        service = Service.around(driver, site, None, audit_log)
        access = Access() if token is None else Access.network(Login([user(token=token)]))
        app = AccessCheck(create_app(service, None, "test"), access)
        yield await stack.enter_async_context(serving(app))
