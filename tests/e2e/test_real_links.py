"""Simulated apps in a process of their own, on real sockets, with what goes wrong in the field."""

import asyncio
import signal
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from functools import partial

import uvloop
from tests.cli.processes import started
from tests.persons import ANN
from tests.ready import ready_site

from recon.fleet.state import staleness
from recon.link.server import LinkServer
from recon.link.settings import LinkSettings
from recon.model.command import Body, FlyMission, LandNow
from recon.model.mission import Mission, Waypoint
from recon.model.vehicle import Staleness, VehicleState
from recon.sim.proxy import Damage, ProxyConfig, run_proxy
from recon.site import demo_site_folder, load_site
from recon.station.api_views.order_service import order_of
from recon.station.api_views.service import Service
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver, station_clock

PATIENCE_S = 120.0
SERIALS = ("SIM-1", "SIM-2")


class Field:
    """A running station, asked as the API asks it."""

    def __init__(self, driver: AsyncioDriver, service: Service) -> None:
        self.driver = driver
        self.service = service

    def vehicle(self, serial: str) -> VehicleState | None:
        return self.driver.station.fleet.vehicles.get(serial)

    def order(self, serial: str, body: Body) -> int:
        (result,) = self.service.orders.give([serial], order_of(body, ANN)).results
        assert result.accepted, result
        return result.command_id

    def phases(self, command_id: int) -> list[str]:
        history = self.driver.station.orders.records[command_id].history
        return [change.phase.value for change in history]

    async def until(self, is_reached: Callable[[], bool]) -> None:
        async with asyncio.timeout(PATIENCE_S):
            while not is_reached():
                await asyncio.sleep(0.01)


@asynccontextmanager
async def field(*sim_options: str, damage: Damage | None = None) -> AsyncIterator[Field]:
    """Run a station and a fleet of two that flies, perhaps over links with damage; all end."""
    demo = load_site(demo_site_folder())  # where the simulator starts
    assert demo.frame is not None
    site = ready_site(demo.frame.origin, (demo.profiles[serial] for serial in SERIALS))
    driver = AsyncioDriver(first_state(site), station_clock())
    driver.links = links = LinkServer(driver.handle, driver.now_ns, LinkSettings())
    await links.start("127.0.0.1", 0)
    ticking = asyncio.create_task(driver.run())
    proxy, port = await _proxied(links.port, damage)
    station = f"127.0.0.1:{port}"
    options = ["--station", station, "--vehicles", "2", "--no-imager", "--airborne", *sim_options]
    here = Field(driver, Service.around(driver, site, None))
    try:
        with started("sim", *options) as simulator:
            await here.until(lambda: all(here.vehicle(serial) for serial in SERIALS))
            yield here
            await asyncio.to_thread(simulator.end, signal.SIGTERM)
    finally:
        proxy.cancel()
        ticking.cancel()
        # The proxy closes its connections when it ends.
        await asyncio.gather(proxy, ticking, return_exceptions=True)
        await links.stop()


async def _proxied(port: int, damage: Damage | None) -> tuple["asyncio.Future[None]", int]:
    """Return a proxy and its port; without damage none, and the station's own."""
    if damage is None:
        return asyncio.get_running_loop().create_future(), port
    listening: asyncio.Future[int] = asyncio.get_running_loop().create_future()
    here, there = ("127.0.0.1", 0), ("127.0.0.1", port)
    config = ProxyConfig(listen=here, station=there, damage=damage, seed=3)
    proxy = asyncio.ensure_future(run_proxy(config, lambda _: None, listening.set_result))
    return proxy, await listening


def short_mission(vehicle: VehicleState) -> FlyMission:
    here = vehicle.position.value
    assert here is not None
    return FlyMission(
        Mission(
            tuple(
                Waypoint(here.latitude_deg + north_deg, here.longitude_deg, 50.0, 5.0)
                for north_deg in (0.0002, 0.0004)
            )
        )
    )


