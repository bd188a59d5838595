"""`recon score`: fly scenarios in closed loop and print the figures of their methods."""

import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from time import monotonic
from typing import Annotated

import typer

from recon.cli.methods import warn_of_methods
from recon.cli.own_files import SCENARIO_SUFFIX, ScenarioArgument, scenario_file
from recon.cli.progress import usable_cores
from recon.forecast import FORECASTERS
from recon.record.files.users_file import state_folder
from recon.score import RunScore, Scenario, ScenarioError, load_scenario, tables
from recon.score.kept_runs import KeptRuns
from recon.score.many_runs import on_cluster, on_cores, one_by_one
from recon.score.scenario import NO_FORECAST, TRUE_MOTION
from recon.score.scenario_conditions import with_exposure
from recon.score.scenario_schema import METHOD_NAMES
from recon.score.survey_table import survey_table

MOST_SEEDS = 10_000

SeedsOption = Annotated[int, typer.Option(help="Number of runs, each with another sky.")]
FirstOption = Annotated[int, typer.Option(help="Seed of the first run; counts up.")]
MethodOption = Annotated[str | None, typer.Option(help="Overrides the scenario's method.")]
AgainstOption = Annotated[
    str | None,
    typer.Option(
        help="A forecast: score all forecast methods, and compare them with this one by seed."
        " A planner, a detection or another scenario's file: fly each seed with it too, and"
        " compare the surveys."
    ),
]
JobsOption = Annotated[
    int | None, typer.Option(help="Runs flown at once; default: one for each core.")
]
ClusterOption = Annotated[
    str | None,
    typer.Option(help="Fly the runs on the workers of a Dask scheduler, host:port."),
]
SurveysOption = Annotated[
    bool,
    typer.Option(
        "--surveys-only",
        help="Score the surveys, not shade maps and forecasts: much faster. Flights are the same.",
    ),
]
FreshOption = Annotated[
    bool, typer.Option("--fresh", help="Fly all seeds, also those that were flown before.")
]


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
    against: AgainstOption = None,
    jobs: JobsOption = None,
    cluster: ClusterOption = None,
    fresh: FreshOption = False,
    surveys_only: SurveysOption = False,
) -> None:
    """Fly a scenario by the whole station in virtual time and score its methods."""
    _check_numbers(seeds, first_seed, jobs)
    warn_of_methods()
    chosen = Chosen(planner, detection, forecast, exposure, surveys_only)
    loaded, other = chosen.scenario(scenario), chosen.other(scenario, against)
    if against is not None and other is None:
        loaded = _compared(loaded, against)
    flying = Flying(range(first_seed, first_seed + seeds), jobs, fresh, cluster)
    runs = flying.runs_of(scenario, loaded)
    others = [] if other is None else flying.runs_of(*other)
    print(tables(loaded, runs, against if other is None else None))
    if against is not None and other is not None:
        limit_s = min(loaded.limit_s, other[1].limit_s)
        print(f"\n{survey_table(runs, others, Path(against).stem, limit_s)}")


@dataclass(frozen=True, slots=True)
class Chosen:
    """The options that change a scenario."""

    planner: str | None
    detection: str | None
    forecast: str | None
    exposure: ExposureChoice | None
    surveys_only: bool

    def scenario(
        self, path: Path, planner: str | None = None, detection: str | None = None
    ) -> Scenario:
        """Return a file's scenario with them, and with another planner or detection if given."""
        names = planner or self.planner, detection or self.detection, self.forecast
        loaded = with_methods(load_scenario(path), *names)
        if self.exposure is not None:
            loaded = with_exposure(loaded, self.exposure is ExposureChoice.LOCKED)
        if self.surveys_only:
            loaded = replace(loaded, methods=replace(loaded.methods, scores_maps=False))
        return loaded

    def other(self, path: Path, against: str | None) -> tuple[Path, Scenario] | None:
        """Return the scenario to compare with and its file; None if `against` names none."""
        if against in METHOD_NAMES["planner"]:
            return path, self.scenario(path, planner=against)
        if against in METHOD_NAMES["detection"]:
            return path, self.scenario(path, detection=against)
        if against is not None and against.endswith(SCENARIO_SUFFIX):
            return scenario_file(against), self.scenario(scenario_file(against))
        return None


