"""A folder of rasters in the order of their names, read as maps of sun and shade.

Recon's own shade maps, and any others that GDAL reads: satellite, radar, a cloud mask. Two values
say what is full sun and what is full shade; between them the share of sun is linear.
"""

import warnings
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np
import rasterio
from rasterio.errors import NotGeoreferencedWarning, RasterioError

from recon.model.errors import RecordError
from recon.model.shade import FloatMap, MaskMap

ENDINGS = (".tif", ".tiff", ".png", ".jpg", ".jpeg", ".asc", ".img")
FEWEST = 3
MOST_CELLS = 4_000_000
UTC_TAG = "RECON_CAPTURED_UTC"


@dataclass(frozen=True, slots=True, eq=False)
class RecordedMap:
    """One raster."""

    transmittance: FloatMap
    """(R, C) in [0, 1]; NaN where nothing is known."""
    valid: MaskMap
    captured_utc: datetime | None


def map_files(folder: Path) -> list[Path]:
    """Return the rasters of a folder by name; raises `RecordError` for fewer than FEWEST."""
    try:
        found = sorted(each for each in folder.iterdir() if each.suffix.lower() in ENDINGS)
    except OSError as problem:
        raise RecordError(
            f"{folder}: expected a folder of maps, got: {problem.strerror or problem}"
        ) from problem
    # A contact sheet of `recon detect` is no map.
    maps = [each for each in found if each.stem != "contact-sheet"]
    if len(maps) < FEWEST:
        raise RecordError(
            f"{folder}: expected {FEWEST} maps or more ({', '.join(ENDINGS)}), got {len(maps)}"
        )
    return maps


def read_map(path: Path, sun: float, shade: float) -> RecordedMap:
    """Return a raster's first band as a map of sun; raises `RecordError`."""
    try:
        # Photographs of the sky and radar pictures often have no place: none is needed.
        with warnings.catch_warnings(action="ignore", category=NotGeoreferencedWarning):
            dataset = rasterio.open(path)
        with dataset:
            rows, cols = dataset.height, dataset.width
            if rows * cols > MOST_CELLS:
                raise RecordError(
                    f"{path}: expected at most {MOST_CELLS} cells, got {rows} x {cols}; "
                    "resample it (gdalwarp -ts)"
                )
            values = dataset.read(1).astype(np.float64)
            known = (dataset.read_masks(1) > 0) & np.isfinite(values)
            utc = dataset.tags().get(UTC_TAG)
    except (RasterioError, OSError, ValueError) as problem:
        raise RecordError(f"{path}: expected a raster that GDAL reads, got: {problem}") from problem
    share = np.clip((np.where(known, values, shade) - shade) / (sun - shade), 0.0, 1.0)
    transmittance = np.where(known, share, np.nan).astype(np.float32)
    return RecordedMap(transmittance, known, _time(path, utc))


def _time(path: Path, text: str | None) -> datetime | None:
    if text is None:
        return None
    try:
        return datetime.fromisoformat(text)
    except ValueError as problem:
        raise RecordError(
            f"{path}: expected an ISO 8601 time in {UTC_TAG}, got {text!a}"
        ) from problem
