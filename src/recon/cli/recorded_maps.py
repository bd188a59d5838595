"""Folders of maps: as `recon verify` and `recon forecast` read them, and where one is written."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from recon.cli.progress import progress_over
from recon.model.errors import RecordError
from recon.model.shade import ShadeMap
from recon.model.units import seconds_to_ns
from recon.record.raster.map_sequence import RecordedMap, captured_utc, map_files, read_map
from recon.score.verification import time_scale, unplaced_grid

UNEVEN = 0.5
"""A gap that differs by more than this share from the usual one is no even sequence."""

FolderArgument = Annotated[Path, typer.Argument(help="Rasters in the order of their names.")]
StepOption = Annotated[
    float | None,
    typer.Option(help="Seconds between them; default: from the times in Recon's own maps."),
]
SunOption = Annotated[float, typer.Option(help="The value that is full sun.")]
ShadeOption = Annotated[float, typer.Option(help="The value that is full shade.")]


@dataclass(frozen=True, slots=True)
class RecordedMaps:
    """Files in order, the seconds between them, and the values of full sun and full shade."""

    files: Sequence[Path]
    step_s: float
    sun: float
    shade: float

    @property
    def time_scale(self) -> float:
        """Seconds of the sequence for one of the methods."""
        return time_scale(self.step_s)

    def maps(self) -> Iterator[ShadeMap]:
        """Yield the maps, in the methods' time, with a progress bar; raises `RecordError`."""
        shape: tuple[int, ...] | None = None
        for number, path in enumerate(progress_over(self.files, "forecasting", len(self.files))):
            found = read_map(path, self.sun, self.shade)
            if shape is not None and found.valid.shape != shape:
                raise RecordError(
                    f"{path}: expected {shape} cells as before, got {found.valid.shape}"
                )
            shape = found.valid.shape
            yield _shade_map(found, seconds_to_ns(number * self.step_s / self.time_scale))


def recorded_maps(folder: Path, step_s: float | None, sun: float, shade: float) -> RecordedMaps:
    """Return the maps of a folder; raises `RecordError` for options or times that do not fit."""
    if not np.isfinite([sun, shade]).all() or sun == shade:
        raise RecordError(f"expected two different numbers, got --sun {sun} --shade {shade}")
    if step_s is not None and not 0.1 <= step_s <= 86_400.0:
        raise RecordError(f"--step-s: expected 0.1 to 86400 seconds, got {step_s:g}")
    files = map_files(folder)
    return RecordedMaps(files, step_s or _step_s(files), sun, shade)


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


def _shade_map(found: RecordedMap, at_ns: int) -> ShadeMap:
    rows, cols = found.valid.shape
    known = found.valid.astype(np.float32)
    grid = unplaced_grid(rows, cols)
    return ShadeMap(grid, at_ns, (), found.transmittance, found.valid, known, known)


def refuse_used(out: Path) -> None:
    """Raise `RecordError` for a folder that cannot take new maps: it holds something."""
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise RecordError(f"{out}: expected a new or empty folder, got one in use")
