"""`recon sim scenario`: a scenario's fleet under its sky, for a station that runs its site."""

import asyncio
import sys
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from recon.cli.places import parse_place
from recon.cli.sim_options import FpsOption, ImageFormatOption, SeedOption, StationOption
from recon.cli.until_stopped import say_at_once, until_stopped
from recon.model.errors import ReconError
from recon.score import load_scenario
from recon.score.simulation import simulation_of
from recon.sim.app.camera_feed import FeedSettings, ImageFormat
from recon.sim.errors import SimulationError
from recon.sim.run import run_fleet

MOST_FPS_HZ = 30.0


def scenario_command(
    scenario: Annotated[Path, typer.Argument(help="A scenario's file, as in scenarios/.")],
    station: StationOption = "127.0.0.1:3001",
    fps: FpsOption = 1.0,
    image_format: ImageFormatOption = ImageFormat.RAW,
    seed: SeedOption = 0,
) -> None:
    """Run a scenario's drones and eye, its sky, wind and faults, until Ctrl+C.

    The station should run the scenario's site.
    """
    try:
        host, port = parse_place("--station", station)
        if not 0.0 < fps <= MOST_FPS_HZ:
            raise SimulationError(f"--fps: expected up to {MOST_FPS_HZ:g} a second, got {fps:g}")
        feed = FeedSettings(fps, image_format)
        config = simulation_of(load_scenario(scenario), abs(seed), feed)
        config = replace(config, station_host=host, station_port=port)
        asyncio.run(until_stopped(run_fleet(config, say_at_once), "simulation ended"))
    except ReconError as problem:
        print(f"recon sim scenario: {problem}", file=sys.stderr)
        raise typer.Exit(2) from None
