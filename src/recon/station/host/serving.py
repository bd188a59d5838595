"""The station's HTTP servers: their sockets, the application around the station, and their run."""

import asyncio
import socket
from collections.abc import Awaitable, Callable
from contextlib import AsyncExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from recon import version
from recon.api.addresses import SharedAddress
from recon.api.certificate import Certificate
from recon.api.login import Login
from recon.api.servers import HttpServer
from recon.station.api_views.app import create_app
from recon.station.api_views.service import Service
from recon.station.host.base_maps import maps_of
from recon.station.host.flight_archive import RecordedFlights
from recon.station.host.http_servers import (
    listen,
    loopback_server,
    network_server,
    shared_address,
    stop_on_signals,
    url_of,
)
from recon.station.host.photo_job import PhotoJob
from recon.station.host.run_config import RunConfig
from recon.station.host.users_watch import UsersWatch
from recon.station.kernel.driver import AsyncioDriver, freeze_loaded_objects


@dataclass(frozen=True, slots=True)
class Doors:
    """The listening sockets of the HTTP servers, and the addresses they answer at."""

    loopback: socket.socket
    network: socket.socket | None
    certificate: Certificate | None
    url: str
    """The console's address on this computer."""
    shared: SharedAddress | None
    """What other computers use; None when they reach nothing."""


def open_doors(config: RunConfig, certificate: Certificate | None, stack: AsyncExitStack) -> Doors:
    """Listen on every address. Raises `StartError` for one that is taken."""
    loopback = listen(config.http_host, config.http_port, "--http-port")
    stack.callback(loopback.close)
    network = None
    if config.https_host is not None:
        network = listen(config.https_host, config.https_port, "--https-port")
        stack.callback(network.close)
    shared = shared_address(config.network, certificate, network)
    return Doors(loopback, network, certificate, url_of(config.http_host, loopback), shared)


async def serve(
    config: RunConfig,
    driver: AsyncioDriver,
    service: Service,
    doors: Doors,
    on_start: Callable[[], Awaitable[None]],
    stack: AsyncExitStack,
) -> None:
    """Run the driver's timers and the HTTP servers until one of them ends."""
    ticking = asyncio.create_task(driver.run())
    stack.callback(ticking.cancel)
    servers = _servers(config, driver, service, doors, stack)
    freeze_loaded_objects()
    stop_on_signals([server for server, _ in servers])
    serving = [asyncio.create_task(server.serve(sockets=[sock])) for server, sock in servers]
    await on_start()
    done, _ = await asyncio.wait((*serving, ticking), return_when=asyncio.FIRST_COMPLETED)
    # If the timers have ended, the station must not seem to run.
    for server, _ in servers:
        server.should_exit = True
    await asyncio.gather(*serving)
    for task in done:
        task.result()


def _elevated_site(config: RunConfig, service: Service) -> Path | None:
    """Return the site's folder, if the heights of its ground are known."""
    return None if service.site.elevation is None else config.site_folder


def _servers(
    config: RunConfig,
    driver: AsyncioDriver,
    service: Service,
    doors: Doors,
    stack: AsyncExitStack,
) -> list[tuple[HttpServer, socket.socket]]:
    """Return the server of each address, around one application."""
    login = Login(report=driver.handle)
    users = UsersWatch(config.network.users_file, login, driver.handle)
    users.read()
    watching = asyncio.create_task(users.run())
    stack.callback(watching.cancel)
    flights = photos = None
    if config.record_folder is not None:
        flights = RecordedFlights(config.record_folder, service.recording)
        stack.callback(flights.close)
        site = partial(_elevated_site, config, service)
        photos = PhotoJob(config.record_folder, flights.record, site=site)
        stack.callback(photos.close)
        service.gaps_file = lambda: photos.file("fly-again.geojson")
    maps = maps_of(config.site_folder, lambda: service.site)
    stack.callback(maps.close)
    app = create_app(
        service, config.console, version(), doors.shared, flights, maps=maps, photos=photos
    )
    servers = [(loopback_server(app, login, config.http_host), doors.loopback)]
    if doors.network is not None and doors.certificate is not None:
        servers.append((network_server(app, login, doors.certificate), doors.network))
    return servers
