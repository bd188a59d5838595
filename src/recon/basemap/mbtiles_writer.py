"""Writes an MBTiles file while others read it: a few tiles are saved together, and stay saved."""

import sqlite3
import time
from pathlib import Path
from types import TracebackType

from recon.basemap.map_file import BaseMapError, picture_of

SAVED_TOGETHER = 50
SCHEMA = """
CREATE TABLE IF NOT EXISTS metadata (name text PRIMARY KEY, value text);
CREATE TABLE IF NOT EXISTS tiles (
    zoom_level integer, tile_column integer, tile_row integer, tile_data blob,
    PRIMARY KEY (zoom_level, tile_column, tile_row)
);
"""
DIGEST = "recon_server_sha256"
FETCHED = "recon_fetched_utc_s"
FORMATS = {"image/png": "png", "image/jpeg": "jpg", "image/webp": "webp"}


class MBTilesWriter:
    """A file that tiles of one source are added to; a context manager."""

    def __init__(self, path: Path, source_digest: str) -> None:
        """Take the file, which is made if missing, and what distinguishes its source."""
        self._path = path
        self._digest = source_digest
        self._unsaved = 0
        self._has_format = False

    def __enter__(self) -> "MBTilesWriter":
        """Open the file; raises `BaseMapError` for one of another source."""
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            is_new = not self._path.exists()
            self._database = sqlite3.connect(self._path, timeout=10.0)
            self._open(is_new)
        except (OSError, sqlite3.Error) as problem:
            raise self._unwritable(problem) from problem
        return self

    def _open(self, is_new: bool) -> None:
        if is_new:
            self._database.executescript(SCHEMA)
            self._state(DIGEST, self._digest)
            # Later fetches add what is missing: the file is as old as its first tiles.
            self._state(FETCHED, str(int(time.time())))
            self._database.commit()
        facts = dict(self._database.execute("SELECT name, value FROM metadata LIMIT 100"))
        self._has_format = "format" in facts
        if facts.get(DIGEST) != self._digest:
            self._database.close()
            raise BaseMapError(
                f"{self._path}: expected a file fetched from the same address, got another one; "
                "choose another --name, or remove it"
            )

    def __exit__(
        self,
        kind: type[BaseException] | None,
        problem: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Save what was added, also after an error; a file without any tile is removed."""
        try:
            self._database.commit()
            is_empty = self._database.execute("SELECT 1 FROM tiles LIMIT 1").fetchone() is None
        except sqlite3.Error as unsaved:
            raise self._unwritable(unsaved) from problem
        finally:
            self._database.close()
        if is_empty:
            self._path.unlink(missing_ok=True)

    def present(self) -> set[tuple[int, int, int]]:
        """Return zoom level, column and row, from the north, of every tile in the file."""
        rows = self._database.execute("SELECT zoom_level, tile_column, tile_row FROM tiles")
        return {(zoom, col, 2**zoom - 1 - row) for zoom, col, row in rows}

    def describe(
        self, title: str, attribution: str, bounds_deg: tuple[float, float, float, float]
    ) -> None:
        """Write the facts that programs show."""
        bounds = ",".join(f"{each:.6f}" for each in bounds_deg)
        for name, value in {
            "name": title,
            "attribution": attribution,
            "bounds": bounds,
            "type": "baselayer",
        }.items():
            self._state(name, value)

    def add(self, key: tuple[int, int, int], data: bytes) -> None:
        """Add a tile; raises `BaseMapError` when the disk is full."""
        zoom, col, row = key
        try:
            if not self._has_format:
                self._state("format", FORMATS[picture_of(data)[0]])
                self._has_format = True
            self._database.execute(
                "INSERT OR REPLACE INTO tiles VALUES (?, ?, ?, ?)",
                (zoom, col, 2**zoom - 1 - row, data),
            )
            self._unsaved += 1
            if self._unsaved >= SAVED_TOGETHER:
                self._database.commit()
                self._unsaved = 0
        except sqlite3.Error as problem:
            raise self._unwritable(problem) from problem

    def _state(self, name: str, value: str) -> None:
        self._database.execute("INSERT OR REPLACE INTO metadata VALUES (?, ?)", (name, value))

    def _unwritable(self, problem: Exception) -> BaseMapError:
        reason = getattr(problem, "strerror", None) or problem
        return BaseMapError(f"{self._path} cannot be written: {reason}")
