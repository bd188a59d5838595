"""Faults from a TOML file: scripted (`[[fault]]`) and random (`[[chance]]`).

Each error names the line, and nothing is started.
"""

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from recon.sim.app.faults import (
    ALL_VEHICLES,
    FaultKind,
    InjectedFault,
    RandomFault,
    default_times_s,
)
from recon.sim.errors import FaultError

LARGEST_FILE_BYTES = 1_048_576
LATEST_S = 86_400.0
MOST_PER_HOUR = 3_600.0
HEADER = re.compile(r"\s*\[\[\s*[\"']?(\w+)[\"']?\s*\]\]")
KEYS = {
    "fault": ("name", "vehicle", "start_s", "duration_s"),
    "chance": ("name", "vehicle", "per_hour", "duration_s", "from_s", "until_s"),
}


@dataclass(frozen=True, slots=True)
class FaultScript:
    """The content of a fault file."""

    faults: tuple[InjectedFault, ...] = ()
    chances: tuple[RandomFault, ...] = ()


def load_faults(path: Path) -> FaultScript:
    """Return the faults of a file; raises `FaultError` with file, line and what was expected."""
    try:
        if path.stat().st_size > LARGEST_FILE_BYTES:
            raise FaultError(f"{path}: expected at most {LARGEST_FILE_BYTES} bytes, got more")
        data = path.read_bytes()
    except OSError as problem:
        raise FaultError(f"{path}: expected a readable file, got: {problem.strerror}") from None
    return read_faults(data, str(path))


def read_faults(data: bytes, name: str) -> FaultScript:
    """Return the faults in `data`; `name` is the file's name for messages. Raises `FaultError`."""
    try:
        text = data.decode("utf-8")
        tables = tomllib.loads(text)
    except UnicodeDecodeError as problem:
        line = data[: problem.start].count(b"\n") + 1
        raise FaultError(f"{name}: line {line}: expected text in UTF-8, got other bytes") from None
    except tomllib.TOMLDecodeError as problem:
        raise FaultError(_no_toml(name, str(problem), text)) from None
    except (RecursionError, ValueError) as problem:
        raise FaultError(f"{name}: expected TOML, got: {problem}") from None
    entries = list(_entries(tables, text, name))
    return FaultScript(
        tuple(entry.fault() for entry in entries if entry.kind == "fault"),
        tuple(entry.chance() for entry in entries if entry.kind == "chance"),
    )


