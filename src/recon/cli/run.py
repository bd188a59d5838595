"""`recon run`: the station; `recon openapi`: the description of its API."""

import json
import socket
from dataclasses import dataclass
from pathlib import Path
from time import time
from typing import Annotated, Any

import typer

import recon
from recon.cli.foreground import print_now, run_in_loop
from recon.cli.methods import check_methods
from recon.cli.opened_site import opened_site
from recon.cli.options import with_options
from recon.cli.own_files import console_folder
from recon.cli.qr import qr_lines
from recon.cli.users import UsersOption
from recon.detection import DetectionSettings
from recon.forecast import ForecastSettings
from recon.link.settings import LinkSettings
from recon.record.audit.audit import shown
from recon.record.files.users_file import state_folder
from recon.site import Site, default_site, own_folder, site_report
from recon.site.app_list import APPS_FILE, read_app_list
from recon.site.expected_wind import expected_wind, wind_report
from recon.site.fetched_report import fetched_report
from recon.station.api_views.app import create_app
from recon.station.api_views.service import Service
from recon.station.audit.start import AuditPlace
from recon.station.host.http_servers import StartError
from recon.station.host.run import run
from recon.station.host.run_config import RunConfig, Started
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver

HAS_GUARD = hasattr(socket, "send_fds")
"""Windows hands no sockets to other processes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """The site, the addresses a station listens on, and what it keeps."""

    site: Annotated[
        Path | None,
        typer.Option(
            help="Folder with a site.toml; without one, vehicle profiles and ground image are off."
        ),
    ] = None
    link_host: Annotated[
        str, typer.Option(help="Address for companion apps; 0.0.0.0 accepts phones on the network.")
    ] = "127.0.0.1"
    link_port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port for companion apps; 0: any free port.")
    ] = 3001
    announce: Annotated[
        bool,
        typer.Option(help="Announce the station by mDNS to apps on the network of --link-host."),
    ] = False
    http_host: Annotated[str, typer.Option(help="Loopback address of the console.")] = "127.0.0.1"
    http_port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port of the console; 0: any free port.")
    ] = 8080
    stop_port: Annotated[
        int | None,
        typer.Option(
            min=0,
            max=65535,
            help="Port of the guard, on this computer: all stop when the console does not answer. "
            "Default: the console's port and 1; 0: any free port.",
        ),
    ] = None
    guard: Annotated[
        bool, typer.Option(help="Run a guard: a process that can stop vehicles automatically.")
    ] = HAS_GUARD
    https_host: Annotated[
        str | None,
        typer.Option(
            help="Address of the console for other computers, with TLS and login; 0.0.0.0: each."
        ),
    ] = None
    https_port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port for other computers; 0: any free port.")
    ] = 8443
    certificate: Annotated[
        Path | None, typer.Option(help="PEM file of a certificate; default: a generated one.")
    ] = None
    key: Annotated[Path | None, typer.Option(help="PEM file of the certificate's key.")] = None
    users: UsersOption = None
    record: Annotated[
        Path | None,
        typer.Option(
            "--record",
            help="Folder of the flight records; default: records in the site's folder.",
        ),
    ] = None
    no_record: Annotated[bool, typer.Option("--no-record", help="Record no flights.")] = False
    audit: Annotated[
        Path | None,
        typer.Option(help="Folder of the audit; default: one per link port."),
    ] = None
    apps: Annotated[
        Path | None,
        typer.Option(
            help="List of admitted apps; default: apps.toml in the site's folder, if any."
        ),
    ] = None
    light_sensors: Annotated[
        str | None,
        typer.Option(
            metavar="FILE_OR_TCP",
            help="Loggers of light sensors, shown beside the shade map and recorded: a CSV file "
            "that one appends to, or the address they connect to, as tcp://0.0.0.0:4002.",
        ),
    ] = None
    detection: Annotated[str, typer.Option(help="Method that finds shade, of `recon methods`.")] = (
        DetectionSettings().method
    )
    forecast: Annotated[
        str, typer.Option(help="Method of the sun forecast, of `recon methods`.")
    ] = ForecastSettings().method
    garbage_limit: Annotated[
        int, typer.Option(min=1024, help="Close a link after this many bytes without a packet.")
    ] = LinkSettings().garbage_limit_bytes

    def config(self) -> RunConfig:
        """Return how the station is started; raises `ReconError` for what cannot be read."""
        apps_file = self.apps or apps_file_of(self.site)
        site = default_site() if self.site is None else opened_site(self.site)
        wind = expected_wind(site, time())
        check_methods(self.detection, self.forecast)
        return RunConfig(
            site=site,
            link_host=self.link_host,
            link_port=self.link_port,
            is_announced=self.announce,
            http_host=self.http_host,
            http_port=self.http_port,
            stop_port=guard_port(self.stop_port, self.http_port, self.link_port)
            if self.guard
            else None,
            site_folder=self.site,
            record_folder=None if self.no_record else self.record or records_of(self.site),
            is_record_required=self.record is not None,
            audit=None if self.audit is None else AuditPlace(self.audit),
            users_file=self.users,
            https_host=self.https_host,
            https_port=self.https_port,
            certificate=self.certificate,
            key=self.key,
            console=console_folder(),
            link=LinkSettings(garbage_limit_bytes=self.garbage_limit),
            apps_file=apps_file,
            apps=None if apps_file is None else read_app_list(apps_file),
            light_sensors=self.light_sensors,
            detection=self.detection,
            forecast=self.forecast,
            wind_aloft_mps=None if wind is None else (wind.east_mps, wind.north_mps),
        )


@with_options
def run_command(options: RunOptions) -> None:
    """Run the station until Ctrl+C."""
    config = options.config()
    describe(config.site)
    run_in_loop(run(config, _print_started))


def guard_port(stop_port: int | None, http_port: int, link_port: int) -> int:
    """Return the port of the guard: as asked, else beside the console's; raises `StartError`."""
    port = stop_port
    if port is None:
        port = min(http_port + 1, 65535) if http_port else 0
    if port and port == link_port:
        raise StartError(
            f"expected different ports for companion apps and the guard, got {port} for both; the "
            "guard's is the console's and 1; choose another with --link-port"
        )
    return port