def runs_folder() -> Path:
    """Return where finished runs are kept."""
    return state_folder() / "score"


@dataclass(frozen=True, slots=True)
class Flying:
    """Which runs of scenarios are wanted, and where they are flown."""

    seeds: range
    jobs: int | None
    fresh: bool
    cluster: str | None = None

    def runs_of(self, path: Path, scenario: Scenario) -> list[RunScore]:
        """Return the runs of a file's scenario: those flown before, and the others, now kept."""
        kept = KeptRuns.of(runs_folder(), path, scenario)
        runs = [] if self.fresh else [run for seed in self.seeds if (run := kept.found(seed))]
        if runs:
            count = f"{len(runs)} of {len(self.seeds)}"
            _report(f"{count} runs were flown before (--fresh flies them again)")
        missing = sorted(set(self.seeds) - {run.seed for run in runs})
        flown = self._flown(scenario, missing)
        for done in _with_progress(flown, len(missing)):
            kept.keep(done)
            runs.append(done)
        return runs

    def _flown(self, scenario: Scenario, seeds: list[int]) -> Iterator[RunScore]:
        if self.cluster is not None and seeds:
            return on_cluster(scenario, seeds, self.cluster)
        at_once = min(self.jobs or usable_cores(), len(seeds))
        if at_once > 1:
            return on_cores(scenario, seeds, at_once, _report_minutes)
        return one_by_one(scenario, seeds, _report_minutes)


def _check_numbers(seeds: int, first_seed: int, jobs: int | None) -> None:
    if not (1 <= seeds <= MOST_SEEDS and first_seed >= 0):
        raise ScenarioError(
            f"expected --seeds of 1 to {MOST_SEEDS} and --first-seed of 0 or more, got {seeds} "
            f"and {first_seed}"
        )
    if jobs is not None and jobs < 1:
        raise ScenarioError(f"--jobs: expected 1 or more, got {jobs}")


def _with_progress(flown: Iterator[RunScore], count: int) -> Iterator[RunScore]:
    began_s = monotonic()
    for number, done in enumerate(flown, start=1):
        left_s = (monotonic() - began_s) / number * (count - number)
        left = f"{number} of {count} runs, about {left_s / 60.0:.0f} min left"
        _report(f"seed {done.seed}: {done.end}; {left}")
        yield done


def _report_minutes(seed: int, minutes: int, in_sun: float) -> None:
    _report(f"seed {seed}: {minutes} min, {100.0 * in_sun:.0f} % of the region imaged in sun")


def _compared(scenario: Scenario, against: str) -> Scenario:
    """Return the scenario with all forecasts scored. Raises `ScenarioError`."""
    known = (*FORECASTERS, TRUE_MOTION)
    if against not in known:
        names = " or ".join((*known, *METHOD_NAMES["planner"], *METHOD_NAMES["detection"]))
        raise ScenarioError(f"--against: expected {names}, got {against!a}")
    if not scenario.methods.scores_maps:
        raise ScenarioError(f"--surveys-only: expected --against a planner, got {against!a}")
    if scenario.methods.forecast == NO_FORECAST:
        raise ScenarioError(f"--against: expected a forecast to compare, got {NO_FORECAST}")
    return replace(scenario, methods=replace(scenario.methods, compared=known))


def with_methods(
    scenario: Scenario, planner: str | None, detection: str | None, forecast: str | None
) -> Scenario:
    """Return a scenario with other methods; None keeps one. Raises `ScenarioError`."""
    chosen = {"planner": planner, "detection": detection, "forecast": forecast}
    for kind, name in chosen.items():
        known = METHOD_NAMES[kind]
        if name is not None and name not in known:
            raise ScenarioError(f"--{kind}: expected {' or '.join(known)}, got {name!a}")
    methods = replace(
        scenario.methods,
        detection=detection or scenario.methods.detection,
        forecast=forecast or scenario.methods.forecast,
    )
    if methods.conflict is not None:
        raise ScenarioError(f"--{methods.conflict}")
    survey = replace(scenario.survey, planner=planner or scenario.survey.planner)
    return replace(scenario, methods=methods, survey=survey)


def _report(line: str) -> None:
    print(line, file=sys.stderr, flush=True)
