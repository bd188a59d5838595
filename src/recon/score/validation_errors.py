"""What is wrong with a scenario's file, told with the line of the key."""

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeVar

from recon.score.errors import ScenarioError
from recon.score.toml_lines import line_of
from recon.sim.errors import SimulationError

Made = TypeVar("Made")

PLACE = re.compile(r"((?:\w+(?:\[\d+\])*\.?)+): expected")
UNKNOWN = re.compile(r"expected only the keys .*, got '(\w+)'")


class Complaints:
    """Makes errors that name the file and the line of a key."""

    def __init__(self, path: Path, lines: Mapping[str, int]) -> None:
        self._path, self._lines = path, lines

    def about(self, said: str, within: str = "") -> ScenarioError:
        """Return the error; what is said begins with a key, inside `within` if that is given."""
        place = PLACE.match(said)
        key = place[1] if place else ""
        unknown = UNKNOWN.search(said)
        path = ".".join(part for part in (within, key, unknown[1] if unknown else "") if part)
        line = line_of(self._lines, path)
        where = f"{self._path}:{line}" if line is not None else f"{self._path}"
        lead = within + ("." if place else ": ") if within else ""
        return ScenarioError(f"{where}: {lead}{said}")

    def made(self, within: str, make: Callable[[], Made]) -> Made:
        """Return what is made of a table, its complaint in the file's words."""
        try:
            return make()
        except SimulationError as problem:
            said = str(problem).removeprefix("wind: ").removeprefix("wind shift: ")
            raise self.about(said, within) from problem
