"""PMTiles: one file of tiles with directories of their places, read by the format's own library.

Each directory is unpacked within limits first: a few bytes may claim to be gigabytes.
"""

import gzip
import json
import zlib
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path
from typing import IO, Any

from pmtiles.tile import (
    Compression,
    MagicNumberNotFound,
    SpecVersionUnsupported,
    TileType,
    deserialize_directory,
    deserialize_header,
    find_tile,
    tileid_to_zxy,
    zxy_to_tileid,
)

from recon.basemap.map_file import (
    LARGEST_TILE_BYTES,
    VECTOR,
    BaseMapError,
    MapInfo,
    Tile,
    checked_bounds,
    checked_zooms,
    picture_of,
    plain_text,
    share_of_tiles,
)
from recon.basemap.web_mercator import MapArea
from recon.model.arrays import IntArray
from recon.model.foreign_text import one_line

HEADER_BYTES = 127
LARGEST_DIRECTORY_BYTES = 2 * 1024 * 1024
"""Packed; the format's writers make them of some 10 kB."""
LARGEST_UNPACKED_BYTES = 16 * 1024 * 1024
MOST_DIRECTORIES = 64
"""Most directories kept unpacked."""
DEEPEST = 4
"""Directories above a tile, by the specification."""
DAMAGED = "expected a whole PMTiles file, got a damaged one; copy or export it again"
RASTER = frozenset({TileType.PNG, TileType.JPEG, TileType.WEBP})


