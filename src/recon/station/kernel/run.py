"""`recon run`: the station on real sockets, until SIGINT or SIGTERM."""

import asyncio
import socket
from collections.abc import Awaitable, Callable, Mapping
from contextlib import AsyncExitStack, ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryFile

import structlog

from recon import version
from recon.api.addresses import SharedAddress, app_hosts, app_url, in_url
from recon.api.app import create_app
from recon.api.certificate import Certificate
from recon.api.login import Login
from recon.api.servers import HttpServer
from recon.fleet.admission import AllowedApp
from recon.link.server import LinkServer
from recon.link.settings import LinkSettings
from recon.model.errors import RecordError
from recon.model.event import RecordFailed
from recon.record.record_process import IS_SUPPORTED
from recon.record.users_file import default_users_file
from recon.site import Site, demo_site_folder
from recon.site.reading import site_digest
from recon.site.vehicle_numbers import NUMBERS_FILE, numbers_text, read_numbers
from recon.station.api_views.service import Service
from recon.station.api_views.vehicle_numbers import VehicleNumbers
from recon.station.audit.auditor import Auditor, LogPrinter
from recon.station.audit.start import (
    AuditPlace,
    Begun,
    begin_audit,
    default_place,
    ended_entry,
    started_entry,
)
from recon.station.imaging.references import with_references
from recon.station.kernel.announcing import announce, require_announceable
from recon.station.kernel.app_list_writer import AppListWriter
from recon.station.kernel.base_maps import SiteMaps, maps_of
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver, freeze_loaded_objects, station_clock
from recon.station.kernel.flight_archive import RecordedFlights
from recon.station.kernel.guard_line import GuardLine, take_over_from_orphan
from recon.station.kernel.http_servers import (
    NetworkConfig,
    StartError,
    cannot_listen,
    certificate_of,
    listen,
    loopback_server,
    network_server,
    require_startable,
    shared_address,
    stop_on_signals,
    url_of,
)
from recon.station.kernel.recording import Recorder, record_process
from recon.station.kernel.rewritten_file import RewrittenFile
from recon.station.kernel.users_watch import UsersWatch
from recon.station.kernel.worker import JobRunner, ThreadWorker
from recon.station.recovery.restart import LastRun, restart_entries, restored
from recon.station.recovery.snapshot_writer import SnapshotWriter, load_last_run
from recon.station.state.settings import StationSettings
from recon.station.state.station import Station
from recon.station.state.steps import StepTaken


@dataclass(frozen=True, slots=True)
class RunConfig:
    """How a station is started. Everything binds loopback by default."""

    site: Site
    link_host: str = "127.0.0.1"
    link_port: int = 3001
    is_announced: bool = False
    """By mDNS, to apps on the network of `link_host`."""
    http_host: str = "127.0.0.1"
    http_port: int = 8080
    stop_port: int | None = None
    """Of the guard, on loopback; None: no guard."""
    site_folder: Path | None = None
    """Where the site was read from; its digest goes into the audit."""
    record_folder: Path | None = None
    """Of the flight records; None: nothing is recorded."""
    is_record_required: bool = False
    """Whether a folder that cannot be written is an error at the start, not only an alarm."""
    audit: AuditPlace | None = None
    """None: the place in the user's state folder that belongs to the link port."""
    users_file: Path | None = None
    """None: the one of this computer's user."""
    https_host: str | None = None
    """Address for other computers; None: they reach nothing."""
    https_port: int = 8443
    certificate: Path | None = None
    key: Path | None = None
    """The site's own certificate with its key; without one the station generates one."""
    console: Path | None = None
    link: LinkSettings = field(default_factory=LinkSettings)
    apps_file: Path | None = None
    """The list of admitted apps; None: any app is admitted."""
    apps: tuple[AllowedApp, ...] | None = None
    """The entries of that file."""
    sun_time_ahead_s: float = 0.0
    """How far the time of day of simulated drones is ahead of the computer's clock."""
    scenario: str = ""
    """The simulated world, for the record (`score/truth.py`); empty for real aircraft."""

    @property
    def network(self) -> NetworkConfig:
        """The part about other computers."""
        users = self.users_file or default_users_file()
        return NetworkConfig(users, self.https_host, self.https_port, self.certificate, self.key)


