"""`recon run`: the station on real sockets, until SIGINT or SIGTERM."""

import asyncio
import errno
import getpass
import signal
import socket
from collections.abc import Awaitable, Callable, Iterator
from contextlib import AsyncExitStack, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

import uvicorn

from recon import version
from recon.api.app import create_app
from recon.api.connections import PING_S, HttpConnection, StreamConnection
from recon.api.security import LOCAL_PERSON, LOOPBACK_NAMES, Access
from recon.fleet.admission import AllowedApp
from recon.link.capture import Capture
from recon.link.server import LinkServer
from recon.link.settings import LinkSettings
from recon.model.errors import ReconError, RecordError
from recon.model.event import Event
from recon.model.person import THIS_COMPUTER, Person, Role, is_name
from recon.model.units import ns_to_seconds
from recon.site import Site
from recon.site.reading import site_digest
from recon.station.api_views.service import Service
from recon.station.audit.auditor import Auditor, LogPrinter
from recon.station.audit.start import (
    AuditPlace,
    Begun,
    begin_audit,
    default_place,
    ended_entry,
    started_entry,
)
from recon.station.kernel.app_list_writer import AppListWriter
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver, freeze_loaded_objects, station_clock
from recon.station.kernel.worker import JobRunner, ThreadWorker
from recon.station.recovery.restart import LastRun, restart_entries, restored
from recon.station.recovery.snapshot_writer import SnapshotWriter, load_last_run
from recon.station.state.station import Station

HTTP_BACKLOG = 128
SHUTDOWN_S = 2


class StartError(ReconError):
    """The station cannot start; the text states why, and what to do."""


@dataclass(frozen=True, slots=True)
class RunConfig:
    """How a station is started. Everything binds loopback by default."""

    site: Site
    link_host: str = "127.0.0.1"
    link_port: int = 3001
    http_host: str = "127.0.0.1"
    http_port: int = 8080
    site_folder: Path | None = None
    """Where the site was read from; its digest goes into the audit."""
    capture_folder: Path | None = None
    audit: AuditPlace | None = None
    """None: the place in the user's state folder that belongs to the link port."""
    token: str | None = None
    console: Path | None = None
    link: LinkSettings = field(default_factory=LinkSettings)
    apps_file: Path | None = None
    """The list of admitted apps; None: any app is admitted."""
    apps: tuple[AllowedApp, ...] | None = None
    """The entries of that file."""


@dataclass(frozen=True, slots=True)
class Started:
    """Where a station listens."""

    link_addresses: list[str]
    link_port: int
    console_url: str
    audit_folder: str = ""
    apps_listed: int | None = None
    """Entries of the list of apps; None without a list."""
    taken_up: str = ""
    """What this run continues from the last one, in words; empty if nothing."""


Observe = Callable[[Station, Station, Event], None]
OnStart = Callable[[Started], Awaitable[None]]


async def run(config: RunConfig, on_start: OnStart) -> None:
    """Run a station until SIGINT or SIGTERM. Raises `StartError` when it cannot start."""
    _require_token(config)
    place = config.audit or default_place(config.link_port)
    begun = _begin_audit(place)
    last_run, is_snapshot_good = _last_run(place, begun)
    http_socket = _listen(config.http_host, config.http_port, "--http-port")
    async with AsyncExitStack() as stack:
        stack.callback(http_socket.close)
        clock = station_clock()
        station = restored(first_state(config.site, apps=config.apps), last_run, clock())
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
        service = Service.around(
            driver, config.site, _text(config.capture_folder), begun.log, last_run.first_ids[0]
        )
        links = await _start_links_and_worker(config, driver, service, stack)
        started = replace(
            _started(config, service, links, http_socket),
            audit_folder=str(begun.log.folder),
            apps_listed=None if config.apps is None else len(config.apps),
            taken_up=_taken_up(station, (*begun.troubles, *last_run.troubles)),
        )
        await _serve(config, driver, service, http_socket, lambda: on_start(started), stack)


async def _start_links_and_worker(
    config: RunConfig, driver: AsyncioDriver, service: Service, stack: AsyncExitStack
) -> LinkServer:
    capture = _start_capture(config, driver)
    if capture is not None:
        stack.callback(capture.close)
    driver.worker = worker = ThreadWorker(JobRunner(config.site), driver.handle_from_thread)
    driver.links = links = LinkServer(driver.handle, driver.now_ns, config.link, capture)
    links.objection = driver.objection
    service.link_addresses = await _listen_for_links(links, config)
    stack.push_async_callback(links.stop)
    worker.start()
    stack.callback(worker.stop)
    return links


async def _serve(
    config: RunConfig,
    driver: AsyncioDriver,
    service: Service,
    http_socket: socket.socket,
    on_start: Callable[[], Awaitable[None]],
    stack: AsyncExitStack,
) -> None:
    """Run the driver's timers and the HTTP server until one of the two ends."""
    ticking = asyncio.create_task(driver.run())
    stack.callback(ticking.cancel)
    server = _http_server(config, service)
    freeze_loaded_objects()
    stack.enter_context(_stopped_by_signals(server))
    serving = asyncio.create_task(server.serve(sockets=[http_socket]))
    await on_start()
    done, _ = await asyncio.wait((serving, ticking), return_when=asyncio.FIRST_COMPLETED)
    # If the timers have ended, the station must not seem to run.
    server.should_exit = True
    await serving
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


