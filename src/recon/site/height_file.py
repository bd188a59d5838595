"""A GeoTIFF with heights, checked: bounded size, georeferenced, metres, one band.

The file is read whole into memory first and opened by the GeoTIFF driver alone, so that it can name
no other file or address; nothing is asked of the network.
"""

import logging
import re
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pyproj
import rasterio
from pyproj.enums import TransformDirection
from pyproj.exceptions import ProjError
from pyproj.network import set_network_enabled  # type: ignore[attr-defined]
from rasterio.errors import NotGeoreferencedWarning, RasterioError
from rasterio.io import DatasetReader, MemoryFile
from rasterio.transform import Affine
from rasterio.windows import Window

from recon.geo import enu_from_geo, geo_from_enu
from recon.geo.datum import horizontal, map_from_globe, names_files
from recon.model.arrays import FloatArray
from recon.model.errors import SiteError
from recon.model.geo import LocalFrame
from recon.site.reading import read_bounded

LARGEST_FILE_BYTES = 64 * 1024 * 1024
MOST_PIXELS = 16_000_000
"""Read at once: 128 MB. A field of 2 km with pixels of half a metre."""
LARGEST_BLOCK_BYTES = 128 * 1024 * 1024
"""A strip or tile is unpacked whole, whatever is asked of it."""
HEIGHT_TYPES = frozenset({"int16", "uint16", "int32", "uint32", "float32", "float64"})
TIFF_STARTS = frozenset({b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"})
"""First bytes of either byte order, plain and large."""
METRES = frozenset({None, "", "m", "metre", "meter", "metres", "meters"})
LOWEST_M, HIGHEST_M = -1_000.0, 10_000.0
"""What an altitude in site.toml may be."""
_MEMORY = re.compile(r"/vsimem/[^/ ]*/")
GDAL_OPTIONS = {"GDAL_DISABLE_READDIR_ON_OPEN": "EMPTY_DIR", "CPL_DEBUG": "OFF"}


@dataclass(frozen=True, slots=True, eq=False)
class HeightFile:
    """An open file; `crs` is its whole reference system, `place` leads errors."""

    place: str
    dataset: DatasetReader
    crs: pyproj.CRS
    _pixel_from_map: Affine
    _map_from_globe: pyproj.Transformer

    def pixels(self, frame: LocalFrame, east_north_m: FloatArray) -> FloatArray:
        """Return the (row, column) of (N, 2) points at the origin's height, centres at integers.

        (N, 2); NaN where the file's projection knows no place. The height hardly matters: 100 m
        more shift a point 1 km from the origin by 2 cm.
        """
        points = np.column_stack([east_north_m, np.zeros(len(east_north_m))])
        latitude, longitude, _ = geo_from_enu(frame, points)
        x, y = self._map_from_globe.transform(longitude, latitude)
        with np.errstate(all="ignore"):
            col, row = self._pixel_from_map @ (np.asarray(x), np.asarray(y))
        pixels = np.column_stack([row - 0.5, col - 0.5])
        return np.where(np.isfinite(pixels), pixels, np.nan)

    def enu_m(self, frame: LocalFrame, points: FloatArray) -> FloatArray:
        """Return points (N, 3) of x, y and height in the file's own coordinates, in a frame."""
        longitude, latitude = self._map_from_globe.transform(
            points[:, 0], points[:, 1], direction=TransformDirection.INVERSE
        )
        return enu_from_geo(frame, latitude, longitude, points[:, 2])

    def heights_m(self, first: tuple[int, int], size: tuple[int, int]) -> FloatArray:
        """Return a window of the file's heights, NaN where it has none. Raises `SiteError`."""
        if size[0] * size[1] > MOST_PIXELS:
            raise SiteError(
                f"{self.place}: expected at most {MOST_PIXELS} pixels around the site, got "
                f"{size[1]} x {size[0]}; export it with larger pixels, or set a smaller "
                "limits.max_distance_from_home_m"
            )
        window = Window(first[1], first[0], size[1], size[0])
        try:
            raw = self.dataset.read(1, window=window, masked=True)
        except (RasterioError, ValueError, MemoryError) as problem:
            raise SiteError(_damaged(self.place)) from problem
        scale, offset = self.dataset.scales[0], self.dataset.offsets[0]
        with np.errstate(all="ignore"):
            heights: FloatArray = raw.astype(np.float64).filled(np.nan) * scale + offset
        _refuse_no_heights(self.place, heights)
        return heights


@contextmanager
def opened(path: Path) -> Iterator[HeightFile]:
    """Open a file of heights; raises `SiteError` for anything else."""
    data = read_bounded(path, LARGEST_FILE_BYTES, "a GeoTIFF with heights")
    _refuse_other_files(path, data[:4])
    with (
        _environment(),
        MemoryFile(data, filename="heights.tif") as memory,
        _dataset(str(path), memory.open) as dataset,
    ):
        yield _height_file(str(path), dataset)


@contextmanager
def opened_on_disk(path: Path) -> Iterator[HeightFile]:
    """Open a file of heights that is too large for memory; raises `SiteError` for anything else.

    It must not be changed meanwhile.
    """
    try:
        with path.open("rb") as file:
            _refuse_other_files(path, file.read(4))
    except OSError as problem:
        raise SiteError(f"{path}: cannot be read: {problem.strerror}") from problem
    with _environment(), _dataset(str(path), partial(rasterio.open, path)) as dataset:
        yield _height_file(str(path), dataset)


def _refuse_other_files(path: Path, start: bytes) -> None:
    if start not in TIFF_STARTS:
        got = "a file of another kind" if start else "an empty file"
        raise SiteError(f"{path}: expected a GeoTIFF, got {got}; export the heights as GeoTIFF")


@contextmanager
def _environment() -> Iterator[None]:
    # No datum shift is fetched: what PROJ has at hand is good to a metre or two.
    set_network_enabled(False)
    with _without_gdal_logs(), rasterio.Env(**GDAL_OPTIONS):
        yield


@contextmanager
def _without_gdal_logs() -> Iterator[None]:
    """Silence GDAL's log of odd tags; what matters becomes a `SiteError`."""
    log = logging.getLogger("rasterio._env")
    was_disabled, log.disabled = log.disabled, True
    try:
        yield
    finally:
        log.disabled = was_disabled


def _dataset(place: str, open_as: Callable[..., DatasetReader]) -> DatasetReader:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            return open_as(driver="GTiff")
    except (RasterioError, ValueError, MemoryError) as problem:
        raise SiteError(_damaged(place)) from problem


def _damaged(place: str) -> str:
    """GDAL's own words name a file in memory and a directory of tags: nothing to act on."""
    return f"{place}: expected a whole GeoTIFF, got one cut short or damaged; export it again"


def _refuse_other_rasters(place: str, dataset: DatasetReader) -> None:
    if dataset.count != 1 or dataset.dtypes[0] not in HEIGHT_TYPES:
        raise SiteError(
            f"{place}: expected one band of heights ({', '.join(sorted(HEIGHT_TYPES))}), got "
            f"{dataset.count} of {dataset.dtypes[0]}; is it a picture?"
        )
    rows, cols = dataset.block_shapes[0]
    block_bytes = rows * cols * np.dtype(dataset.dtypes[0]).itemsize
    if block_bytes > LARGEST_BLOCK_BYTES:
        raise SiteError(
            f"{place}: expected strips or tiles of at most {LARGEST_BLOCK_BYTES} bytes, got "
            f"{cols} x {rows} pixels in one; export it tiled"
        )
    if dataset.units[0] not in METRES:
        raise SiteError(
            f"{place}: expected heights in metres, got the unit {dataset.units[0]!a}; convert them"
        )


def _height_file(place: str, dataset: DatasetReader) -> HeightFile:
    _refuse_other_rasters(place, dataset)
    transform = dataset.transform
    is_placed = all(np.isfinite(transform)) and abs(transform.determinant) > 0.0
    if dataset.crs is None or not is_placed or transform == Affine.identity():
        raise SiteError(
            f"{place}: expected a GeoTIFF with a coordinate reference system and its place in it, "
            "got one without; export it from QGIS with its CRS"
        )
    try:
        text = dataset.crs.to_wkt()
        if names_files(text):
            raise SiteError(
                f"{place}: expected a coordinate reference system without grid files of its own; "
                "export it in EPSG:4326"
            )
        crs = pyproj.CRS.from_user_input(text)
        flat = horizontal(crs)
        globe = map_from_globe(flat)
    except (ProjError, RasterioError) as problem:
        raise SiteError(
            f"{place}: expected a coordinate reference system that PROJ relates to WGS84, got: "
            f"{shown_problem(problem)}"
        ) from problem
    base = flat.source_crs if flat.is_bound and flat.source_crs is not None else flat
    if not (base.is_geographic or base.is_projected):
        raise SiteError(f"{place}: expected geographic or projected coordinates, got {base.name!a}")
    return HeightFile(place, dataset, crs, ~transform, globe)


def _refuse_no_heights(place: str, heights_m: FloatArray) -> None:
    is_wild = (heights_m < LOWEST_M) | (heights_m > HIGHEST_M)
    if is_wild.any():
        raise SiteError(
            f"{place}: expected heights of {LOWEST_M:g} to {HIGHEST_M:g} m, got "
            f"{float(heights_m[is_wild][0]):g}; if that stands for no data, declare it as such"
        )


def shown_problem(problem: BaseException) -> str:
    """Return a library's error in printable characters, on one line, shortened."""
    text = ascii(" ".join(str(problem).split()))[1:-1]
    text = _MEMORY.sub("", text)
    return text if len(text) <= 200 else text[:197] + "..."
