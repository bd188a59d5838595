"""A surface model in a GeoTIFF as the ground of a mosaic, read a window at a time."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from threading import Lock

import numpy as np
from scipy import ndimage

from recon.model.arrays import FloatArray
from recon.model.errors import RecordError, SiteError
from recon.model.geo import LocalFrame
from recon.product.mosaic.ground import fall_m
from recon.site.height_file import HeightFile, opened_on_disk

AROUND_PX = 2
SAMPLE_PX = 512
"""Pixels each way of the small copy that the extremes are read from."""
BEYOND_M = 10.0
"""What a tree may rise above all that the small copy shows, or a ditch lie below."""


@dataclass(slots=True)
class SurfaceModel:
    """Heights of a file over the site's frame; several threads may ask at once."""

    file: HeightFile
    frame: LocalFrame
    is_rough: bool = True
    bounds_m: tuple[float, float] = field(init=False)
    _lock: Lock = field(default_factory=Lock)

    def __post_init__(self) -> None:
        dataset = self.file.dataset
        size = tuple(min(side, SAMPLE_PX) for side in (dataset.height, dataset.width))
        sample = dataset.read(1, out_shape=size, masked=True).astype(np.float64).filled(np.nan)
        known = sample[np.isfinite(sample)] - self.frame.origin.ellipsoid_height_m
        if not len(known):
            raise RecordError(f"{self.file.place}: expected heights, got none")
        self.bounds_m = float(known.min()) - BEYOND_M, float(known.max()) + BEYOND_M

    def up_m(self, east_m: FloatArray, north_m: FloatArray) -> FloatArray:
        """Return the heights (rows, cols) at easts (cols,) and norths (rows,); NaN if unknown."""
        easts, norths = np.meshgrid(east_m, north_m)
        rows, cols = self._pixels(easts, norths)
        dataset = self.file.dataset
        spans = [
            _span(places, count)
            for places, count in ((rows, dataset.height), (cols, dataset.width))
        ]
        if not all(stop > start for start, stop in spans):
            return np.full(easts.shape, np.nan)
        (top, bottom), (left, right) = spans
        with self._lock:
            heights_m = self.file.heights_m((top, left), (bottom - top, right - left))
        found = ndimage.map_coordinates(
            heights_m, [rows - top, cols - left], order=1, mode="constant", cval=np.nan
        )
        return np.asarray(found - self.frame.origin.ellipsoid_height_m - fall_m(easts, norths))

    def _pixels(self, easts: FloatArray, norths: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the file's rows and columns of places.

        Over a window the two projections differ by a linear map to fractions of a millimetre.
        """
        corner = np.array([easts[0, 0], norths[0, 0]])
        size_m = np.array([np.ptp(easts), np.ptp(norths)]) + 1.0
        ends = corner + np.array([[0.0, 0.0], [size_m[0], 0.0], [0.0, -size_m[1]]])
        pixels = self.file.pixels(self.frame, ends)
        right, down = easts - corner[0], corner[1] - norths
        rows, cols = (
            pixels[0, axis]
            + (pixels[1, axis] - pixels[0, axis]) / size_m[0] * right
            + (pixels[2, axis] - pixels[0, axis]) / size_m[1] * down
            for axis in (0, 1)
        )
        return rows, cols


def _span(places: FloatArray, count: int) -> tuple[int, int]:
    """Return the first and one after the last pixel around places; empty where they are off."""
    if not np.isfinite(places).all():
        return 0, 0
    ends = np.clip([places.min() - AROUND_PX, places.max() + AROUND_PX + 1], 0, count)
    return int(ends[0]), int(ends[1])


@contextmanager
def opened_surface_model(path: Path, frame: LocalFrame) -> Iterator[SurfaceModel]:
    """Open a surface model; raises `RecordError` for anything else."""
    try:
        with opened_on_disk(path) as file:
            yield SurfaceModel(file, frame)
    except SiteError as problem:
        raise RecordError(str(problem)) from problem