def test_a_bad_link_between_loses_packets_and_no_vehicle() -> None:
    async def main() -> None:
        damage = Damage(delay_s=0.05, jitter_s=0.1, resets_per_min=12.0, corrupted_per_mb=400.0)
        async with field("--seed", "3", damage=damage) as here:
            await here.until(lambda: connections(here) >= 2 + 3)
            vehicles = here.driver.station.fleet.vehicles
            assert set(vehicles) == set(SERIALS)
            for serial in SERIALS:
                await lands(here, serial)

    uvloop.run(main())


async def lands(here: Field, serial: str) -> None:
    """Order a landing until one is confirmed: a reset of the link may end an order."""
    while True:
        await here.until(lambda: is_live(here, serial))
        phases = partial(here.phases, here.order(serial, LandNow()))
        await here.until(partial(is_ended_or_confirmed, phases))
        if "confirmed" in phases():
            return


def is_ended_or_confirmed(phases: Callable[[], list[str]]) -> bool:
    return bool({"confirmed", "failed", "timed_out"} & set(phases()))


def connections(here: Field) -> int:
    """How many there have been."""
    return max(here.driver.station.fleet.links, default=0)


def is_live(here: Field, serial: str) -> bool:
    vehicle = here.vehicle(serial)
    if vehicle is None or vehicle.link_id is None:
        return False
    return staleness(vehicle, here.driver.now_ns()) is Staleness.LIVE


def test_orders_are_answered_and_confirmed_by_telemetry() -> None:
    async def main() -> None:
        async with field() as here:
            await here.until(lambda: is_known_to_fly(here, "SIM-1"))
            vehicle = here.vehicle("SIM-1")
            assert vehicle is not None
            flown = here.order("SIM-1", short_mission(vehicle))
            await here.until(lambda: "started" in here.phases(flown))
            assert here.phases(flown)[:3] == ["queued", "sent", "acknowledged"]
            landed = here.order("SIM-1", LandNow())
            await here.until(lambda: "confirmed" in here.phases(landed))
            assert here.vehicle("SIM-2") is not None

    uvloop.run(main())


def test_a_phone_that_changes_its_network_stays_the_same_vehicle() -> None:
    """The old socket stays open and silent; a second after the serial came the new one counts."""

    async def main() -> None:
        async with field("--fault", "half-open:SIM-1:3:60") as here:
            vehicle = here.vehicle("SIM-1")
            assert vehicle is not None
            old_id = vehicle.link_id
            await here.until(lambda: len(here.driver.station.fleet.links) == 3)
            await here.until(
                lambda: (v := here.vehicle("SIM-1")) is not None and v.link_id not in (None, old_id)
            )
            fleet = here.driver.station.fleet
            assert set(fleet.vehicles) == set(SERIALS)
            assert old_id is not None
            await here.until(lambda: not here.driver.station.fleet.links[old_id].is_open)
            landed = here.order("SIM-1", LandNow())
            await here.until(lambda: "confirmed" in here.phases(landed))

    uvloop.run(main())


def test_an_app_that_acknowledges_and_does_nothing_is_seen_through() -> None:
    async def main() -> None:
        async with field("--fault", "ack-then-nothing:SIM-2") as here:
            await here.until(lambda: is_known_to_fly(here, "SIM-2"))
            vehicle = here.vehicle("SIM-2")
            assert vehicle is not None
            flown = here.order("SIM-2", short_mission(vehicle))
            await here.until(lambda: here.phases(flown)[-1] == "timed_out")
            assert "acknowledged" in here.phases(flown)
            assert "started" not in here.phases(flown)

    uvloop.run(main())


def is_known_to_fly(here: Field, serial: str) -> bool:
    vehicle = here.vehicle(serial)
    return (
        vehicle is not None
        and vehicle.is_flying.value is True
        and vehicle.flight_mode.value is not None
    )