async def _print_started(started: Started) -> None:
    print_started(started)


def apps_file_of(site: Path | None) -> Path | None:
    """Return the list of apps in a site's folder; None without one."""
    path = None if site is None else site / APPS_FILE
    return path if path is not None and path.exists() else None


def records_of(site: Path | None) -> Path:
    """Return the folder of the flight records of a site: its own, or one of this user."""
    return (own_folder(site) or state_folder()) / "records"


def describe(site: Site) -> None:
    """Print how well the control points fit, the site's warnings, and what was fetched."""
    now_s = time()
    fetched = (*fetched_report(site, now_s), *wind_report(site, now_s))
    for line in (*site_report(site), *fetched):
        print_now(line)


def print_started(started: Started) -> None:
    """Print every address the station listens on, and which apps it admits."""
    for address in started.link_addresses:
        print_now(f"companion apps: {address}")
    if started.app_url is not None:
        for line in qr_lines(started.app_url):
            print_now(line)
    if started.apps_listed is not None:
        print_now(f"apps admitted: {started.apps_listed} entries; others wait, see recon pair")
    print_now(f"audit: {started.audit_folder}")
    if started.record_folder:
        print_now(f"records: {started.record_folder}")
    if started.light_sensors:
        print_now(f"light sensors: {started.light_sensors}")
    if started.resumed:
        print_now(f"from the last run: {shown(started.resumed)}; nothing is ordered")
    if started.stop_url is not None:
        print_now(f"all stop by the guard: curl -X POST {started.stop_url}")
    print_now(f"console: {started.console_url}")
    if started.network is not None:
        for url in started.network.urls:
            print_now(f"console for other computers, with login: {url}")
        print_now(f"certificate SHA-256: {started.network.fingerprint}")
        for line in qr_lines(started.network.login_url):
            print_now(line)


def openapi_command() -> None:
    """Print the API's OpenAPI document."""
    print(json.dumps(openapi_document(), indent=2, sort_keys=True))


def openapi_document() -> dict[str, Any]:
    """Return the OpenAPI document, from which the console's types are generated."""
    site = default_site()
    driver = AsyncioDriver(first_state(site), lambda: 0)
    service = Service.around(driver, site, None)
    return create_app(service, None, recon.version()).openapi()