@dataclass(frozen=True, slots=True)
class Started:
    """Where a station listens."""

    link_addresses: list[str]
    link_port: int
    console_url: str
    stop_url: str | None = None
    """Where a person stops all vehicles when the station does not answer; None without a guard."""
    audit_folder: str = ""
    record_folder: str = ""
    apps_listed: int | None = None
    """Entries of the list of apps; None without a list."""
    network: SharedAddress | None = None
    """What other computers use; None when they reach nothing."""
    app_url: str | None = None
    """For apps on other devices, as QR codes have it; None when they reach nothing."""
    taken_up: str = ""
    """What this run continues from the last one, in words; empty if nothing."""


_log = structlog.get_logger("recon")

Observe = Callable[[StepTaken], None]
OnStart = Callable[[Started], Awaitable[None]]


async def run(config: RunConfig, on_start: OnStart) -> None:
    """Run a station until SIGINT or SIGTERM. Raises `StartError` when it cannot start."""
    require_startable(config.http_host, config.network)
    if config.is_announced:
        require_announceable(config.link_host)
    certificate = certificate_of(config.network)
    place = config.audit or default_place(config.link_port)
    numbers_file = _numbers_file(config, place)
    given = {} if numbers_file is None else read_numbers(numbers_file)
    begun = _begin_audit(place)
    last_run, is_snapshot_good = _last_run(place, begun)
    async with AsyncExitStack() as last, AsyncExitStack() as stack:
        doors = _open_doors(config, certificate, stack)
        clock = station_clock()
        begins = first_station(config)
        station = restored(begins, last_run, clock())
        auditor = _start_auditor(config, begun, last_run, clock, stack)
        auditor.put(restart_entries(station))
        driver = AsyncioDriver(station, clock, auditor.observe)
        auditor.handle = driver.handle
        if not place.is_shared:
            last_id = last_run.first_ids[0] - 1
            snapshots = SnapshotWriter(
                place.folder, clock, last_order_id=last_id, keep_current=is_snapshot_good
            )
            auditor.snapshot_problem = lambda: snapshots.problem
            driver.observe = _both(snapshots.observe, auditor.observe)
            snapshots.start(station)
            stack.callback(snapshots.close)
        _write_app_list(config, driver, stack)
        folder = _text(config.record_folder)
        service = Service.around(driver, config.site, folder, begun.log, last_run.first_ids[0])
        service.edit(config.site_folder)
        recorder = _start_record(config, driver, auditor, service, stack)
        service.numbers = kept_numbers(given, numbers_file, stack)
        line = _start_guard(config, driver, service, doors, place.folder, stack)
        links = await _start_links_and_worker(config, driver, service, line, recorder, stack)
        if config.is_announced:
            name = "Recon" if config.site_folder is None else config.site.name
            announce(name, links.hosts, links.port, last)
        started = replace(
            _started(config, service, links, doors),
            stop_url=None if line is None else line.stop_url,
            audit_folder=str(begun.log.folder),
            record_folder=folder or "",
            apps_listed=None if config.apps is None else len(config.apps),
            taken_up=_taken_up(station, (*begun.troubles, *last_run.troubles)),
        )
        await _serve(config, driver, service, doors, lambda: on_start(started), stack)


def _numbers_file(config: RunConfig, place: AuditPlace) -> Path | None:
    """Return where the vehicles' numbers are kept: with the site, else with this port's audit."""
    folder = config.site_folder
    if folder is not None and folder.resolve() != demo_site_folder().resolve():
        return folder / NUMBERS_FILE
    return None if place.is_shared else place.folder / NUMBERS_FILE


def kept_numbers(
    given: Mapping[str, int], path: Path | None, stack: ExitStack | AsyncExitStack
) -> VehicleNumbers:
    """Return the vehicles' numbers, kept in a file."""
    if path is None:
        return VehicleNumbers(given)
    file = RewrittenFile(path, _log_numbers_problem, mode=0o644)
    file.start()
    stack.callback(file.close)
    return VehicleNumbers(given, lambda numbers: file.put(numbers_text(numbers).encode()))


def _log_numbers_problem(problem: str | None) -> None:
    if problem is not None:
        _log.warning(f"vehicle numbers: {problem}")


