"""`recon demo`: a station, four simulated companion apps, and the console."""

import asyncio
import sys
from typing import Annotated

import typer

from recon.cli.console_files import console_folder
from recon.cli.event_loop import run_in_loop
from recon.cli.run import announce
from recon.site import demo_site_folder, load_site
from recon.station.audit_start import default_place
from recon.station.run import RunConfig, Started, run

SIMULATOR_ENDS_WITHIN_S = 3.0
ENDURANCE_MIN = 600
"""A demo is left running: its aircraft must not land by themselves after a battery's 25 minutes."""
FPS_HZ = 2


def demo_command(
    http_port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port of the console; 0 picks one.")
    ] = 8080,
    link_port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port for companion apps; 0 picks one.")
    ] = 3001,
    vehicles: Annotated[int, typer.Option(min=1, max=64, help="How many are simulated.")] = 4,
    seed: Annotated[int, typer.Option(help="The same seed flies the same way.")] = 1,
) -> None:
    """Run the station with simulated drones over a made-up field, until Ctrl+C."""
    config = RunConfig(
        site=load_site(demo_site_folder()),
        site_folder=demo_site_folder(),
        link_port=link_port,
        http_port=http_port,
        # A demonstration goes on with nothing: its drones start anew with it.
        audit=default_place(link_port=0),
        console=console_folder(),
    )
    run_in_loop(_demo(config, vehicles, seed))


async def _demo(config: RunConfig, vehicles: int, seed: int) -> None:
    simulators: list[asyncio.subprocess.Process] = []
    watching: list[asyncio.Task[None]] = []

    async def start(started: Started) -> None:
        announce(started)
        simulators.append(await _start_simulator(started.link_port, vehicles, seed))
        watching.append(asyncio.create_task(_tell_of_end(simulators[-1])))
        print("Open the console in a browser. Ctrl+C ends the demo.", flush=True)

    try:
        await run(config, start)
    finally:
        for task in watching:
            task.cancel()
        for simulator in simulators:
            await _end(simulator)


async def _start_simulator(port: int, vehicles: int, seed: int) -> asyncio.subprocess.Process:
    """The simulator is a process of its own: it speaks to the station as any app does, over TCP."""
    settings = {
        "--station": f"127.0.0.1:{port}",
        "--vehicles": vehicles,
        "--seed": seed,
        "--fps": FPS_HZ,
        "--endurance-min": ENDURANCE_MIN,
    }
    options = [str(part) for setting in settings.items() for part in setting]
    return await asyncio.create_subprocess_exec(
        sys.executable, "-m", "recon", "sim", *options, "--airborne", "--wander"
    )


async def _tell_of_end(simulator: asyncio.subprocess.Process) -> None:
    """The station goes on without the simulator, as it does when real apps go; but say so."""
    code = await simulator.wait()
    print(f"recon: the simulator ended by itself (exit code {code})", file=sys.stderr, flush=True)


async def _end(simulator: asyncio.subprocess.Process) -> None:
    if simulator.returncode is not None:
        return
    simulator.terminate()
    try:
        await asyncio.wait_for(simulator.wait(), SIMULATOR_ENDS_WITHIN_S)
    except TimeoutError:
        simulator.kill()
        await simulator.wait()
