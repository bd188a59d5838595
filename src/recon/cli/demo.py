"""`recon demo`: station, console and a scenario's simulated drones, in real time."""

import asyncio
import sys
from collections.abc import Coroutine, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import monotonic_ns, time, time_ns
from typing import Annotated, Any

import msgspec
import typer

from recon.cli.demo_ports import free_port
from recon.cli.demo_records import ABOUT_RECORDS, DEMO_DETAIL, demos_folder, keep_records_small
from recon.cli.foreground import print_now, run_in_loop
from recon.cli.opened_site import opened_site
from recon.cli.options import with_options
from recon.cli.own_files import console_folder, scenario_file
from recon.cli.run import HAS_GUARD, guard_port, print_started
from recon.cli.scripted_operator import fly_surveys
from recon.model.geo import LatLon
from recon.score import Scenario, ScenarioError, load_scenario
from recon.score.rehearsal import sun_over
from recon.score.scenario_sky import sky_of
from recon.score.truth import world_text
from recon.site import Site, SiteError
from recon.site.load import SITE_FILE, read_rehearsal
from recon.site.schema import RehearsalTable
from recon.station.audit.start import default_place
from recon.station.host.new_site import awaits_site, make_in_browser
from recon.station.host.run import run
from recon.station.host.run_config import RunConfig, Started