async def _start_links_and_worker(
    config: RunConfig,
    driver: AsyncioDriver,
    service: Service,
    line: GuardLine | None,
    recorder: Recorder | None,
    stack: AsyncExitStack,
) -> LinkServer:
    runner = JobRunner(config.site)
    runner.digests_inputs = recorder is not None
    driver.worker = worker = ThreadWorker(runner, driver.handle_from_thread)
    tap = None if recorder is None else recorder.tap
    driver.links = links = LinkServer(driver.handle, driver.now_ns, config.link, tap)
    links.objection = driver.objection
    links.watch = line
    listens_on = await _listen_for_links(links, config)
    hosts = app_hosts(links.hosts)
    service.link_addresses = [f"{in_url(host)}:{links.port}" for host in hosts] or listens_on
    service.app_url = app_url(hosts[0], links.port) if hosts else None
    stack.push_async_callback(links.stop)
    worker.start()
    stack.callback(worker.stop)
    return links


def _start_guard(
    config: RunConfig,
    driver: AsyncioDriver,
    service: Service,
    doors: "_Doors",
    folder: Path,
    stack: AsyncExitStack,
) -> GuardLine | None:
    """Start the guard, after the one of a station that has died here has given way."""
    acts = take_over_from_orphan(folder)
    if config.stop_port is None:
        return None
    stop_socket = listen("127.0.0.1", config.stop_port, "--stop-port")
    line = GuardLine(driver, service, stop_socket, url_of(config.http_host, doors.loopback))
    service.guard_stop_url = line.stop_url
    stack.callback(line.close)
    line.write_port(folder)
    for act in acts:
        line.take(act)
    guarding = asyncio.create_task(line.run())
    stack.callback(guarding.cancel)
    return line


