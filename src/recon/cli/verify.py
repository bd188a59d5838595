"""`recon verify`: forecast methods on recorded maps or light sensors, compared with what came."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from recon.cli.output import print_line
from recon.cli.recorded_maps import (
    RecordedMaps,
    ShadeOption,
    StepOption,
    SunOption,
    recorded_maps,
)
from recon.cli.reliability import reliability_png
from recon.cli.verified_points import verify_flight, verify_points
from recon.forecast import FORECASTERS
from recon.light.tables import READERS
from recon.model.errors import RecordError
from recon.score.forecast_figures import Calibration, LeadScore, SeenCells
from recon.score.forecast_scoring import ForecastKey
from recon.score.forecast_tables import leads_table
from recon.score.settings import SCORE
from recon.score.verification import NEAR_S, verified


def verify_command(
    recorded_path: Annotated[
        Path,
        typer.Argument(
            metavar="MAPS_OR_SENSORS",
            help="A folder of rasters, in the order of the times in them, else of their names; "
            "a file of light sensors (CSV, NetCDF, NPZ); or a flight record with sensors.",
        ),
    ],
    step_s: StepOption = None,
    sun: SunOption = 1.0,
    shade: ShadeOption = 0.0,
    plot: Annotated[Path | None, typer.Option(help="PNG of reliability to write.")] = None,
    places: Annotated[
        Path | None, typer.Option(help="CSV of the sensors' places, if their file has none.")
    ] = None,
    maps: Annotated[
        Path | None,
        typer.Option(help="Shade maps to hold against the sensors: a folder or a flight record."),
    ] = None,
) -> None:
    """Run all forecast methods over recorded maps or light sensors, against what came."""
    if recorded_path.suffix.lower() in READERS:
        if step_s is not None or (sun, shade) != (1.0, 0.0):
            raise RecordError("expected --step-s, --sun and --shade for a folder of rasters only")
        title, curves = verify_points(recorded_path, places, maps)
    elif recorded_path.suffix == ".mcap" and places is maps is None:
        title, curves = verify_flight(recorded_path)
    elif places is not None or maps is not None:
        raise RecordError(
            f"expected --places and --maps with a file of light sensors ({', '.join(READERS)}), "
            f"got {recorded_path}"
        )
    else:
        title, curves = _verify_maps(recorded_maps(recorded_path, step_s, sun, shade))
    if plot is not None:
        _draw(plot, title, curves)


def _verify_maps(recorded: RecordedMaps) -> tuple[str, dict[str, Calibration]]:
    """Print the scores on recorded maps; return a title and the curves of reliability."""
    sums = verified(recorded.maps(), tuple(FORECASTERS))
    for line in _tables(sums, recorded).splitlines():
        print_line(line)
    lead_s = SCORE.lead_s[1]
    curves = {
        method: sums.get((method, lead_s, SeenCells.ALL), LeadScore()).calibration
        for method in FORECASTERS
    }
    return f"{lead_s * recorded.time_scale:g} s ahead", curves


def _tables(sums: Mapping[ForecastKey, LeadScore], recorded: RecordedMaps) -> str:
    scale = recorded.time_scale
    found = leads_table(sums, tuple(FORECASTERS), scale)
    if found is None:
        raise RecordError(
            f"expected maps over more than {SCORE.lead_s[0] * scale:g} s, got "
            f"{recorded.times_s[-1]:.1f} s"
        )
    return (
        f"{len(recorded.files)} maps, {recorded.spacing}; truth is the map nearest to the lead's "
        f"time, at most {NEAR_S * scale:g} s from it\n\n{found}"
    )


def _draw(path: Path, title: str, curves: Mapping[str, Calibration]) -> None:
    try:
        path.write_bytes(reliability_png(title, curves))
    except OSError as problem:
        raise RecordError(
            f"{path}: expected to write a picture, got: {problem.strerror or problem}"
        ) from problem
    print_line(f"wrote {path}")
