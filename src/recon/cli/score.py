"""`recon score`: scenarios flown in a closed loop, and the figures of methods."""

import sys
from dataclasses import replace
from enum import Enum
from pathlib import Path
from time import process_time
from typing import Annotated

import typer

from recon.model.errors import ReconError
from recon.score import Methods, RunScore, Scenario, ScenarioError, load_scenario, run, tables
from recon.score.fault_effects import without_effect
from recon.score.scenario_schema import METHOD_NAMES
from recon.score.whole import run_whole

MOST_SEEDS = 10_000

ScenarioArgument = Annotated[Path, typer.Argument(help="A scenario's file, as in scenarios/.")]
SeedsOption = Annotated[int, typer.Option(help="How many runs, each with a sky of its own.")]
FirstOption = Annotated[int, typer.Option(help="The first run's seed; the others follow it.")]
MethodOption = Annotated[str | None, typer.Option(help="Instead of the one in the scenario.")]


class Gear(Enum):
    """What flies a scenario."""

    STATION = "station"
    """The whole station in virtual time: packets, gate, watchdogs, rendered frames."""
    EVENTS = "events"
    """Flights worked out leg by leg, without a station: fast."""


GearOption = Annotated[
    Gear, typer.Option(help="The whole station in virtual time, or flights by events: faster.")
]


def score_command(
    scenario: ScenarioArgument,
    seeds: SeedsOption = 5,
    first_seed: FirstOption = 0,
    planner: MethodOption = None,
    detection: MethodOption = None,
    forecast: MethodOption = None,
    gear: GearOption = Gear.STATION,
) -> None:
    """Fly a scenario in a closed loop and score its methods."""
    try:
        if not (1 <= seeds <= MOST_SEEDS and first_seed >= 0):
            raise ScenarioError(
                f"expected --seeds of 1 to {MOST_SEEDS} and --first-seed of 0 or more, got {seeds} "
                f"and {first_seed}"
            )
        loaded = with_methods(load_scenario(scenario), planner, detection, forecast)
    except ReconError as problem:
        print(f"recon score: {problem}", file=sys.stderr)
        raise typer.Exit(2) from None
    unfelt = without_effect(loaded) if gear is Gear.EVENTS else []
    if unfelt:
        _say(f"faults that flights by events do not feel: {', '.join(unfelt)}")
    runs = []
    for number in range(first_seed, first_seed + seeds):
        runs.append(_flown(loaded, number, gear))
    print(tables(loaded, runs))


def _flown(scenario: Scenario, seed: int, gear: Gear) -> RunScore:
    """Fly one seed, and say how that goes and how fast it was."""

    def tell(minutes: int, in_sun: float) -> None:
        _say(f"seed {seed}: {minutes} min, {100.0 * in_sun:.0f} % of the region seen in sun")

    began_s = process_time()
    done = run(scenario, seed) if gear is Gear.EVENTS else run_whole(scenario, seed, tell)
    took_s = max(process_time() - began_s, 1e-3)
    faster = done.simulated_s / took_s
    _say(f"seed {seed}: {done.end}; {faster:.0f} times faster than real time")
    return done


def with_methods(
    scenario: Scenario, planner: str | None, detection: str | None, forecast: str | None
) -> Scenario:
    """Return a scenario with other methods; None: as before. Raises `ScenarioError`."""
    asked = {"planner": planner, "detection": detection, "forecast": forecast}
    for kind, name in asked.items():
        known = METHOD_NAMES[kind]
        if name is not None and name not in known:
            raise ScenarioError(f"--{kind}: expected {' or '.join(known)}, got {name!a}")
    methods = Methods(
        detection or scenario.methods.detection, forecast or scenario.methods.forecast
    )
    survey = replace(scenario.survey, planner=planner or scenario.survey.planner)
    return replace(scenario, methods=methods, survey=survey)


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)