async def _serve(
    config: RunConfig,
    driver: AsyncioDriver,
    service: Service,
    doors: "_Doors",
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


def _write_app_list(config: RunConfig, driver: AsyncioDriver, stack: AsyncExitStack) -> None:
    """Write pairings to the list's file while the station runs."""
    if config.apps_file is None or driver.observe is None:
        return
    writer = AppListWriter(config.apps_file, driver.handle_from_thread)
    driver.observe = _both(driver.observe, writer.observe)
    writer.start()
    stack.callback(writer.close)


def _servers(
    config: RunConfig,
    driver: AsyncioDriver,
    service: Service,
    doors: "_Doors",
    stack: AsyncExitStack,
) -> list[tuple[HttpServer, socket.socket]]:
    """Return the server of each address, around one application."""
    login = Login(report=driver.handle)
    users = UsersWatch(config.network.users_file, login, driver.handle)
    users.read()
    watching = asyncio.create_task(users.run())
    stack.callback(watching.cancel)
    shared = shared_address(config.network, doors.certificate, doors.network)
    flights = None
    if config.record_folder is not None:
        flights = RecordedFlights(config.record_folder, service.recording)
        stack.callback(flights.close)
    maps = maps_of(config.site_folder, lambda: service.site)
    if isinstance(maps, SiteMaps):
        stack.callback(maps.close)
    app = create_app(service, config.console, version(), shared, flights, maps=maps)
    servers = [(loopback_server(app, login, config.http_host), doors.loopback)]
    if doors.network is not None and doors.certificate is not None:
        servers.append((network_server(app, login, doors.certificate), doors.network))
    return servers


@dataclass(frozen=True, slots=True)
class _Doors:
    """The listening sockets of the HTTP servers."""

    loopback: socket.socket
    network: socket.socket | None
    certificate: Certificate | None


def _open_doors(
    config: RunConfig, certificate: Certificate | None, stack: AsyncExitStack
) -> _Doors:
    loopback = listen(config.http_host, config.http_port, "--http-port")
    stack.callback(loopback.close)
    network = None
    if config.https_host is not None:
        network = listen(config.https_host, config.https_port, "--https-port")
        stack.callback(network.close)
    return _Doors(loopback, network, certificate)


def _begin_audit(place: AuditPlace) -> Begun:
    try:
        return begin_audit(place)
    except RecordError as problem:
        raise StartError(str(problem)) from problem


def _last_run(place: AuditPlace, begun: Begun) -> tuple[LastRun, bool]:
    return (LastRun(), False) if place.is_shared else load_last_run(place.folder, begun.runs_before)


def _both(first: Observe, second: Observe) -> Observe:
    """Return an observer that calls two; the recovery snapshot comes before the audit, and both
    before the list of apps."""

    def observe(step: StepTaken) -> None:
        first(step)
        second(step)

    return observe


def _start_auditor(
    config: RunConfig,
    begun: Begun,
    last_run: LastRun,
    clock: Callable[[], int],
    stack: AsyncExitStack,
) -> Auditor:
    """Start the audit; its last entry is written after everything else has ended."""
    printer = LogPrinter()
    auditor = Auditor(begun.log, printer, clock)
    printer.start()
    stack.callback(printer.close)
    begun.log.start()
    stack.callback(begun.log.close)
    stack.push(lambda kind, problem, trace: auditor.put([ended_entry(problem)]))
    settings, folder = first_state(config.site, _settings(config)).settings, config.site_folder
    site = {
        "name": config.site.name,
        "folder": _text(folder),
        "sha256": None if folder is None else site_digest(folder),
    }
    troubles = (*begun.troubles, *last_run.troubles)
    first_ids = last_run.first_ids
    auditor.put([started_entry(settings, site, begun.ended_in_order, first_ids, troubles)])
    return auditor


def first_station(config: RunConfig) -> Station:
    """Return the station before its first event; it knows what earlier flights have learned."""
    station, folder = first_state(config.site, _settings(config), config.apps), config.site_folder
    # The demonstration's site is a part of the package: nothing is kept there.
    if folder is None or folder.resolve() == demo_site_folder().resolve():
        return station
    return with_references(station, folder)


def _settings(config: RunConfig) -> StationSettings:
    return StationSettings(
        failsafe_matrix=config.site.failsafe, sun_time_ahead_s=config.sun_time_ahead_s
    )


def _taken_up(station: Station, troubles: tuple[str, ...]) -> str:
    """Return what an operator must know after a run that ended in flight."""
    names = [
        station.fleet.vehicles[serial].display_name
        for serial, control in station.controls.items()
        if control.restored is not None
    ]
    names += [state.display_name for state in station.watchdog_state.lost.values()]
    parts = [f"in flight at last contact: {', '.join(names)}"] if names else []
    if station.orders.records:
        parts.append(f"{len(station.orders.records)} orders were interrupted")
    return "; ".join((*parts, *troubles))


async def _listen_for_links(links: LinkServer, config: RunConfig) -> list[str]:
    try:
        return await links.start(config.link_host, config.link_port)
    except (OSError, OverflowError) as problem:
        raise cannot_listen(config.link_host, config.link_port, "--link-port", problem) from problem


def _start_record(
    config: RunConfig,
    driver: AsyncioDriver,
    auditor: Auditor,
    service: Service,
    stack: AsyncExitStack,
) -> Recorder | None:
    """Record the run from before its first event, unless that is not wanted. The record is closed
    after everything else has ended."""
    folder = config.record_folder
    if folder is None:
        return None
    if not IS_SUPPORTED:
        driver.handle(RecordFailed("flights are not recorded on Windows"))
        return None
    if config.is_record_required:
        _require_writable(folder)
    recorder = Recorder(
        lambda: record_process(folder), driver.handle, auditor, config.site, config.scenario
    )
    driver.record = recorder.take
    service.lost_bytes = lambda: recorder.dropped_bytes
    service.recording = lambda: recorder.process.path
    recorder.start(driver.station, driver.started_at_ns)
    stack.callback(recorder.close)
    return recorder


def _require_writable(folder: Path) -> None:
    """Raise `StartError` for a folder that was asked for and cannot be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        with TemporaryFile(dir=folder):
            pass
    except OSError as problem:
        raise StartError(
            f"cannot write records to {folder}: {problem.strerror}; give a folder that can be "
            "written with --record"
        ) from problem


def _started(config: RunConfig, service: Service, links: LinkServer, doors: _Doors) -> Started:
    network = shared_address(config.network, doors.certificate, doors.network)
    url = url_of(config.http_host, doors.loopback)
    return Started(
        service.link_addresses, links.port, url, network=network, app_url=service.app_url
    )


def _text(folder: Path | None) -> str | None:
    return None if folder is None else str(folder)
