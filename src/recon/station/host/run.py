"""`recon run`: the station on real sockets, until SIGINT or SIGTERM."""

import asyncio
from collections.abc import Callable, Mapping
from contextlib import AsyncExitStack, ExitStack
from pathlib import Path
from tempfile import TemporaryFile

from recon.api.addresses import app_hosts, app_url, in_url
from recon.detection import DetectionSettings
from recon.forecast import ForecastSettings
from recon.link.server import LinkServer
from recon.model.errors import RecordError
from recon.model.event import RecordFailed
from recon.record.mcap.record_process import IS_SUPPORTED
from recon.site import own_folder
from recon.site.reading import FLOWN_FOLDER, site_digest
from recon.site.vehicle_numbers import NUMBERS_FILE, numbers_text, read_numbers
from recon.station.api_views.service import Service
from recon.station.api_views.vehicle_numbers import VehicleNumbers
from recon.station.audit.auditor import Auditor, LogPrinter
from recon.station.audit.log_line import print_warning
from recon.station.audit.start import (
    AuditPlace,
    Begun,
    begin_audit,
    default_place,
    ended_entry,
    started_entry,
)
from recon.station.host.announcing import announce, require_announceable
from recon.station.host.app_list_writer import AppListWriter
from recon.station.host.guard_line import GuardLine, take_over_from_orphan
from recon.station.host.http_servers import (
    StartError,
    cannot_listen,
    certificate_of,
    listen,
    require_startable,
)
from recon.station.host.light_input import start_light_input
from recon.station.host.rewritten_file import RewrittenFile
from recon.station.host.run_config import OnStart, RunConfig, Started
from recon.station.host.serving import Doors, open_doors, serve
from recon.station.imaging.references import with_references
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver, station_clock
from recon.station.kernel.worker import JobRunner, ThreadWorker
from recon.station.recording.recording import Recorder, record_process
from recon.station.recovery.flown_regions import FlownRegions
from recon.station.recovery.restart import LastRun, restart_entries, restored
from recon.station.recovery.snapshot_writer import SnapshotWriter, load_last_run
from recon.station.state.settings import StationSettings
from recon.station.state.station import Station
from recon.station.state.steps import StepTaken

Observe = Callable[[StepTaken], None]


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
        doors = open_doors(config, certificate, stack)
        clock = station_clock()
        begins = first_station(config)
        station = restored(begins, last_run, clock())
        auditor = _start_auditor(config, begun, last_run, clock, stack)
        auditor.put(restart_entries(station))
        flown = _flown_regions(config, place, stack)
        observe = _both(flown.observe, auditor.observe)
        driver = AsyncioDriver(station, clock, observe)
        auditor.handle = driver.handle
        if not place.is_shared:
            last_id = last_run.first_ids[0] - 1
            snapshots = SnapshotWriter(
                place.folder, clock, last_order_id=last_id, keep_current=is_snapshot_good
            )
            auditor.snapshot_problem = lambda: snapshots.problem or flown.problem
            _start_snapshots(snapshots, driver, observe, stack)
        _write_app_list(config, driver, stack)
        folder = _text(config.record_folder)
        service = Service.around(driver, config.site, folder, begun.log, last_run.first_ids[0])
        service.repeats_surveys = config.repeats_surveys
        service.edit(config.site_folder)
        recorder = _start_record(config, driver, auditor, service, stack)
        service.numbers = kept_numbers(given, numbers_file, stack)
        service.flown = flown
        line = _start_guard(config, driver, service, doors, place.folder, stack)
        links = await _start_links_and_worker(config, driver, service, line, recorder, stack)
        if config.is_announced:
            _announce(config, links, last)
        lights = config.light_sensors and await start_light_input(
            config.light_sensors, config.site.frame, driver.handle, stack
        )
        started = Started(
            link_addresses=service.link_addresses,
            link_port=links.port,
            console_url=doors.url,
            network=doors.shared,
            app_url=service.app_url,
            stop_url=None if line is None else line.stop_url,
            audit_folder=str(begun.log.folder),
            record_folder=folder or "",
            light_sensors=lights or "",
            apps_listed=None if config.apps is None else len(config.apps),
            resumed=_resumed_state(station, (*begun.troubles, *last_run.troubles)),
        )
        auditor.printer.start()
        await serve(config, driver, service, doors, lambda: on_start(started), stack)


