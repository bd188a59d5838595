"""The process that reads map files: `python -m recon.basemap.map_process FOLDER`.

It answers one question after the other: a line of JSON on standard input, one on standard output,
which states the length of what follows it. Its memory is limited and it writes no file, so that a
hostile map costs an answer and nothing else. It ends with its input.
"""

import json
import sys
from collections import OrderedDict
from collections.abc import Callable
from pathlib import Path
from stat import S_ISLNK, S_ISREG
from typing import IO, TYPE_CHECKING, Any

from recon.processes.limits import limit_itself

if TYPE_CHECKING:
    from recon.basemap.map_file import MapFile

MOST_MEMORY_BYTES = 2 * 1024**3
"""Limit of address space: GDAL, PROJ and numpy map 1 GiB before a file is read."""
MOST_OPEN = 4
OUT_OF_MEMORY = "expected a map that is read in 2 GiB of memory, got one that needs more"

Answer = tuple[dict[str, Any], bytes]


def main() -> None:
    """Answer until the input ends."""
    limit_itself(MOST_MEMORY_BYTES, writes_files=False)
    answers, sys.stdout = sys.stdout.buffer, sys.stderr
    serve(Path(sys.argv[1]), sys.stdin.buffer, answers)


def serve(folder: Path, questions: IO[bytes], answers: IO[bytes]) -> None:
    """Answer each question; see `OpenMaps.answer`."""
    maps = OpenMaps(folder)
    for line in questions:
        head, body = maps.answer(json.loads(line))
        answers.write(json.dumps({**head, "length": len(body)}).encode() + b"\n" + body)
        answers.flush()


class OpenMaps:
    """The map files of a folder, a few of them open."""

    def __init__(self, folder: Path) -> None:
        """Take the folder."""
        self._folder = folder
        self._open: OrderedDict[tuple[str, str], MapFile] = OrderedDict()

    def answer(self, question: dict[str, Any]) -> Answer:
        """Return the facts and coverage of a map, or a tile of it; else `problem`."""
        from recon.basemap.map_file import BaseMapError

        try:
            opened, version = self._opened(question["name"])
            if "tile" in question:
                return _tile(opened, version, *question["tile"])
            return _facts(opened, question["ring"]), b""
        except FileNotFoundError:
            return {"missing": True, "problem": "the file is gone"}, b""
        except BaseMapError as problem:
            return {"problem": str(problem)}, b""
        except MemoryError:
            return {"problem": OUT_OF_MEMORY}, b""
        except OSError as problem:
            return {"problem": f"cannot be read: {problem.strerror or problem}"}, b""
        except Exception as problem:
            # A library's error for a damaged file; its words are for programmers.
            print(f"{question['name']!a}: {problem!r}"[:500], file=sys.stderr)
            return {"problem": "expected a whole map file, got a damaged one; export it again"}, b""

    def _opened(self, name: str) -> tuple["MapFile", str]:
        """Return an open map and its version. Raises FileNotFoundError and `BaseMapError`."""
        from recon.basemap.map_file import BaseMapError, is_map_name, version_of

        path = self._folder / name
        stat = path.lstat()
        if is_map_name(name) and S_ISLNK(stat.st_mode):
            raise BaseMapError(
                "expected a file in the folder maps, got a link; copy the file there"
            )
        if not is_map_name(name) or not S_ISREG(stat.st_mode):
            raise FileNotFoundError(name)
        key = (name, version_of(stat))
        if key not in self._open:
            for other in [each for each in self._open if each[0] == name]:
                self._open.pop(other).close()
            self._open[key] = opener_of(name)(path)
            while len(self._open) > MOST_OPEN:
                self._open.popitem(last=False)[1].close()
        self._open.move_to_end(key)
        return self._open[key], key[1]


def _tile(opened: "MapFile", version: str, zoom: int, col: int, row: int) -> Answer:
    if not opened.info.min_zoom <= zoom <= opened.info.max_zoom:
        return {"missing": True}, b""
    tile = opened.tile(zoom, col, row)
    if tile is None:
        return {"missing": True}, b""
    return {"media": tile.media_type, "version": version}, tile.data


def _facts(opened: "MapFile", ring: list[list[float]] | None) -> dict[str, Any]:
    from dataclasses import asdict

    from recon.basemap.coverage import coverage
    from recon.basemap.web_mercator import MapArea

    area = None if ring is None else MapArea(tuple((lon, lat) for lon, lat in ring))
    levels = () if area is None else coverage(opened, area)
    return {"info": asdict(opened.info), "coverage": [asdict(level) for level in levels]}


def opener_of(name: str) -> Callable[[Path], "MapFile"]:
    """Return what opens a file of this name; see `map_file.SUFFIXES`."""
    # Each with its libraries only when such a file is there.
    match Path(name).suffix.lower():
        case ".pmtiles":
            from recon.basemap.pmtiles_file import PMTiles

            return PMTiles
        case ".tif" | ".tiff":
            from recon.basemap.geotiff_map import GeoTIFFMap

            return GeoTIFFMap
        case _:
            from recon.basemap.mbtiles import MBTiles

            return MBTiles


if __name__ == "__main__":
    main()