class PMTiles:
    """An open PMTiles file; implements `MapFile`."""

    def __init__(self, path: Path) -> None:
        """Open a file; raises `BaseMapError`."""
        self._file: IO[bytes] = path.open("rb")
        try:
            self._header = _header(self._read(0, HEADER_BYTES))
            self._directory: Callable[[int, int], list[Any]] = lru_cache(MOST_DIRECTORIES)(
                self._read_directory
            )
            self.info = self._read_info(path)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def tile(self, zoom: int, col: int, row: int) -> Tile | None:
        """Return a tile; None where the map has none."""
        entry = self._entry(zxy_to_tileid(zoom, col, row))
        if entry is None:
            return None
        data = self._tile_data(entry)
        return Tile(picture_of(data)[0], data)

    def share(self, area: MapArea, zoom: int) -> float | None:
        """Return the share of an area whose tiles are there; None for too many to count."""
        return share_of_tiles(area, zoom, self._present)

    def _present(self, zoom: int, cols: IntArray, rows: IntArray) -> Iterator[bool]:
        places = zip(cols.tolist(), rows.tolist(), strict=True)
        return (self._entry(zxy_to_tileid(zoom, col, row)) is not None for col, row in places)

    def _read_info(self, path: Path) -> MapInfo:
        header = self._header
        if header["tile_type"] in (TileType.MVT, TileType.MLT):
            raise BaseMapError(VECTOR)
        if header["tile_type"] not in RASTER:
            raise BaseMapError("expected tiles as PNG, JPEG or WebP, got another kind")
        facts = self._facts()
        last = self._last_entry()
        bounds = checked_bounds(
            header[key] / 1e7 for key in ("min_lon_e7", "min_lat_e7", "max_lon_e7", "max_lat_e7")
        )
        if bounds is None:
            raise BaseMapError("expected bounds on earth, got others; export the map again")
        stated = (header["min_zoom"], tileid_to_zxy(last.tile_id)[0])
        lowest, highest = checked_zooms(*stated)
        return MapInfo(
            kind="PMTiles",
            title=one_line(facts.get("name") or path.stem),
            attribution=plain_text(facts.get("attribution") or ""),
            min_zoom=lowest,
            max_zoom=highest,
            tile_px=picture_of(self._tile_data(last))[1],
            bounds_deg=bounds,
        )

    def _facts(self) -> dict[str, Any]:
        """Return the file's own description; nothing where it has none that can be read."""
        length = self._header["metadata_length"]
        if not length:
            return {}
        data = _unpacked(self._packed_part(self._header["metadata_offset"], length))
        try:
            facts = json.loads(data)
        except (ValueError, RecursionError):
            return {}
        return facts if isinstance(facts, dict) else {}

    def _last_entry(self) -> Any:
        """Return the last tile's entry, which is of the deepest zoom level."""
        directory = self._root()
        for _ in range(DEEPEST):
            if not directory:
                break
            if directory[-1].run_length > 0:
                return directory[-1]
            directory = self._leaf(directory[-1])
        raise BaseMapError("expected tiles, got a file without any; export it again")

    def _entry(self, tile_id: int) -> Any:
        """Return the entry of a tile; None without one."""
        directory = self._root()
        for _ in range(DEEPEST):
            entry = find_tile(directory, tile_id)
            if entry is None or entry.run_length > 0:
                return entry
            directory = self._leaf(entry)
        raise BaseMapError(DAMAGED)

    def _root(self) -> list[Any]:
        return self._directory(self._header["root_offset"], self._header["root_length"])

    def _leaf(self, entry: Any) -> list[Any]:
        return self._directory(self._header["leaf_directory_offset"] + entry.offset, entry.length)

    def _read_directory(self, offset: int, length: int) -> list[Any]:
        packed = self._packed_part(offset, length)
        _unpacked(packed)
        try:
            entries: list[Any] = deserialize_directory(packed)
        except (EOFError, ValueError, IndexError, OverflowError) as problem:
            raise BaseMapError(DAMAGED) from problem
        return entries

    def _tile_data(self, entry: Any) -> bytes:
        if entry.length > LARGEST_TILE_BYTES:
            raise BaseMapError(f"expected tiles of at most {LARGEST_TILE_BYTES} bytes, got more")
        return self._read(self._header["tile_data_offset"] + entry.offset, entry.length)

    def _packed_part(self, offset: int, length: int) -> bytes:
        """Return a part packed by gzip, as the library reads it, also where it is plain."""
        data = self._part(offset, length)
        is_plain = self._header["internal_compression"] is Compression.NONE
        return gzip.compress(data, compresslevel=1) if is_plain else data

    def _part(self, offset: int, length: int) -> bytes:
        if length > LARGEST_DIRECTORY_BYTES:
            raise BaseMapError(
                f"expected directories of at most {LARGEST_DIRECTORY_BYTES} bytes, got {length}"
            )
        return self._read(offset, length)

    def _read(self, offset: int, length: int) -> bytes:
        try:
            self._file.seek(offset)
            data = self._file.read(length)
        except (OSError, ValueError, OverflowError) as problem:
            raise BaseMapError(DAMAGED) from problem
        if len(data) < length:
            raise BaseMapError(DAMAGED)
        return data


def _header(data: bytes) -> dict[str, Any]:
    try:
        header: dict[str, Any] = dict(deserialize_header(data))
    except (MagicNumberNotFound, UnicodeDecodeError) as problem:
        raise BaseMapError("expected a PMTiles file, got another kind of file") from problem
    except (SpecVersionUnsupported, ValueError) as problem:
        raise BaseMapError("expected PMTiles version 3, got another one; convert it") from problem
    if header["internal_compression"] not in (Compression.GZIP, Compression.NONE):
        raise BaseMapError(
            "expected directories packed by gzip or plain, got others; export it again"
        )
    return header


def _unpacked(data: bytes) -> bytes:
    unpacker = zlib.decompressobj(wbits=31)
    try:
        unpacked = unpacker.decompress(data, LARGEST_UNPACKED_BYTES)
    except zlib.error as problem:
        raise BaseMapError(DAMAGED) from problem
    if not unpacker.eof:
        raise BaseMapError(
            f"expected directories of at most {LARGEST_UNPACKED_BYTES} bytes unpacked, got more"
        )
    return unpacked
