"""A folder of rasters in the order of their names, read as maps of sun and shade.

Recon's own shade maps, and any others that GDAL reads: satellite, radar, a cloud mask. Two values
say what is full sun and what is full shade; between them the share of sun is linear.
"""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np
import rasterio
from rasterio import DatasetReader
from rasterio.errors import NotGeoreferencedWarning, RasterioError
from rasterio.warp import transform

from recon.model.arrays import FloatArray, IntArray
from recon.model.errors import RecordError
from recon.model.shade import FloatMap, MaskMap
from recon.record.raster.geotiff import CAPTURED_UTC_TAG

ENDINGS = (".tif", ".tiff", ".png", ".jpg", ".jpeg", ".asc", ".img")
FEWEST = 3
MOST_CELLS = 250_000
"""Five methods keep a dozen forecasts of two dozen leads each: a byte for each cell."""


@dataclass(frozen=True, slots=True, eq=False)
class RecordedMap:
    """One raster's first band."""

    transmittance: FloatMap
    """(R, C) in [0, 1]; NaN where nothing is known."""
    valid: MaskMap


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
    with _opened(path) as dataset:
        rows, cols = dataset.height, dataset.width
        if rows * cols > MOST_CELLS:
            raise RecordError(
                f"{path}: expected at most {MOST_CELLS} cells, got {rows} x {cols}; "
                "resample it (gdalwarp -ts)"
            )
        values = dataset.read(1).astype(np.float64)
        known = (dataset.read_masks(1) > 0) & np.isfinite(values)
    share = np.clip((np.where(known, values, shade) - shade) / (sun - shade), 0.0, 1.0)
    return RecordedMap(np.where(known, share, np.nan).astype(np.float32), known)


def captured_utc(path: Path) -> datetime | None:
    """Return when a map was captured; None where it does not state it. Raises `RecordError`."""
    with _opened(path) as dataset:
        text = dataset.tags().get(CAPTURED_UTC_TAG)
    if text is None:
        return None
    try:
        return datetime.fromisoformat(text)
    except ValueError as problem:
        raise RecordError(
            f"{path}: expected an ISO 8601 time in {CAPTURED_UTC_TAG}, got {text!a}"
        ) from problem


def cells_at(path: Path, places: FloatArray, *, is_geographic: bool) -> tuple[IntArray, IntArray]:
    """Return row and column (N,) of places (N, 2) in a map; some may be off it.

    Places are latitude and longitude, or metres east and north in the map's own projection. Raises
    `RecordError` for a map without a place.
    """
    with _opened(path) as dataset:
        if dataset.crs is None or dataset.transform.is_identity:
            raise RecordError(f"{path}: expected a map with a place on the ground, got none")
        first, second = (places[:, 1], places[:, 0]) if is_geographic else places.T
        if is_geographic:
            first, second = map(np.array, transform("EPSG:4326", dataset.crs, first, second))
        to_cell = ~dataset.transform
    cols = to_cell.a * first + to_cell.b * second + to_cell.c
    rows = to_cell.d * first + to_cell.e * second + to_cell.f
    return np.floor(rows).astype(np.int64), np.floor(cols).astype(np.int64)


@contextmanager
def _opened(path: Path) -> Iterator[DatasetReader]:
    """Open a raster; what GDAL cannot read, then or later, is a `RecordError`."""
    try:
        # Photographs of the sky and radar pictures often have no place: none is needed.
        with warnings.catch_warnings(action="ignore", category=NotGeoreferencedWarning):
            dataset = rasterio.open(path)
        with dataset:
            yield dataset
    except (RasterioError, OSError, ValueError) as problem:
        raise RecordError(f"{path}: expected a raster that GDAL reads, got: {problem}") from problem