def _require_token(config: RunConfig) -> None:
    if config.http_host not in LOOPBACK_NAMES and config.token is None:
        raise StartError(
            f"host {config.http_host} opens the console to the network without a token; give "
            "--token-file FILE with a secret of at least 16 characters, or use 127.0.0.1"
        )


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

    def observe(before: Station, after: Station, event: Event) -> None:
        first(before, after, event)
        second(before, after, event)

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
    settings, folder = first_state(config.site).settings, config.site_folder
    site = {
        "name": config.site.name,
        "folder": _text(folder),
        "sha256": None if folder is None else site_digest(folder),
    }
    troubles = (*begun.troubles, *last_run.troubles)
    first_ids = last_run.first_ids
    auditor.put([started_entry(settings, site, begun.ended_in_order, first_ids, troubles)])
    return auditor


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


def _listen(host: str, port: int, option: str) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    sock = socket.socket(family, socket.SOCK_STREAM)
    try:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        sock.bind((host, port))
        # Listen at once: the address must be open when it is printed, and a second station started
        # at the same moment must find the port in use.
        sock.listen(HTTP_BACKLOG)
    except (OSError, OverflowError) as problem:
        sock.close()
        raise _cannot_listen(host, port, option, problem) from problem
    return sock


def _cannot_listen(host: str, port: int, option: str, problem: Exception) -> StartError:
    if isinstance(problem, OSError) and problem.errno == errno.EADDRINUSE:
        return StartError(
            f"port {port} of {host} is in use, perhaps by another station; stop that one, or "
            f"choose another port with {option}"
        )
    reason = problem.strerror if isinstance(problem, OSError) else problem
    return StartError(f"cannot listen on {host} port {port}: {reason}; see {option}")


async def _listen_for_links(links: LinkServer, config: RunConfig) -> list[str]:
    try:
        return await links.start(config.link_host, config.link_port)
    except (OSError, OverflowError) as problem:
        raise _cannot_listen(
            config.link_host, config.link_port, "--link-port", problem
        ) from problem


def _start_capture(config: RunConfig, driver: AsyncioDriver) -> Capture | None:
    if config.capture_folder is None:
        return None
    run_name = f"{ns_to_seconds(driver.started_at_ns):.0f}"
    capture = Capture(config.capture_folder, run_name, config.link.capture_limit_bytes)
    try:
        capture.start()
    except OSError as problem:
        raise StartError(
            f"cannot write captures to {config.capture_folder}: {problem.strerror}; give a folder "
            "that can be written with --capture"
        ) from problem
    return capture


class _HttpServer(uvicorn.Server):
    """Uvicorn without its own signal handling.

    That would raise the signal again once the server has ended, and so kill the process before the
    links are closed and the captures written.
    """

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Leave signals alone; `_stopped_by_signals` takes them."""
        yield


@contextmanager
def _stopped_by_signals(server: uvicorn.Server) -> Iterator[None]:
    """End the server on SIGINT and SIGTERM; the second one does not wait for open requests."""
    loop = asyncio.get_running_loop()
    numbers = (signal.SIGINT, signal.SIGTERM)

    def stop() -> None:
        server.force_exit = server.should_exit
        server.should_exit = True

    for number in numbers:
        loop.add_signal_handler(number, stop)
    try:
        yield
    finally:
        for number in numbers:
            loop.remove_signal_handler(number)


def _http_server(config: RunConfig, service: Service) -> uvicorn.Server:
    access = Access.make(config.http_host, config.token, local_person())
    app = create_app(service, access, config.console, version())
    return _HttpServer(
        uvicorn.Config(
            app,
            log_level="warning",
            access_log=False,
            server_header=False,
            http=HttpConnection,
            # Its send waits while the reader's socket takes no more: see api/streams.py.
            ws=StreamConnection,
            ws_max_size=64 * 1024,
            ws_ping_interval=PING_S,
            ws_ping_timeout=PING_S,
            timeout_graceful_shutdown=SHUTDOWN_S,
            lifespan="off",
        )
    )


def local_person() -> Person:
    """Return the person of requests over loopback: the user of this computer.

    An administrator: programs of this user can end the station and write its files anyway.
    """
    try:
        name = getpass.getuser()
    except (OSError, KeyError, ImportError):
        return LOCAL_PERSON
    return Person(name, Role.ADMIN, THIS_COMPUTER) if is_name(name) else LOCAL_PERSON


def _started(
    config: RunConfig, service: Service, links: LinkServer, http_socket: socket.socket
) -> Started:
    port = http_socket.getsockname()[1]
    host = f"[{config.http_host}]" if ":" in config.http_host else config.http_host
    fragment = "" if config.token is None else f"/#token={config.token}"
    return Started(service.link_addresses, links.port, f"http://{host}:{port}{fragment}")


def _text(folder: Path | None) -> str | None:
    return None if folder is None else str(folder)