def _start_snapshots(
    snapshots: SnapshotWriter, driver: AsyncioDriver, observe: Observe, stack: AsyncExitStack
) -> None:
    driver.observe = _both(snapshots.observe, observe)
    snapshots.start(driver.station)
    stack.callback(snapshots.close)


def _announce(config: RunConfig, links: LinkServer, last: AsyncExitStack) -> None:
    name = "Recon" if config.site_folder is None else config.site.name
    announce(name, links.hosts, links.port, last)


def _flown_regions(config: RunConfig, place: AuditPlace, stack: AsyncExitStack) -> FlownRegions:
    """Return what is kept of surveyed regions: with the site, else with this port's audit."""
    folder = own_folder(config.site_folder)
    if folder is None and not place.is_shared:
        folder = place.folder
    flown = FlownRegions(None if folder is None else folder / FLOWN_FOLDER)
    for trouble in flown.troubles:
        print_warning(trouble)
    flown.start()
    stack.callback(flown.close)
    return flown


def _numbers_file(config: RunConfig, place: AuditPlace) -> Path | None:
    """Return where the vehicles' numbers are kept: with the site, else with this port's audit."""
    folder = own_folder(config.site_folder)
    if folder is not None:
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
        print_warning(f"vehicle numbers: {problem}")


async def _start_links_and_worker(
    config: RunConfig,
    driver: AsyncioDriver,
    service: Service,
    line: GuardLine | None,
    recorder: Recorder | None,
    stack: AsyncExitStack,
) -> LinkServer:
    runner = JobRunner(config.site, isolates=True)
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
    doors: Doors,
    folder: Path,
    stack: AsyncExitStack,
) -> GuardLine | None:
    """Start the guard, after the one of a station that has died here has given way."""
    interventions = take_over_from_orphan(folder)
    if config.stop_port is None:
        return None
    stop_socket = listen("127.0.0.1", config.stop_port, "--stop-port")
    line = GuardLine(driver, service, stop_socket, doors.url)
    service.guard_stop_url = line.stop_url
    stack.callback(line.close)
    line.write_port(folder)
    for intervention in interventions:
        line.take(intervention)
    guarding = asyncio.create_task(line.run())
    stack.callback(guarding.cancel)
    return line


def _write_app_list(config: RunConfig, driver: AsyncioDriver, stack: AsyncExitStack) -> None:
    """Write pairings to the list's file while the station runs."""
    if config.apps_file is None or driver.observe is None:
        return
    writer = AppListWriter(config.apps_file, driver.handle_from_thread)
    driver.observe = _both(driver.observe, writer.observe)
    writer.start()
    stack.callback(writer.close)


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
    station = first_state(config.site, _settings(config), config.apps)
    folder = own_folder(config.site_folder)
    return station if folder is None else with_references(station, folder)


def _settings(config: RunConfig) -> StationSettings:
    return StationSettings(
        failsafe_matrix=config.site.failsafe,
        detection=DetectionSettings(method=config.detection),
        forecast=ForecastSettings(config.forecast, wind_aloft_mps=config.wind_aloft_mps),
        sun_time_ahead_s=config.sun_time_ahead_s,
    )


def _resumed_state(station: Station, troubles: tuple[str, ...]) -> str:
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
        lambda: record_process(folder),
        driver.handle,
        auditor,
        config.site,
        config.scenario,
        config.record_detail,
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


def _text(folder: Path | None) -> str | None:
    return None if folder is None else str(folder)
