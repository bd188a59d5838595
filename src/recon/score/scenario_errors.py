"""Errors of a scenario file, with file and line.

The standard library's TOML parser reports no lines for values: `key_lines` finds those of keys.
"""

import re
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TypeVar

from recon.model.errors import ReconError
from recon.sim.errors import SimulationError

Made = TypeVar("Made")

PLACE = re.compile(r"((?:\w+(?:\[\d+\])*\.?)+): expected")
UNKNOWN = re.compile(r"expected only the keys .*, got '(\w+)'")
HEADER = re.compile(r"\s*(\[\[?)\s*([\w.\"'\- ]+?)\s*\]\]?\s*(?:#.*)?$")
KEY = re.compile(r"\s*([\w.\"'\-]+)\s*=(.*)$")
QUOTED = re.compile(r'"(?:\\.|[^"\\])*"|\'[^\']*\'')


class ScenarioError(ReconError):
    """A scenario cannot be read or flown; the message has file, line, expected and actual value."""


class ScenarioErrors:
    """Makes errors that name the file and the line of a key."""

    def __init__(self, path: Path, lines: Mapping[str, int]) -> None:
        self._path, self._lines = path, lines

    def error(self, text: str, within: str = "") -> ScenarioError:
        """Return the error for a text that starts with a key, relative to the table `within`."""
        place = PLACE.match(text)
        key = place[1] if place else ""
        unknown = UNKNOWN.search(text)
        path = ".".join(part for part in (within, key, unknown[1] if unknown else "") if part)
        line = line_of(self._lines, path)
        where = f"{self._path}:{line}" if line is not None else f"{self._path}"
        lead = within + ("." if place else ": ") if within else ""
        return ScenarioError(f"{where}: {lead}{text}")

    def made(self, within: str, make: Callable[[], Made]) -> Made:
        """Return `make()`; a `SimulationError` of it becomes an error of the table `within`."""
        try:
            return make()
        except SimulationError as problem:
            text = str(problem).removeprefix("wind: ").removeprefix("wind shift: ")
            raise self.error(text, within) from problem


def key_lines(text: str) -> Mapping[str, int]:
    """Return the line, from 1, of each table and key: `clouds[1].cover`, `task.region_m`.

    For text that `tomllib` accepts. A value over several lines counts as its first line.
    """
    lines: dict[str, int] = {}
    counts: Counter[str] = Counter()
    table, depth = "", 0
    for number, line in enumerate(text.splitlines(), start=1):
        if depth == 0 and (header := HEADER.match(line)):
            table = _bare(header[2])
            if header[1] == "[[":
                counts[table] += 1
                lines.setdefault(table, number)
                table = f"{table}[{counts[table] - 1}]"
            lines[table] = number
        elif depth == 0 and (key := KEY.match(line)):
            path = _bare(key[1])
            lines[f"{table}.{path}" if table else path] = number
            depth = max(0, depth + _opened(key[2]))
        else:
            depth = max(0, depth + _opened(line))
    return MappingProxyType(lines)


def line_of(lines: Mapping[str, int], path: str) -> int | None:
    """Return the line of a key or of the nearest key around it; None without one."""
    while path:
        if path in lines:
            return lines[path]
        path = path[: max(path.rfind("."), path.rfind("["), 0)]
    return None


def _bare(key: str) -> str:
    return re.sub(r"[\"'\s]", "", key)


def _opened(value: str) -> int:
    """How many more brackets a line opens than it closes, outside strings and comments."""
    bare = QUOTED.sub("", value).split("#")[0]
    return sum(bare.count(each) for each in "[{") - sum(bare.count(each) for each in "]}")
