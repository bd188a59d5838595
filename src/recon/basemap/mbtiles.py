"""MBTiles: an SQLite file of tiles. Opened to read only, with limits on time and on a tile's size.

A hostile file may hold a view that never ends: SQLite asks now and then whether time is up.
"""

import re
import sqlite3
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np

from recon.basemap.map_file import (
    LARGEST_TILE_BYTES,
    LONGEST_READING_S,
    VECTOR,
    BaseMapError,
    MapInfo,
    Tile,
    checked_bounds,
    picture_of,
    plain_text,
    share_of_tiles,
    within_s,
)
from recon.basemap.mbtiles_writer import FETCHED
from recon.basemap.web_mercator import DEEPEST_ZOOM, MapArea, tile_bounds_deg
from recon.model.arrays import IntArray
from recon.model.foreign_text import one_line

INSTRUCTIONS_BETWEEN_LOOKS = 10_000
MOST_FACTS = 100
WITH_LOG = b"\x02\x02"
"""Header bytes of a file whose changes go into another file first (WAL)."""


class MBTiles:
    """An open MBTiles file; implements `MapFile`."""

    def __init__(self, path: Path) -> None:
        """Open a file; raises `BaseMapError`."""
        self._database = _opened(path)
        try:
            self.info = self._read_info(path)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Close the file."""
        self._database.close()

    def tile(self, zoom: int, col: int, row: int) -> Tile | None:
        """Return a tile; None where the map has none."""
        found = self._rows(
            "SELECT tile_data FROM tiles WHERE zoom_level=? AND tile_column=? AND tile_row=?"
            " LIMIT 1",
            (zoom, col, 2**zoom - 1 - row),
        )
        if not found:
            return None
        data = _blob(found[0][0])
        return Tile(picture_of(data)[0], data)

    def share(self, area: MapArea, zoom: int) -> float | None:
        """Return the share of an area whose tiles are there; None for too many to count."""
        return share_of_tiles(area, zoom, self._present)

    def _present(self, zoom: int, cols: IntArray, rows: IntArray) -> Iterator[bool]:
        if cols.size == 0:
            return iter(())
        tms_rows = 2**zoom - 1 - rows
        found = self._rows(
            "SELECT tile_column, tile_row FROM tiles WHERE zoom_level=?"
            " AND tile_column BETWEEN ? AND ? AND tile_row BETWEEN ? AND ?",
            (zoom, *(int(f(a)) for a in (cols, tms_rows) for f in (np.min, np.max))),
        )
        present = set(found)
        return (pair in present for pair in zip(cols.tolist(), tms_rows.tolist(), strict=True))

    def _read_info(self, path: Path) -> MapInfo:
        facts = self._facts()
        if facts.get("format") in ("pbf", "mvt"):
            raise BaseMapError(VECTOR)
        zooms = [zoom for zoom in range(DEEPEST_ZOOM + 1) if self._first(zoom) is not None]
        if not zooms:
            raise BaseMapError("expected tiles, got a file without any; fetch or export it again")
        data = self._first(zooms[-1]) or b""
        if data[:2] == b"\x1f\x8b":
            raise BaseMapError(VECTOR)
        stated = checked_bounds(str(facts.get("bounds", "")).split(","))
        return MapInfo(
            kind="MBTiles",
            title=one_line(facts.get("name") or path.stem),
            attribution=plain_text(facts.get("attribution") or ""),
            min_zoom=zooms[0],
            max_zoom=zooms[-1],
            tile_px=picture_of(data)[1],
            bounds_deg=stated or self._extent(zooms[-1]),
            fetched_utc_s=_fetched_utc_s(facts.get(FETCHED)),
        )

    def _facts(self) -> dict[str, Any]:
        """Return the file's own description; programs that cut maps leave it out."""
        if not self._rows("SELECT 1 FROM sqlite_master WHERE name='metadata' LIMIT 1", ()):
            return {}
        return dict(self._rows(f"SELECT name, value FROM metadata LIMIT {MOST_FACTS}", ()))

    def _first(self, zoom: int) -> bytes | None:
        """Return any tile of a zoom level; None without one."""
        found = self._rows("SELECT tile_data FROM tiles WHERE zoom_level=? LIMIT 1", (zoom,))
        return _blob(found[0][0]) if found else None

    def _extent(self, zoom: int) -> tuple[float, float, float, float]:
        ((first_col, last_col, low_row, high_row),) = self._rows(
            "SELECT min(tile_column), max(tile_column), min(tile_row), max(tile_row) FROM tiles"
            " WHERE zoom_level=?",
            (zoom,),
        )
        last = 2**zoom - 1
        west, _, _, north = tile_bounds_deg(zoom, first_col, last - high_row)
        _, south, east, _ = tile_bounds_deg(zoom, last_col, last - low_row)
        bounds = checked_bounds((west, south, east, north))
        if bounds is None:
            raise BaseMapError(f"expected tiles on earth at zoom {zoom}, got columns to {last_col}")
        return bounds

    def _rows(self, query: str, values: Sequence[int]) -> list[Any]:
        _end_when(self._database, within_s(LONGEST_READING_S))
        try:
            return self._database.execute(query, values).fetchall()
        except (sqlite3.Error, OverflowError, UnicodeError) as problem:
            raise BaseMapError(_sentence(problem)) from problem


def _opened(path: Path) -> sqlite3.Connection:
    with path.open("rb") as file:
        head = file.read(20)
    if not head.startswith(b"SQLite format 3\0"):
        raise BaseMapError("expected an MBTiles file (SQLite), got another kind of file")
    log = path.with_name(f"{path.name}-wal")
    is_all_there = head[18:20] == WITH_LOG and not (log.exists() and log.stat().st_size > 0)
    # Else SQLite would make files beside it to read it.
    mode = "immutable=1" if is_all_there else "mode=ro"
    try:
        database = sqlite3.connect(f"file:{quote(str(path))}?{mode}", uri=True, timeout=2.0)
        database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST_TILE_BYTES)
        database.execute("PRAGMA trusted_schema=OFF")
        database.execute("PRAGMA query_only=ON")
        database.execute("PRAGMA cell_size_check=ON")
    except sqlite3.Error as problem:
        raise BaseMapError(_sentence(problem)) from problem
    return database


def _end_when(database: sqlite3.Connection, is_late: Callable[[], bool]) -> None:
    database.set_progress_handler(lambda: int(is_late()), INSTRUCTIONS_BETWEEN_LOOKS)


def _blob(value: object) -> bytes:
    if not isinstance(value, bytes):
        raise BaseMapError("expected a picture in each tile, got a value of another kind")
    return value


def _sentence(problem: Exception) -> str:
    if "interrupted" in str(problem):
        return (
            f"expected to read it within {LONGEST_READING_S:g} s, got a slower file, perhaps "
            "without an index on its tiles; export it again"
        )
    return f"expected a whole MBTiles file, got: {one_line(problem)}; copy or export it again"


def _fetched_utc_s(text: object) -> float | None:
    return float(str(text)) if re.fullmatch(r"\d{1,11}", str(text)) else None
