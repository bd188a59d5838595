"""`recon demo`: a scenario, live: the station, its drones and eye in the simulator, the console."""

import asyncio
import sys
from collections.abc import Coroutine
from pathlib import Path
from typing import Annotated, Any

import typer

import recon
from recon.cli.foreground import print_now, run_in_loop
from recon.cli.run import announce, console_folder
from recon.cli.scripted_operator import fly_surveys
from recon.client import ClientError
from recon.model.errors import ReconError
from recon.score import Scenario, ScenarioError, load_scenario
from recon.station.audit.start import default_place
from recon.station.kernel.run import RunConfig, Started, run

SIMULATOR_ENDS_WITHIN_S = 3.0
STATION_ENDS_WITHIN_S = 5.0
FPS_HZ = 2
DEMO_SCENARIO = "cumulus-40.toml"
DEMO_SEED = 11
"""Of a sky that begins in sun, with shadows from the first minutes on."""


def demo_command(
    scenario: Annotated[
        Path | None, typer.Option(help="A scenario's file; else fair-weather cumulus.")
    ] = None,
    survey: Annotated[
        bool, typer.Option("--survey/--no-survey", help="Whether the drones fly by themselves.")
    ] = True,
    http_port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port of the console; 0 picks one.")
    ] = 8080,
    link_port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port for companion apps; 0 picks one.")
    ] = 3001,
    seed: Annotated[
        int, typer.Option(min=0, help="The same seed has the same sky and flies the same way.")
    ] = DEMO_SEED,
) -> None:
    """Run the station with simulated drones that survey a field.

    It runs until Ctrl+C.
    """
    try:
        path = demo_scenario_file() if scenario is None else scenario
        played = load_scenario(path)
    except ReconError as problem:
        print(f"recon demo: {problem}", file=sys.stderr)
        raise typer.Exit(2) from None
    config = RunConfig(
        site=played.site,
        link_port=link_port,
        http_port=http_port,
        # A demonstration goes on with nothing: its drones start anew with it.
        audit=default_place(link_port=0),
        console=console_folder(),
    )
    run_in_loop(_Demo(config, path, played, seed, survey).run())


def demo_scenario_file() -> Path:
    """Return the demonstration's scenario: inside the package, or in a checkout.

    Raises `ScenarioError` where there is neither.
    """
    package = Path(recon.__file__).parent
    for folder in (package / "scenarios", package.parent.parent / "scenarios"):
        if (folder / DEMO_SCENARIO).is_file():
            return folder / DEMO_SCENARIO
    raise ScenarioError(f"expected {DEMO_SCENARIO} beside the package, found none: give --scenario")


class _Demo:
    """A running demonstration: the simulator's process, and what goes on beside the station."""

    def __init__(
        self, config: RunConfig, path: Path, scenario: Scenario, seed: int, flies: bool
    ) -> None:
        self._config, self._path, self._scenario = config, path, scenario
        self._seed, self._flies = seed, flies
        self._simulator: asyncio.subprocess.Process | None = None
        self._beside: list[asyncio.Task[None]] = []

    async def run(self) -> None:
        """Run until the station ends, then end the rest."""
        try:
            await run(self._config, self._start)
        finally:
            for task in self._beside:
                task.cancel()
            await asyncio.gather(*self._beside, return_exceptions=True)
            await self._end_simulator()

    async def _start(self, started: Started) -> None:
        announce(started)
        self._simulator = await self._start_simulator(started.link_port)
        self._go_on(self._tell_of_end(self._simulator))
        if self._flies:
            self._go_on(self._fly(started.console_url))
        print("Open the console in a browser. Ctrl+C ends the demo.", flush=True)

    def _go_on(self, work: Coroutine[Any, Any, None]) -> None:
        self._beside.append(asyncio.create_task(work))
        self._beside[-1].add_done_callback(_tell_of_fault)

    async def _start_simulator(self, port: int) -> asyncio.subprocess.Process:
        """The simulator is a process of its own: it speaks to the station as any app, by TCP."""
        settings = {
            "--station": f"127.0.0.1:{port}",
            "--seed": self._seed,
            "--fps": FPS_HZ,
        }
        options = [str(part) for setting in settings.items() for part in setting]
        words = ("-m", "recon", "sim", "scenario", str(self._path), *options)
        return await asyncio.create_subprocess_exec(sys.executable, *words)

    async def _tell_of_end(self, simulator: asyncio.subprocess.Process) -> None:
        """The station goes on without the simulator, as it does without real apps; but say so."""
        code = await simulator.wait()
        told = f"recon: the simulator ended by itself (exit code {code})"
        print(told, file=sys.stderr, flush=True)

    async def _fly(self, url: str) -> None:
        try:
            await fly_surveys(url, self._scenario, print_now)
        except ClientError as problem:
            # A station that is told to end takes this task with it, and has nothing to explain.
            await asyncio.sleep(STATION_ENDS_WITHIN_S)
            print_now(f"nothing more is flown by itself: {problem}")

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


def _tell_of_fault(task: asyncio.Task[None]) -> None:
    """What goes wrong beside the station ends nothing, and is said."""
    problem = None if task.cancelled() else task.exception()
    if problem is not None:
        told = f"recon demo: {type(problem).__name__}: {problem}; the station goes on"
        print(told, file=sys.stderr, flush=True)
