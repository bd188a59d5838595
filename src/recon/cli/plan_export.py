"""`recon plan --export`: the flights as files that other programs fly."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import time
from typing import Annotated

import typer

from recon.cli.plan_output import counted
from recon.guidance.survey import Surveyor, SurveyPlan
from recon.guidance.survey.estimate import SurveyEstimate
from recon.plans.aircraft import AIRCRAFT, PAYLOADS, aircraft_named
from recon.plans.features import FormatName
from recon.plans.flight_plan import ExportedPlan, PlanExportError
from recon.plans.formats import FORMATS, FileFacts, exported, format_of
from recon.plans.from_survey import flight_plans


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanExportOptions:
    """Files for other programs, and what they state beside the rows."""

    export: Annotated[
        list[Path] | None,
        typer.Option(
            "--export",
            metavar="FILE",
            help="Write the flights for another program, by the suffix: "
            f"{', '.join(f'{each.value} {FORMATS[each].title}' for each in FormatName)}. One file "
            "a flight where the format holds one. May be given several times.",
        ),
    ] = None
    aircraft: Annotated[
        str | None,
        typer.Option("--aircraft", help=f"For .kmz: {', '.join(AIRCRAFT)}."),
    ] = None
    payload: Annotated[
        str | None,
        typer.Option(
            "--payload", help=f"Camera of a Matrice 300, 350 or 400: {', '.join(PAYLOADS)}."
        ),
    ] = None
    by_distance: Annotated[
        bool,
        typer.Option("--by-distance", help="Export photos by distance instead of by the timer."),
    ] = False

    @property
    def paths(self) -> tuple[Path, ...]:
        """Return the files that are asked for."""
        return tuple(self.export or ())


@dataclass(frozen=True, slots=True)
class ExportedFiles:
    """The files of one `--export`, each with its waypoints, and what the pilot sets by hand."""

    title: str
    files: dict[str, int]
    by_hand: tuple[str, ...]


def export_plans(
    plan: SurveyPlan, needs: SurveyEstimate, fleet: Sequence[Surveyor], options: PlanExportOptions
) -> list[ExportedFiles]:
    """Write all files that are asked for; none if one of them cannot be.

    Raises `PlanExportError`.
    """
    if not options.paths:
        return []
    flights = flight_plans(plan, needs, fleet, {}, by_distance=options.by_distance)
    made = [_made(path, flights, options) for path in options.paths]
    for path, (found, data) in zip(options.paths, made, strict=True):
        for name in found.files:
            _write(path.parent / name, data[name])
    return [found for found, _ in made]


def rows_of_exports(exports: Sequence[ExportedFiles]) -> list[tuple[str, str]]:
    """Return the files and the sentences as rows of a table."""
    rows = []
    for each in exports:
        rows += [
            (each.title, f"{name}, {counted(n, 'waypoint')}") for name, n in each.files.items()
        ]
        rows += [(f"by hand in {each.title}", sentence) for sentence in each.by_hand]
    return rows


def _made(
    path: Path, flights: Sequence[ExportedPlan], options: PlanExportOptions
) -> tuple[ExportedFiles, dict[str, bytes]]:
    name = format_of(path.name)
    aircraft = None
    if name is FormatName.WPML:
        aircraft = aircraft_named(options.aircraft, options.payload)
    stem = path.name[: -len(name.value)]
    found = exported(name, flights, stem, FileFacts(round(1_000 * time()), aircraft))
    files = ExportedFiles(FORMATS[name].title, dict(found.waypoints), found.by_hand)
    return files, dict(found.files)


def _write(path: Path, data: bytes) -> None:
    try:
        path.write_bytes(data)
    except OSError as problem:
        raise PlanExportError(f"{path}: cannot be written: {problem.strerror or problem}") from (
            problem
        )