@dataclass(frozen=True, slots=True)
class _Entry:
    """One table of the file, and its line."""

    kind: str
    values: Mapping[str, object]
    name: str
    line: int
    key_lines: Mapping[str, int]

    def fault(self) -> InjectedFault:
        """Return the scripted fault."""
        kind = self._kind()
        start_s, duration_s = default_times_s(kind)
        if "duration_s" in self.values:
            duration_s = self._seconds("duration_s", duration_s)
        start_s = self._seconds("start_s", start_s)
        return InjectedFault(kind, self._vehicle(), start_s, duration_s, self._place())

    def chance(self) -> RandomFault:
        """Return the random fault."""
        if "per_hour" not in self.values:
            raise self._wrong("per_hour", f"a number above 0, {MOST_PER_HOUR:g} at most", "nothing")
        shortest_s, longest_s = self._durations_s()
        from_s, until_s = self._seconds("from_s", 0.0), self._seconds("until_s", 3_600.0)
        if until_s < from_s:
            raise self._wrong("until_s", f"{from_s:g} or more (from_s)", f"{until_s:g}")
        return RandomFault(
            kind=self._kind(),
            vehicle=self._vehicle(),
            per_hour=self._number("per_hour", 0.0, MOST_PER_HOUR),
            shortest_s=shortest_s,
            longest_s=longest_s,
            from_s=from_s,
            until_s=until_s,
            source=self._place(),
        )

    def check_keys(self) -> None:
        """Refuse unknown keys; raises `FaultError`."""
        known = KEYS[self.kind]
        for key in self.values:
            if key not in known:
                raise self._wrong(key, f"only the keys {', '.join(known)}", ascii(key))

    def _kind(self) -> FaultKind:
        name = self.values.get("name")
        for kind in FaultKind:
            if name == kind.value:
                return kind
        known = ", ".join(kind.value for kind in FaultKind)
        raise self._wrong("name", f"one of {known}", _quoted(name))

    def _vehicle(self) -> str:
        vehicle = self.values.get("vehicle", ALL_VEHICLES)
        if isinstance(vehicle, int) and not isinstance(vehicle, bool):
            return str(vehicle)
        if not isinstance(vehicle, str):
            raise self._wrong("vehicle", "a serial, a vehicle's number or '*'", _quoted(vehicle))
        return vehicle

    def _durations_s(self) -> tuple[float, float]:
        value = self.values.get("duration_s")
        if isinstance(value, list):
            numbers = [_number(one) for one in value]
            if len(numbers) == 2 and None not in numbers:
                shortest_s, longest_s = (one for one in numbers if one is not None)
                if 0.0 <= shortest_s <= longest_s <= LATEST_S:
                    return shortest_s, longest_s
        elif value is not None:
            duration_s = self._seconds("duration_s", 0.0)
            return duration_s, duration_s
        raise self._wrong("duration_s", "seconds, or [least, most]", _quoted(value))

    def _seconds(self, key: str, default_s: float) -> float:
        return self._number(key, 0.0, LATEST_S) if key in self.values else default_s

    def _number(self, key: str, lowest: float, highest: float) -> float:
        number = _number(self.values.get(key))
        if number is None or not lowest <= number <= highest:
            wanted = f"a number of {lowest:g} to {highest:g}"
            raise self._wrong(key, wanted, _quoted(self.values.get(key)))
        return number

    def _place(self) -> str:
        return f"{self.name}: line {self.line}: "

    def _wrong(self, key: str, expected: str, got: str) -> FaultError:
        line = self.key_lines.get(key, self.line)
        return FaultError(f"{self.name}: line {line}: {key}: expected {expected}, got {got}")


def _entries(tables: Mapping[str, object], text: str, name: str) -> Iterator[_Entry]:
    """Yield the tables, in the order of each kind; raises `FaultError`."""
    places = _places(text)
    for kind, rows in tables.items():
        if kind not in KEYS or not isinstance(rows, list):
            line = _line_of(kind, text)
            raise FaultError(
                f"{name}: line {line}: expected [[fault]] and [[chance]] tables, got {kind!a}"
            )
        lines = iter(places.get(kind, ()))
        for row in rows:
            line, key_lines = next(lines, (_line_of(kind, text), {}))
            if not isinstance(row, dict):
                raise FaultError(f"{name}: line {line}: expected a [[{kind}]] table, got a value")
            entry = _Entry(kind, row, name, line, key_lines)
            entry.check_keys()
            yield entry


def _places(text: str) -> dict[str, list[tuple[int, dict[str, int]]]]:
    """Return, per kind of table, the line of each table and of each of its keys.

    `tomllib` gives no positions, so the text is searched again for headers and keys.
    """
    places: dict[str, list[tuple[int, dict[str, int]]]] = {}
    key_lines: dict[str, int] = {}
    for line, words in enumerate(text.split("\n"), 1):
        header = HEADER.match(words)
        if header is not None:
            key_lines = {}
            places.setdefault(header[1], []).append((line, key_lines))
        key, is_set, _ = words.partition("=")
        if is_set:
            key_lines.setdefault(key.strip().strip("\"'"), line)
    return places


def _line_of(word: str, text: str) -> int:
    """Return the first line that contains a word, 1 without any."""
    lines = (number for number, line in enumerate(text.split("\n"), 1) if word in line)
    return next(lines, 1)


def _no_toml(name: str, problem: str, text: str) -> str:
    """Return the message for a file that is not TOML, with the line that tomllib reports."""
    found = re.search(r"\(at line (\d+), column \d+\)", problem)
    line = int(found[1]) if found is not None else text.count("\n") + 1
    what = problem.partition(" (at ")[0]
    return f"{name}: line {line}: expected TOML, got: {what.encode('ascii', 'replace').decode()}"


def _number(value: object) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        return float(value)
    except OverflowError:
        return None


def _quoted(value: object) -> str:
    if value is None:
        return "nothing"
    text = ascii(value)
    return text if len(text) <= 60 else text[:57] + "..."
