"""GeoTIFF and COG as tiles: for each, the pixels around it are read and resampled.

Only the GTiff driver is opened, and no file beside it is looked for. How much is read for a tile is
bounded: a large file needs overviews, without which it is shown from near only.
"""

import os
import warnings
from io import BytesIO
from math import ceil
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pyproj
import rasterio
from PIL import Image
from pyproj.exceptions import ProjError
from rasterio.enums import ColorInterp, Resampling
from rasterio.errors import NotGeoreferencedWarning, RasterioError
from rasterio.transform import Affine
from rasterio.windows import Window

from recon.basemap.map_file import BaseMapError, MapInfo, Tile, checked_bounds, plain_text
from recon.basemap.web_mercator import (
    TILE_PX,
    MapArea,
    globe_from_world,
    metres_per_pixel,
    world_from_globe,
    zoom_for,
)
from recon.geo.datum import horizontal, map_from_globe, names_files
from recon.model.arrays import FloatArray
from recon.model.foreign_text import one_line

STARTS = frozenset({b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"})
"""First bytes of either byte order, plain and large."""
LARGEST_BLOCK_BYTES = 64 * 1024 * 1024
"""A strip or tile is unpacked whole, whatever is asked of it."""
MOST_READ_PX = 4096
"""Most pixels along an edge, read for one tile from the file or its best overview."""
LARGEST_SIDE_PX = 16_384
"""Largest side of a file without overviews: 5 cm over 800 m."""
GRID = 17
"""Points along a tile's edge whose places are computed; those between are interpolated."""
MASK_PX = 1024
SAMPLES = 20_000
"""Samples of the area, to count what the file shows."""
FINER = 1.4
"""Factor on the file's pixel size up to which a zoom level is its own."""
JPEG_QUALITY = 85
DAMAGED = "expected a whole GeoTIFF, got one cut short or damaged; export it again"
AS_COG = "export it as COG (QGIS: Save As, or gdal_translate -of COG)"
GDAL_OPTIONS = {
    "GDAL_DISABLE_READDIR_ON_OPEN": "EMPTY_DIR",
    "GDAL_PAM_ENABLED": "NO",
    "GDAL_CACHEMAX": "64",
    "GDAL_MAX_DATASET_POOL_SIZE": "4",
}

Bytes = npt.NDArray[np.uint8]


class GeoTIFFMap:
    """An open GeoTIFF; implements `MapFile`."""

    def __init__(self, path: Path) -> None:
        """Open a file; raises `BaseMapError`."""
        os.environ.update(GDAL_OPTIONS)
        self._dataset = _opened(path)
        try:
            self._bands = _bands(self._dataset)
            self._px_from_map = ~_placed(self._dataset)
            self._map_from_globe = _from_globe(self._dataset)
            self.info = self._read_info(path)
        except BaseException:
            self.close()
            raise
        self._mask: Bytes | None = None

    def close(self) -> None:
        """Close the file."""
        self._dataset.close()

    def tile(self, zoom: int, col: int, row: int) -> Tile | None:
        """Return a tile; None where the file shows nothing."""
        steps = np.linspace(0.0, 1.0, GRID)
        east, south = np.meshgrid((col + steps) / 2.0**zoom, (row + steps) / 2.0**zoom)
        px = self._pixels(np.column_stack([east.ravel(), south.ravel()])).reshape(GRID, GRID, 2)
        window = self._window(px)
        if window is None:
            return None
        colours, shown, scale = self._read(window)
        # Centres of pixels: of the tile, and of what was read.
        places = _between(px) - (window.col_off, window.row_off)
        x, y = np.moveaxis((places / scale - 0.5).astype(np.float32), -1, 0)
        picture: Any = cv2.remap(colours, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        height, width = shown.shape
        is_inside = (x >= -0.5) & (x <= width - 0.5) & (y >= -0.5) & (y <= height - 0.5)
        alpha = np.where(
            is_inside, cv2.remap(shown, x, y, cv2.INTER_NEAREST, borderMode=cv2.BORDER_REPLICATE), 0
        )
        return _encoded(picture, alpha.astype(np.uint8)) if alpha.any() else None

    def share(self, area: MapArea, zoom: int) -> float | None:
        """Return the share of an area that the file shows, at every zoom level the same."""
        if self._mask is None:
            height, width = self._dataset.shape
            step = max(1.0, max(height, width) / MASK_PX)
            self._mask = self._valid(None, (ceil(height / step), ceil(width / step)))
        px = self._pixels(area.points(SAMPLES))
        rows, cols = self._mask.shape
        height, width = self._dataset.shape
        with np.errstate(all="ignore"):
            col = np.floor(px[:, 0] * cols / width)
            row = np.floor(px[:, 1] * rows / height)
            is_inside = (col >= 0) & (col < cols) & (row >= 0) & (row < rows)
        at = row[is_inside].astype(int), col[is_inside].astype(int)
        return float((self._mask[at] > 0).sum()) / max(1, len(px))

    def _read_info(self, path: Path) -> MapInfo:
        bounds, pixel_m = self._extent()
        latitude_deg = (bounds[1] + bounds[3]) / 2.0
        last = zoom_for(latitude_deg, FINER * pixel_m)
        tags = self._dataset.tags()
        return MapInfo(
            kind="GeoTIFF",
            title=one_line(path.stem),
            attribution=plain_text(tags.get("TIFFTAG_COPYRIGHT", "")),
            min_zoom=min(last, self._first_zoom(latitude_deg, pixel_m)),
            max_zoom=last,
            tile_px=TILE_PX,
            bounds_deg=bounds,
        )

    def _first_zoom(self, latitude_deg: float, pixel_m: float) -> int:
        """Return the coarsest level of which a tile reads no more than it may."""
        coarsest = max(self._dataset.overviews(1), default=1)
        if max(self._dataset.shape) / coarsest <= MOST_READ_PX:
            return 0
        if coarsest == 1 and max(self._dataset.shape) > LARGEST_SIDE_PX:
            height, width = self._dataset.shape
            raise BaseMapError(
                f"expected overviews in a file of {width} x {height} pixels, got none; {AS_COG}"
            )
        # A tile that lies across the file's own axes reads up to twice its width.
        largest_m = pixel_m * coarsest * MOST_READ_PX / TILE_PX / 2.0
        return zoom_for(latitude_deg, largest_m)

    def _extent(self) -> tuple[tuple[float, float, float, float], float]:
        """Return the bounds, degrees, and the size of a pixel in the middle, metres."""
        height, width = self._dataset.shape
        steps = np.linspace(0.0, 1.0, GRID)
        cols, rows = (axis.ravel() for axis in np.meshgrid(steps * width, steps * height))
        middle = [[width / 2.0, height / 2.0], [width / 2.0 + 1.0, height / 2.0]]
        px = np.vstack([np.column_stack([cols, rows]), middle])
        x, y = ~self._px_from_map @ (px[:, 0], px[:, 1])
        globe = np.column_stack(self._map_from_globe.transform(x, y, direction="INVERSE"))
        if not np.isfinite(globe).all():
            raise BaseMapError("expected a file whose pixels are on earth, got places that are not")
        (west, south), (east, north) = globe.min(axis=0), globe.max(axis=0)
        bounds = checked_bounds((west, south, east, north))
        world = world_from_globe(*globe[-2:].T)
        pixel_m = float(np.hypot(*(world[1] - world[0]))) * TILE_PX
        pixel_m *= metres_per_pixel(float(globe[-1, 1]), 0)
        if bounds is None or not pixel_m > 0.0:
            raise BaseMapError("expected a file whose pixels are on earth, got places that are not")
        return bounds, pixel_m

    def _pixels(self, world: FloatArray) -> FloatArray:
        """Return (N, 2) columns and rows, edges at integers, of (N, 2) world coordinates."""
        globe = globe_from_world(world)
        x, y = self._map_from_globe.transform(globe[:, 0], globe[:, 1])
        with np.errstate(all="ignore"):
            col, row = self._px_from_map @ (np.asarray(x), np.asarray(y))
            px = np.column_stack([col, row])
            return np.where(np.isfinite(px), px, -1e9)

    def _window(self, px: FloatArray) -> Window | None:
        """Return the part of the file around places, with a rim for resampling; None outside."""
        height, width = self._dataset.shape
        size = np.array([width, height])
        rim = 2.0 + (px.max(axis=(0, 1)) - px.min(axis=(0, 1))) / TILE_PX
        first = np.floor(np.clip(px.min(axis=(0, 1)) - rim, 0, size)).astype(int)
        last = np.ceil(np.clip(px.max(axis=(0, 1)) + rim, 0, size)).astype(int)
        if (last <= first).any():
            return None
        return Window(*first.tolist(), *(last - first).tolist())

    def _read(self, window: Window) -> tuple[Bytes, Bytes, FloatArray]:
        """Return colours (H, W, 3), what is valid (H, W), and file pixels for each of theirs."""
        longest = max(window.width, window.height)
        step = max(1.0, longest / (2.0 * TILE_PX))
        shape = max(1, ceil(window.height / step)), max(1, ceil(window.width / step))
        try:
            raw: Any = self._dataset.read(
                self._bands, window=window, out_shape=(len(self._bands), *shape),
                resampling=Resampling.average if step > 1.0 and not self._is_palette
                else Resampling.nearest,
            )  # fmt: skip
        except (RasterioError, ValueError) as problem:
            raise BaseMapError(DAMAGED) from problem
        colours = np.ascontiguousarray(np.moveaxis(self._coloured(raw), 0, -1))
        scale = np.array([window.width / shape[1], window.height / shape[0]])
        return colours, self._valid(window, shape), scale

    @property
    def _is_palette(self) -> bool:
        return bool(self._dataset.colorinterp[0] == ColorInterp.palette)

    def _coloured(self, raw: Bytes) -> Bytes:
        """Return red, green and blue of the bands: as they are, grey, or by the palette."""
        if len(raw) == 3:
            return raw
        if not self._is_palette:
            return np.repeat(raw, 3, axis=0)
        palette = np.zeros((256, 3), np.uint8)
        for number, colour in self._dataset.colormap(1).items():
            if 0 <= number < 256:
                palette[number] = colour[:3]
        return np.moveaxis(palette[raw[0]], -1, 0)

    def _valid(self, window: Window | None, shape: tuple[int, int]) -> Bytes:
        """Return what is shown: by alpha where the file has it, else by its mask or no-data value.

        GDAL takes the no-data value first, which is a colour of the picture too.
        """
        how: Any = {"window": window, "out_shape": shape, "resampling": Resampling.nearest}
        meanings = list(self._dataset.colorinterp)
        try:
            if ColorInterp.alpha not in meanings:
                mask: Bytes = self._dataset.dataset_mask(**how)
                return mask
            alpha: Bytes = self._dataset.read(meanings.index(ColorInterp.alpha) + 1, **how)
        except (RasterioError, ValueError) as problem:
            raise BaseMapError(DAMAGED) from problem
        return alpha


def _opened(path: Path) -> Any:
    with path.open("rb") as file:
        if file.read(4) not in STARTS:
            raise BaseMapError("expected a GeoTIFF, got another kind of file")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            return rasterio.open(path, driver="GTiff")
    except (RasterioError, ValueError) as problem:
        raise BaseMapError(DAMAGED) from problem


def _bands(dataset: Any) -> list[int]:
    """Return the bands with colours: three, or one. Raises `BaseMapError` for other rasters."""
    if dataset.tags(ns="OVERVIEWS"):
        raise BaseMapError(f"expected overviews inside the file, got the name of another; {AS_COG}")
    if any(kind != "uint8" for kind in dataset.dtypes):
        kinds = ", ".join(sorted(set(dataset.dtypes)))
        raise BaseMapError(
            f"expected a picture of 8 bits a colour, got {kinds}: heights or reflectances? Save "
            "its rendered image from QGIS"
        )
    rows, cols = max(dataset.block_shapes, key=lambda shape: shape[0] * shape[1])
    block_bytes = rows * cols * (dataset.count if _is_interleaved(dataset) else 1)
    if block_bytes > LARGEST_BLOCK_BYTES:
        raise BaseMapError(
            f"expected strips or tiles of at most {LARGEST_BLOCK_BYTES} bytes, got {cols} x {rows} "
            f"pixels in one; {AS_COG}"
        )
    meanings = list(dataset.colorinterp)
    colours = (ColorInterp.red, ColorInterp.green, ColorInterp.blue)
    if all(each in meanings for each in colours):
        return [meanings.index(each) + 1 for each in colours]
    return [1] if dataset.count < 3 else [1, 2, 3]


def _is_interleaved(dataset: Any) -> bool:
    return getattr(dataset.interleaving, "name", "") == "pixel"


def _placed(dataset: Any) -> Affine:
    transform = dataset.transform
    is_placed = all(np.isfinite(transform)) and abs(transform.determinant) > 0.0
    if dataset.crs is None or not is_placed or transform == Affine.identity():
        raise BaseMapError(
            "expected a GeoTIFF with a coordinate reference system and its place in it, got one "
            "without; export it from QGIS with its CRS"
        )
    return transform


def _from_globe(dataset: Any) -> pyproj.Transformer:
    try:
        text = dataset.crs.to_wkt()
        if names_files(text):
            raise BaseMapError(
                "expected a coordinate reference system without grid files of its own; export it "
                "in EPSG:3857"
            )
        return map_from_globe(horizontal(pyproj.CRS.from_user_input(text)))
    except (ProjError, RasterioError) as problem:
        raise BaseMapError(
            "expected a coordinate reference system that PROJ relates to WGS84, got another one; "
            "export it in EPSG:3857"
        ) from problem


def _between(grid: FloatArray) -> FloatArray:
    """Return the places (TILE_PX, TILE_PX, 2) of a tile's pixels by those of its grid of points."""
    at = ((np.arange(TILE_PX) + 0.5) / TILE_PX * (GRID - 1)).astype(np.float32)
    x, y = np.meshgrid(at, at)
    first = grid[0, 0]
    # In 32 bits beside the first point: a file may be a million pixels wide.
    near = (grid - first).astype(np.float32)
    parts = [cv2.remap(near[..., axis], x, y, cv2.INTER_LINEAR) for axis in (0, 1)]
    found: FloatArray = np.stack(parts, axis=-1).astype(np.float64) + first
    return found


def _encoded(picture: Bytes, alpha: Bytes) -> Tile:
    """Return a JPEG where all is shown, else a PNG."""
    data = BytesIO()
    if (alpha > 0).all():
        Image.fromarray(picture).save(data, "JPEG", quality=JPEG_QUALITY)
        return Tile("image/jpeg", data.getvalue())
    rgba = np.dstack([picture, np.where(alpha > 0, 255, 0).astype(np.uint8)])
    Image.fromarray(rgba).save(data, "PNG", compress_level=1)
    return Tile("image/png", data.getvalue())
