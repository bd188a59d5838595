"""The maps of a folder as the station and the command line read them: by a process of their own.

`MapReader` blocks: the station calls it on a thread. A process that crashes or is late is ended,
and the next question starts another one.
"""

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from stat import S_ISLNK, S_ISREG
from threading import Lock, Timer
from typing import Any

from recon.basemap.coverage import ZoomCoverage
from recon.basemap.map_file import (
    LARGEST_TILE_BYTES,
    BaseMapError,
    MapInfo,
    Tile,
    is_map_name,
    version_of,
)
from recon.basemap.web_mercator import MapArea

MOST_MAPS = 50
FACTS_WITHIN_S = 60.0
TILE_WITHIN_S = 10.0
LONGEST_HEAD_BYTES = 64 * 1024
PROCESS = (sys.executable, "-m", "recon.basemap.map_process")


@dataclass(frozen=True, slots=True)
class KnownMap:
    """What is known of a map: its facts and coverage, or why it is not used."""

    name: str
    size_bytes: int
    version: str
    """Changes with the file."""
    info: MapInfo | None = None
    coverage: tuple[ZoomCoverage, ...] = ()
    """Coverage by zoom level, the coarsest first."""
    problem: str = ""


def map_versions(folder: Path) -> dict[str, tuple[int, str]]:
    """Return size and version of each map file of a folder, by name in its order.

    No hidden files; none for a folder that is missing. Links are listed, and refused when asked.
    """
    found = {}
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            with suppress(OSError):
                stat = entry.stat(follow_symlinks=False)
                if is_map_name(entry.name) and (S_ISREG(stat.st_mode) or S_ISLNK(stat.st_mode)):
                    found[entry.name] = (stat.st_size, version_of(stat))
    return dict(sorted(found.items())[:MOST_MAPS])


class MapReader:
    """Asks the process that reads maps; it is started at the first question."""

    def __init__(self, folder: Path, command: Sequence[str] = PROCESS) -> None:
        """Take the folder with the maps."""
        self.folder = folder
        self._command = command
        self._one = Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._is_closed = False

    def facts(self, name: str, area: MapArea | None) -> KnownMap:
        """Return what is known of a map, with its coverage of an area; problems are in it."""
        size, version = map_versions(self.folder).get(name, (0, ""))
        ring = None if area is None else area.ring_deg
        try:
            answer, _ = self._ask({"name": name, "ring": ring}, FACTS_WITHIN_S)
            if "missing" in answer:
                raise BaseMapError(answer["problem"])
            info = answer["info"]
            info["bounds_deg"] = tuple(info["bounds_deg"])
            levels = tuple(ZoomCoverage(**level) for level in answer["coverage"])
            return KnownMap(name, size, version, MapInfo(**info), levels)
        except BaseMapError as problem:
            return KnownMap(name, size, version, problem=str(problem))

    def tile(self, name: str, zoom: int, col: int, row: int) -> tuple[Tile | None, str]:
        """Return a tile, and the version of its map; None where the map has no such tile.

        Raises `BaseMapError`.
        """
        answer, body = self._ask({"name": name, "tile": [zoom, col, row]}, TILE_WITHIN_S)
        if "missing" in answer:
            return None, ""
        return Tile(answer["media"], body), answer["version"]

    def rest(self) -> None:
        """End the process until the next question."""
        with self._one:
            if self._process is not None:
                self._end(self._process)

    def close(self) -> None:
        """End the process for good, also while it reads."""
        self._is_closed = True
        process = self._process
        if process is not None:
            process.kill()
        self.rest()

    def _ask(self, question: dict[str, Any], within_s: float) -> tuple[dict[str, Any], bytes]:
        with self._one:
            process = self._running()
            timer = Timer(within_s, process.kill)
            timer.start()
            try:
                answer, body = _exchange(process, json.dumps(question).encode() + b"\n")
            except (OSError, ValueError) as problem:
                is_late = not timer.is_alive()
                self._end(process)
                why = f"is not read within {within_s:g} s" if is_late else "ends its reader"
                raise BaseMapError(f"expected a map that can be read, got one that {why}") from (
                    problem
                )
            finally:
                timer.cancel()
        if "problem" in answer and "missing" not in answer:
            raise BaseMapError(answer["problem"])
        return answer, body

    def _running(self) -> subprocess.Popen[bytes]:
        if self._is_closed:
            raise BaseMapError("the reader of maps is closed")
        if self._process is None:
            self._process = subprocess.Popen(
                [*self._command, str(self.folder)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
            )
        return self._process

    def _end(self, process: subprocess.Popen[bytes]) -> None:
        self._process = None
        process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout):
            with suppress(OSError):
                if pipe is not None:
                    pipe.close()


def _exchange(process: subprocess.Popen[bytes], line: bytes) -> tuple[dict[str, Any], bytes]:
    """Return the answer's head and body. Raises ValueError for none, or one too long."""
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write(line)
    process.stdin.flush()
    head = process.stdout.readline(LONGEST_HEAD_BYTES)
    answer = json.loads(head)
    length = answer.pop("length")
    if length > LARGEST_TILE_BYTES:
        raise ValueError("tile too large")
    body = process.stdout.read(length)
    if len(body) < length:
        raise ValueError("answer cut short")
    return answer, body
