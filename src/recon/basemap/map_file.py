"""What every kind of map file is to its readers: its facts, its tiles, and the errors."""

import os
import time
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Protocol

import numpy as np

from recon.basemap.web_mercator import DEEPEST_ZOOM, MapArea
from recon.model.arrays import IntArray
from recon.model.errors import ReconError
from recon.model.foreign_text import one_line

LARGEST_TILE_BYTES = 2 * 1024 * 1024
SMALLEST_TILE_PX, LARGEST_TILE_PX = 64, 1024
MEDIA = {"PNG": "image/png", "JPEG": "image/jpeg", "WEBP": "image/webp"}
SUFFIXES = frozenset({".mbtiles", ".pmtiles", ".tif", ".tiff"})
LONGEST_READING_S = 20.0


class BaseMapError(ReconError):
    """A map cannot be used or fetched; the text states what was expected, what came, what to do."""


@dataclass(frozen=True, slots=True)
class MapInfo:
    """The facts of a map file. Bounds are west, south, east and north, degrees."""

    kind: str
    title: str
    attribution: str
    min_zoom: int
    max_zoom: int
    tile_px: int
    bounds_deg: tuple[float, float, float, float]
    fetched_utc_s: float | None = None
    """When its first tiles were fetched from a server; None for other files."""


@dataclass(frozen=True, slots=True)
class Tile:
    """A picture as it goes to the browser."""

    media_type: str
    data: bytes


class MapFile(Protocol):
    """An open map file. Every method raises `BaseMapError` for a damaged one."""

    info: MapInfo

    def tile(self, zoom: int, col: int, row: int) -> Tile | None:
        """Return a tile; None where the map has none."""

    def share(self, area: MapArea, zoom: int) -> float | None:
        """Return the share, 0 to 1, of an area that a zoom level shows; None if not countable."""

    def close(self) -> None:
        """Close the file."""


def is_map_name(name: str) -> bool:
    """Whether a file of this name in the folder of maps is one: no path, not hidden."""
    is_plain = Path(name).name == name and name.isprintable() and not name.startswith(".")
    return is_plain and Path(name).suffix.lower() in SUFFIXES


def version_of(stat: os.stat_result) -> str:
    """Return a text that changes with the file."""
    return f"{stat.st_mtime_ns:x}-{stat.st_size:x}"


def share_of_tiles(
    area: MapArea, zoom: int, present: Callable[[int, IntArray, IntArray], Iterable[bool]]
) -> float | None:
    """Return the share of an area whose tiles are present; None for too many to count."""
    tiles = area.tiles(zoom)
    if tiles is None:
        return None
    is_there = np.fromiter(present(zoom, tiles.cols, tiles.rows), bool, len(tiles.cols))
    return float(tiles.shares[is_there].sum())


def within_s(limit_s: float) -> Callable[[], bool]:
    """Return a function that states whether the time is up."""
    ends_s = time.monotonic() + limit_s
    return lambda: time.monotonic() > ends_s


def picture_of(data: bytes) -> tuple[str, int]:
    """Return media type and width, pixels, of a tile's picture, without unpacking it.

    Raises `BaseMapError` for anything but a square PNG, JPEG or WebP of a tile's size.
    """
    from PIL import Image

    if len(data) > LARGEST_TILE_BYTES:
        raise BaseMapError(f"expected a tile of at most {LARGEST_TILE_BYTES} bytes, got more")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Image.open(BytesIO(data), formats=list(MEDIA)) as image:
                kind, (width, height) = image.format, image.size
    except Exception as problem:  # Pillow has errors of many kinds for damaged files.
        raise BaseMapError("expected tiles as PNG, JPEG or WebP, got another kind") from problem
    if width != height or not SMALLEST_TILE_PX <= width <= LARGEST_TILE_PX:
        raise BaseMapError(
            f"expected square tiles of {SMALLEST_TILE_PX} to {LARGEST_TILE_PX} pixels, got "
            f"{width} x {height}"
        )
    return MEDIA[str(kind)], width


def plain_text(markup: object) -> str:
    """Return an attribution without the tags that map servers put into it."""
    import html
    import re

    return one_line(html.unescape(re.sub(r"<[^<>]{0,500}>", "", str(markup)[:2_000])))


def checked_bounds(values: object) -> tuple[float, float, float, float] | None:
    """Return stated bounds if they are on earth and not empty, else None."""
    try:
        west, south, east, north = (float(each) for each in values)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        return None
    is_valid = -180.0 <= west < east <= 180.0 and -90.0 <= south < north <= 90.0
    return (west, south, east, north) if is_valid else None


def checked_zooms(lowest: int, highest: int) -> tuple[int, int]:
    """Return zoom levels; raises `BaseMapError` for ones that no map has."""
    if not 0 <= lowest <= highest <= DEEPEST_ZOOM:
        raise BaseMapError(
            f"expected zoom levels of 0 to {DEEPEST_ZOOM}, got {lowest} to {highest}"
        )
    return lowest, highest


VECTOR = (
    "expected a raster map, got vector tiles; export the map as raster tiles, for example from "
    "QGIS with Generate XYZ tiles (MBTiles)"
)