SIMULATOR_ENDS_WITHIN_S = 3.0
HTTP_PORT, LINK_PORT = 8080, 3001
FEED = ("--fps", "2", "--image-format", "jpeg", "--jpeg-quality", "75")
"""What the imaging drone sends. A record keeps frames as they came: raw ones take 5 GB an hour.
The quality is inside the range that simulated flights draw theirs from (`sim/conditions.py`)."""
BATTERIES = ("--imager-endurance-min", "600", "--battery-swap-min", "3")
"""As in a scenario: the imaging drone stays up, others fly again three minutes after landing."""
SIMULATED = "SIM-"
"""The serials of simulated drones begin with it."""
DEMO_SCENARIO = "cumulus-40"
DEMO_PLANNER = "sunlit_first"
"""The demo's planner; the usual scenario's file names the one to compare others with, and this one
states what it does and why."""
DEMO_SEED = 11
"""Seed whose sky alternates between sun and shadows from the first minute on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoOptions:
    """What is demonstrated, and where the station listens."""

    scenario: Annotated[
        Path | None,
        typer.Option(
            parser=scenario_file,
            metavar="SCENARIO",
            help="File, or name of one of Recon's own; default: fair-weather cumulus.",
        ),
    ] = None
    site: Annotated[
        Path | None,
        typer.Option(
            help="Your own site: its simulated drones wait there for your orders. An empty or "
            "missing folder: a page of the console asks where the field is, and makes the site."
        ),
    ] = None
    cover: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            max=100.0,
            help="With --site: share of the sky with clouds, percent; default: as its site.toml "
            "states under [rehearsal], or 40.",
        ),
    ] = None
    wind_mps: Annotated[
        float | None,
        typer.Option(min=0.0, max=15.0, help="With --site: wind 10 m above ground, m/s."),
    ] = None
    wind_from_deg: Annotated[
        float | None,
        typer.Option(min=0.0, max=360.0, help="With --site: where the wind comes from, degrees."),
    ] = None
    survey: Annotated[
        bool, typer.Option("--survey/--no-survey", help="Fly surveys with a scripted operator.")
    ] = True
    http_port: Annotated[
        int | None,
        typer.Option(
            min=0,
            max=65535,
            help="Port of the console; 0 picks one; default: 8080, or the next free one.",
        ),
    ] = None
    link_port: Annotated[
        int | None,
        typer.Option(
            min=0,
            max=65535,
            help="Port for companion apps; 0 picks one; default: 3001, or the next free one.",
        ),
    ] = None
    seed: Annotated[int, typer.Option(min=0, help="Seed of sky, wind and faults.")] = DEMO_SEED
    record: Annotated[
        Path | None,
        typer.Option(
            "--record",
            help="Folder of the flight records, which stay; default: one whose oldest records of "
            "demos are deleted.",
        ),
    ] = None
    no_record: Annotated[bool, typer.Option("--no-record", help="Record no flights.")] = False

    def rehearsal(self, folder: Path) -> RehearsalTable:
        """The sky and wind over a site: as asked for, else as its folder states."""
        given = {
            "cloud_cover_percent": self.cover,
            "wind_mps": self.wind_mps,
            "wind_from_deg": self.wind_from_deg,
        }
        asked = {key: value for key, value in given.items() if value is not None}
        return msgspec.structs.replace(read_rehearsal(folder), **asked)

    @property
    def console_port(self) -> int:
        """The port asked for, or the usual one, or the next free one."""
        if self.http_port is not None:
            return self.http_port
        return free_port(HTTP_PORT, "the console is", together=2 if HAS_GUARD else 1)

    @property
    def app_port(self) -> int:
        """The same of the port for companion apps."""
        return free_port(LINK_PORT, "apps connect") if self.link_port is None else self.link_port

    def config(self, site: Site, http_port: int) -> RunConfig:
        """Return how the station of a site is started."""
        return RunConfig(
            site=site,
            link_port=self.app_port,
            http_port=http_port,
            stop_port=guard_port(None, http_port, self.link_port or 0) if HAS_GUARD else None,
            # No state of an earlier run is recovered: its drones no longer exist.
            audit=default_place(link_port=0),
            record_folder=None if self.no_record else self.record or demos_folder(),
            is_record_required=self.record is not None,
            record_detail=DEMO_DETAIL,
            console=console_folder(),
        )


@with_options
def demo_command(options: DemoOptions) -> None:
    """Run the station with simulated drones that survey a field.

    It runs until Ctrl+C.
    """
    demo = _played(options) if options.site is None else rehearsed(options.site, options)
    run_in_loop(demo.run())


def _played(options: DemoOptions) -> "Demo":
    """Return the demonstration of a scenario; raises `ReconError`."""
    path = scenario_file(DEMO_SCENARIO) if options.scenario is None else options.scenario
    played, seed = load_scenario(path), options.seed
    if options.scenario is None:
        played = replace(played, survey=replace(played.survey, planner=DEMO_PLANNER))
    # The record states when the sky's time began, so that its truth is known.
    began_ns, start_ns = time_ns(), monotonic_ns()
    config = replace(
        options.config(played.site, options.console_port),
        repeats_surveys=options.survey,
        scenario=world_text(path, seed, began_ns),
        sun_time_ahead_s=sky_of(played, seed).settings.sun.start_utc_s - time(),
    )
    words = ("scenario", str(path), *FEED, "--seed", str(seed))
    flies = played if options.survey else None
    return Demo(config, (*words, "--start-ns", str(start_ns)), flies)


def rehearsed(folder: Path, options: DemoOptions) -> "Demo":
    """Return a station with simulated drones on a site of one's own; raises `ReconError`."""
    if options.scenario is not None:
        raise ScenarioError("expected --site or --scenario, got both: a scenario has a site")
    http_port = options.console_port
    if awaits_site(folder):
        http_port = _made_in_browser(folder, http_port)
    if not (folder / SITE_FILE).is_file():
        raise SiteError(
            f"{folder}: expected a site's folder, or an empty one to make a site in, got one "
            f"without {SITE_FILE} that is not empty"
        )
    own = opened_site(folder)
    simulated = [serial for serial in own.profiles if serial.startswith(SIMULATED)]
    if not simulated:
        raise SiteError(
            f"{folder}: expected [[vehicles]] with a serial that begins with {SIMULATED}, got "
            "none; recon site new makes a site with three"
        )
    if not own.imagers:
        print_now(
            f"{folder} has no imaging drone: no ground image, sun or forecast. Add a simulated one "
            f"with recon site imager {folder}"
        )
    air = options.rehearsal(folder)
    assert own.frame is not None, "a folder's site has an origin"
    origin = own.frame.origin
    sun = sun_over(LatLon(origin.latitude_deg, origin.longitude_deg))
    config = replace(
        options.config(own, http_port),
        site_folder=folder,
        is_record_required=False,
        sun_time_ahead_s=sun.start_utc_s - time(),
    )
    vehicles = len(simulated) + len(own.imagers.keys() - simulated)
    words = ("--site", str(folder), "--vehicles", str(vehicles), "--seed", str(options.seed))
    sky = ("--cover", f"{air.cloud_cover_percent:g}", "--wind-mps", f"{air.wind_mps:g}")
    wind = ("--wind-to-deg", f"{(air.wind_from_deg + 180.0) % 360.0:g}")
    imager = ("--imager", *FEED) if own.imagers else ("--no-imager",)
    # Fences change on the ground only: while there is no field to rehearse over, they are drawn.
    start = () if own.layers.survey_regions else ("--grounded",)
    return Demo(config, (*words, *sky, *wind, *BATTERIES, *imager, *start), None)


