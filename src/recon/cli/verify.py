"""`recon verify`: forecast methods on recorded maps, each compared with what came."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from recon.cli.output import print_line
from recon.cli.recorded_maps import (
    FolderArgument,
    RecordedMaps,
    ShadeOption,
    StepOption,
    SunOption,
    recorded_maps,
)
from recon.cli.reliability import reliability_png
from recon.forecast import FORECASTERS
from recon.model.errors import RecordError
from recon.score.forecast_figures import Calibration, LeadScore, SeenCells
from recon.score.forecast_scoring import ForecastKey
from recon.score.forecast_tables import leads_table
from recon.score.settings import SCORE
from recon.score.verification import NEAR_S, verified


def verify_command(
    folder: FolderArgument,
    step_s: StepOption = None,
    sun: SunOption = 1.0,
    shade: ShadeOption = 0.0,
    plot: Annotated[Path | None, typer.Option(help="PNG of reliability to write.")] = None,
) -> None:
    """Run all forecast methods over recorded maps and compare them with what came."""
    recorded = recorded_maps(folder, step_s, sun, shade)
    sums = verified(recorded.maps(), tuple(FORECASTERS))
    for line in _tables(sums, recorded).splitlines():
        print_line(line)
    if plot is not None:
        _draw(plot, sums, recorded.time_scale)


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


def _draw(path: Path, sums: Mapping[ForecastKey, LeadScore], scale: float) -> None:
    lead_s = SCORE.lead_s[1]
    of = ((method, (method, lead_s, SeenCells.ALL)) for method in FORECASTERS)
    curves: dict[str, Calibration] = {
        method: sums.get(key, LeadScore()).calibration for method, key in of
    }
    try:
        path.write_bytes(reliability_png(f"{lead_s * scale:g} s ahead", curves))
    except OSError as problem:
        raise RecordError(
            f"{path}: expected to write a picture, got: {problem.strerror or problem}"
        ) from problem
    print_line(f"wrote {path}")
