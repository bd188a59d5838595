"""`recon score`: fly scenarios in closed loop and print the figures of their methods."""

import sys
from dataclasses import replace
from enum import Enum
from pathlib import Path
from time import process_time
from typing import Annotated

import typer

from recon.model.errors import ReconError
from recon.score import Methods, RunScore, Scenario, ScenarioError, load_scenario, run, tables
from recon.score.scenario_conditions import with_exposure
from recon.score.scenario_schema import METHOD_NAMES

MOST_SEEDS = 10_000

ScenarioArgument = Annotated[Path, typer.Argument(help="Scenario file, as in scenarios/.")]
SeedsOption = Annotated[int, typer.Option(help="Number of runs, each with another sky.")]
FirstOption = Annotated[int, typer.Option(help="Seed of the first run; counts up.")]
MethodOption = Annotated[str | None, typer.Option(help="Overrides the scenario's method.")]


class ExposureChoice(Enum):
    """Exposure and white balance of the imaging drone's camera."""

    AUTO = "auto"
    LOCKED = "locked"


ExposureOption = Annotated[
    ExposureChoice | None, typer.Option(help="Overrides the scenario's exposure and white balance.")
]


def score_command(
    scenario: ScenarioArgument,
    seeds: SeedsOption = 5,
    first_seed: FirstOption = 0,
    planner: MethodOption = None,
    detection: MethodOption = None,
    forecast: MethodOption = None,
    exposure: ExposureOption = None,
) -> None:
    """Fly a scenario by the whole station in virtual time and score its methods."""
    try:
        if not (1 <= seeds <= MOST_SEEDS and first_seed >= 0):
            raise ScenarioError(
                f"expected --seeds of 1 to {MOST_SEEDS} and --first-seed of 0 or more, got {seeds} "
                f"and {first_seed}"
            )
        loaded = with_methods(load_scenario(scenario), planner, detection, forecast)
        if exposure is not None:
            loaded = with_exposure(loaded, exposure is ExposureChoice.LOCKED)
    except ReconError as problem:
        print(f"recon score: {problem}", file=sys.stderr)
        raise typer.Exit(2) from None
    runs = [_flown(loaded, seed) for seed in range(first_seed, first_seed + seeds)]
    print(tables(loaded, runs))


def _flown(scenario: Scenario, seed: int) -> RunScore:
    """Fly one seed; report progress and speed."""

    def report(minutes: int, in_sun: float) -> None:
        _report(f"seed {seed}: {minutes} min, {100.0 * in_sun:.0f} % of the region imaged in sun")

    began_s = process_time()
    done = run(scenario, seed, report)
    took_s = max(process_time() - began_s, 1e-3)
    faster = done.simulated_s / took_s
    _report(f"seed {seed}: {done.end}; {faster:.0f} times faster than real time")
    return done


def with_methods(
    scenario: Scenario, planner: str | None, detection: str | None, forecast: str | None
) -> Scenario:
    """Return a scenario with other methods; None keeps one. Raises `ScenarioError`."""
    chosen = {"planner": planner, "detection": detection, "forecast": forecast}
    for kind, name in chosen.items():
        known = METHOD_NAMES[kind]
        if name is not None and name not in known:
            raise ScenarioError(f"--{kind}: expected {' or '.join(known)}, got {name!a}")
    methods = Methods(
        detection or scenario.methods.detection, forecast or scenario.methods.forecast
    )
    survey = replace(scenario.survey, planner=planner or scenario.survey.planner)
    return replace(scenario, methods=methods, survey=survey)


def _report(line: str) -> None:
    print(line, file=sys.stderr, flush=True)