def _made_in_browser(folder: Path, http_port: int) -> int:
    """Let a site be made in the browser; return the port for its console."""
    console = console_folder()
    if console is None:
        raise SiteError(
            f"{folder} holds no site, and the console, which would make one, is not built; make "
            f"the site with recon site new {folder} --at LAT,LON --ground-above-sea-level 278m"
        )
    port = run_in_loop(make_in_browser(folder, http_port, console, _print_page))
    if port is None:
        raise typer.Exit(0)
    return port


def _print_page(url: str) -> None:
    print_now(f"console: {url}")
    print_now("Open it in a browser: it asks where the field is. Ctrl+C ends the demo.")


class Demo:
    """A running demonstration: the simulator's process and the tasks beside the station."""

    def __init__(
        self, config: RunConfig, simulator_words: Sequence[str], flown: Scenario | None
    ) -> None:
        """Take what the simulator is started with, and the scenario whose surveys are flown."""
        self._config, self.simulator_words, self._flown = config, tuple(simulator_words), flown
        self._simulator: asyncio.subprocess.Process | None = None
        self._beside: list[asyncio.Task[None]] = []

    async def run(self) -> None:
        """Run until the station ends, then end simulator and tasks."""
        try:
            await run(self._config, self._start)
        finally:
            for task in self._beside:
                task.cancel()
            await asyncio.gather(*self._beside, return_exceptions=True)
            await self._end_simulator()

    async def _start(self, started: Started) -> None:
        print_started(started)
        if self._config.record_folder == demos_folder():
            print_now(ABOUT_RECORDS)
            self._add_task(keep_records_small())
        self._simulator = await self._start_simulator(started.link_port)
        self._add_task(self._report_end(self._simulator))
        if self._flown is not None:
            self._add_task(fly_surveys(started.console_url, self._flown, print_now))
        print("Open the console in a browser. Ctrl+C ends the demo.", flush=True)

    def _add_task(self, work: Coroutine[Any, Any, None]) -> None:
        self._beside.append(asyncio.create_task(work))
        self._beside[-1].add_done_callback(_report_fault)

    async def _start_simulator(self, port: int) -> asyncio.subprocess.Process:
        """Start the simulator as a process of its own; it connects over TCP as any app does."""
        words = ("-m", "recon", "sim", *self.simulator_words, "--station", f"127.0.0.1:{port}")
        return await asyncio.create_subprocess_exec(sys.executable, *words)

    async def _report_end(self, simulator: asyncio.subprocess.Process) -> None:
        """The station runs on without the simulator, as it does without real apps."""
        code = await simulator.wait()
        print(f"recon: the simulator ended (exit code {code})", file=sys.stderr, flush=True)

    async def _end_simulator(self) -> None:
        simulator = self._simulator
        if simulator is None or simulator.returncode is not None:
            return
        simulator.terminate()
        try:
            await asyncio.wait_for(simulator.wait(), SIMULATOR_ENDS_WITHIN_S)
        except TimeoutError:
            simulator.kill()
            await simulator.wait()


def _report_fault(task: asyncio.Task[None]) -> None:
    """Report a failed task; the station runs on."""
    problem = None if task.cancelled() else task.exception()
    if problem is not None:
        line = f"recon demo: {type(problem).__name__}: {problem}; the station runs on"
        print(line, file=sys.stderr, flush=True)
