"""Folders of maps: as `recon verify` and `recon forecast` read them, and where one is written."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import pairwise
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from recon.cli.progress import progress_over
from recon.model.arrays import FloatArray
from recon.model.errors import RecordError
from recon.model.shade import ShadeMap
from recon.model.units import seconds_to_ns
from recon.record.raster.map_sequence import RecordedMap, captured_utc, map_files, read_map
from recon.score.verification import time_scale, unplaced_grid

EVEN_S = 0.05
"""Gaps that differ by less are all the same to a reader."""
LEAST_GAP_S = 0.001

FolderArgument = Annotated[
    Path,
    typer.Argument(help="Rasters, in the order of the times in them; else of their names."),
]
StepOption = Annotated[
    float | None,
    typer.Option(help="Seconds between maps that state no time; Recon's own maps do."),
]
SunOption = Annotated[float, typer.Option(help="The value that is full sun.")]
ShadeOption = Annotated[float, typer.Option(help="The value that is full shade.")]


@dataclass(frozen=True, slots=True)
class RecordedMaps:
    """Files in order of time, each one's time, and the values of full sun and full shade."""

    files: Sequence[Path]
    times_s: Sequence[float]
    """Seconds after the first map, rising."""
    sun: float
    shade: float

    @property
    def gaps_s(self) -> FloatArray:
        """Seconds between each map and the next."""
        return np.diff(self.times_s)

    @property
    def step_s(self) -> float:
        """Usual seconds between two maps: their median."""
        return float(np.median(self.gaps_s))

    @property
    def time_scale(self) -> float:
        """Seconds of the sequence for one of the methods."""
        return time_scale(self.step_s)

    @property
    def spacing(self) -> str:
        """How far apart the maps are, in words."""
        least_s, most_s = float(self.gaps_s.min()), float(self.gaps_s.max())
        if most_s - least_s < EVEN_S:
            return f"{self.step_s:g} s apart"
        return f"{self.step_s:.1f} s apart (median; {least_s:.1f} to {most_s:.1f} s)"

    def maps(self) -> Iterator[ShadeMap]:
        """Yield the maps, in the methods' time, with a progress bar; raises `RecordError`."""
        shape: tuple[int, ...] | None = None
        dated = zip(self.files, self.times_s, strict=True)
        for path, at_s in progress_over(dated, "forecasting", len(self.files)):
            found = read_map(path, self.sun, self.shade)
            if shape is not None and found.valid.shape != shape:
                raise RecordError(
                    f"{path}: expected {shape} cells as before, got {found.valid.shape}"
                )
            shape = found.valid.shape
            yield _shade_map(found, seconds_to_ns(at_s / self.time_scale))


def recorded_maps(folder: Path, step_s: float | None, sun: float, shade: float) -> RecordedMaps:
    """Return the maps of a folder; raises `RecordError` for options or times that do not fit."""
    if not np.isfinite([sun, shade]).all() or sun == shade:
        raise RecordError(f"expected two different numbers, got --sun {sun} --shade {shade}")
    if step_s is not None and not 0.1 <= step_s <= 86_400.0:
        raise RecordError(f"--step-s: expected 0.1 to 86400 seconds, got {step_s:g}")
    files = map_files(folder)
    stated = [each for each in map(captured_utc, files) if each is not None]
    if step_s is None:
        if len(stated) < len(files):
            raise RecordError(f"{folder}: expected --step-s, for not all maps have a time")
        return RecordedMaps(*_by_time(files, stated), sun, shade)
    if len(stated) == len(files):
        raise RecordError(f"{folder}: expected no --step-s, for all maps have a time")
    return RecordedMaps(files, [number * step_s for number in range(len(files))], sun, shade)


def _by_time(files: Sequence[Path], stated: Sequence[datetime]) -> tuple[list[Path], list[float]]:
    """Return the files in order of the times in them, and their seconds after the first."""
    dated = sorted(zip(map(datetime.timestamp, stated), files, strict=True))
    for (at_s, path), (next_s, other) in pairwise(dated):
        if next_s - at_s < LEAST_GAP_S:
            raise RecordError(f"{other}: expected another time than that of {path.name}")
    return [path for _at_s, path in dated], [at_s - dated[0][0] for at_s, _path in dated]


def _shade_map(found: RecordedMap, at_ns: int) -> ShadeMap:
    rows, cols = found.valid.shape
    known = found.valid.astype(np.float32)
    grid = unplaced_grid(rows, cols)
    return ShadeMap(grid, at_ns, (), found.transmittance, found.valid, known, known)


def refuse_used(out: Path) -> None:
    """Raise `RecordError` for a folder that cannot take new maps: it holds something."""
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise RecordError(f"{out}: expected a new or empty folder, got one in use")
