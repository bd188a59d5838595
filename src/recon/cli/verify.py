"""`recon verify`: forecast methods on recorded maps, each compared with what came."""

import sys
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from recon.cli.connection import WRONG_USE
from recon.cli.output import print_line, printable
from recon.cli.progress import progress_over
from recon.cli.reliability import reliability_png
from recon.forecast import FORECASTERS
from recon.model.errors import ReconError, RecordError
from recon.model.shade import ShadeMap
from recon.model.units import seconds_to_ns
from recon.record.map_sequence import RecordedMap, captured_utc, map_files, read_map
from recon.score.forecast_figures import Calibration, LeadScore, SeenCells
from recon.score.forecast_scoring import ForecastKey
from recon.score.settings import SCORE
from recon.score.table_rows import NOTHING, fine, finest, table
from recon.score.verification import time_scale, unplaced_grid, verified

UNEVEN = 0.5
"""A gap that differs by more than this share from the usual one is no even sequence."""


def verify_command(
    folder: Annotated[Path, typer.Argument(help="Rasters in the order of their names.")],
    step_s: Annotated[
        float | None,
        typer.Option(help="Seconds between them; default: from the times in Recon's own maps."),
    ] = None,
    sun: Annotated[float, typer.Option(help="The value that is full sun.")] = 1.0,
    shade: Annotated[float, typer.Option(help="The value that is full shade.")] = 0.0,
    plot: Annotated[Path | None, typer.Option(help="PNG of reliability to write.")] = None,
) -> None:
    """Run all forecast methods over recorded maps and compare them with what came."""
    try:
        if not np.isfinite([sun, shade]).all() or sun == shade:
            raise RecordError(f"expected two different numbers, got --sun {sun} --shade {shade}")
        if step_s is not None and not 0.1 <= step_s <= 86_400.0:
            raise RecordError(f"--step-s: expected 0.1 to 86400 seconds, got {step_s:g}")
        files = map_files(folder)
        step_s = step_s or _step_s(files)
        scale = time_scale(step_s)
        maps = _maps(files, step_s / scale, sun, shade)
        sums = verified(maps, tuple(FORECASTERS), step_s / scale)
        for line in _tables(sums, len(files), step_s, scale).splitlines():
            print_line(line)
        if plot is not None:
            _draw(plot, sums, scale)
    except ReconError as problem:
        print(f"recon verify: {printable(str(problem))}", file=sys.stderr)
        raise typer.Exit(WRONG_USE) from None


def _step_s(files: Sequence[Path]) -> float:
    """Return the usual time between maps, from the times in them."""
    known = [each for each in map(captured_utc, files) if each is not None]
    if len(known) < len(files):
        raise RecordError(f"{files[0].parent}: expected --step-s, for not all maps have a time")
    gaps_s = np.diff([datetime.timestamp(each) for each in known])
    usual_s = float(np.median(gaps_s))
    if usual_s <= 0.0 or (np.abs(gaps_s - usual_s) > UNEVEN * usual_s).any():
        raise RecordError(
            f"{files[0].parent}: expected maps at even times in the order of their names, got "
            f"gaps of {gaps_s.min():.1f} to {gaps_s.max():.1f} s"
        )
    return usual_s


def _maps(files: Sequence[Path], step_s: float, sun: float, shade: float) -> Iterator[ShadeMap]:
    """Yield the maps, `step_s` apart in the methods' time."""
    shape: tuple[int, ...] | None = None
    for number, path in enumerate(progress_over(files, "forecasting", len(files))):
        found = read_map(path, sun, shade)
        if shape is not None and found.valid.shape != shape:
            raise RecordError(f"{path}: expected {shape} cells as before, got {found.valid.shape}")
        shape = found.valid.shape
        yield _shade_map(found, seconds_to_ns(number * step_s))


def _shade_map(found: RecordedMap, at_ns: int) -> ShadeMap:
    rows, cols = found.valid.shape
    known = found.valid.astype(np.float32)
    grid = unplaced_grid(rows, cols)
    return ShadeMap(grid, at_ns, (), found.transmittance, found.valid, known, known)


def _tables(sums: Mapping[ForecastKey, LeadScore], count: int, step_s: float, scale: float) -> str:
    leads = [lead_s for lead_s in SCORE.lead_s if _of(sums, "persistence", lead_s).cells]
    if not leads:
        longest_s = (count - 1) * step_s
        raise RecordError(
            f"expected maps over more than {SCORE.lead_s[0] * scale:g} s, got {longest_s:g} s"
        )
    head = f"{count} maps, {step_s:g} s apart; truth is the map of the lead's time"
    names = [f"{lead_s * scale:g} s" for lead_s in leads]
    parts = [head]
    for title, figure in (("Brier", _brier), ("shade IoU", _iou)):
        rows = [
            (method, *(figure(_of(sums, method, lead_s)) for lead_s in leads))
            for method in FORECASTERS
        ]
        parts.append(table((title, *names), rows))
    return "\n\n".join(parts)


def _of(sums: Mapping[ForecastKey, LeadScore], method: str, lead_s: float) -> LeadScore:
    return sums.get((method, lead_s, SeenCells.ALL), LeadScore())


def _brier(score: LeadScore) -> str:
    return NOTHING if score.brier is None else finest(score.brier)


def _iou(score: LeadScore) -> str:
    return NOTHING if score.shade.iou is None else fine(score.shade.iou)


def _draw(path: Path, sums: Mapping[ForecastKey, LeadScore], scale: float) -> None:
    lead_s = SCORE.lead_s[1]
    curves: dict[str, Calibration] = {
        method: _of(sums, method, lead_s).calibration for method in FORECASTERS
    }
    try:
        path.write_bytes(reliability_png(f"{lead_s * scale:g} s ahead", curves))
    except OSError as problem:
        raise RecordError(
            f"{path}: expected to write a picture, got: {problem.strerror or problem}"
        ) from problem
    print_line(f"wrote {path}")
