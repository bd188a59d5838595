"""Lines of a logger as they come, without a socket, file or clock.

The first line is the head of a CSV, each later one a row (`rows`). A logger may be anything: lines
have a limit, and so have its sensors. A line that cannot be used costs itself alone, and the
sentence why is kept to be answered.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import hypot, isfinite

from recon.geo import enu_from_geo, geo_from_enu
from recon.light.rows import (
    PLACE_KEYS,
    CsvHead,
    LightRow,
    cells_of_lines,
    placed,
    read_head,
    read_row,
)
from recon.model.errors import RecordError
from recon.model.foreign_text import one_line
from recon.model.geo import LatLon, LocalFrame
from recon.model.light import LightRead, LightReading

LONGEST_LINE_BYTES = 2_048
MOST_SENSORS = 32
"""Sensors of one logger, and of all."""
LONGEST_NAME = 40
LARGEST = 1e9
"""Of a value, in any unit of light."""
PROBLEMS_KEPT = 8
"""Enough for a person who mends a logger; the rest is counted."""
FARTHEST_M = 10_000.0
"""From the site's origin: all sensors then lie within the 20 km that `recon verify` takes."""


@dataclass(slots=True)
class LightLines:
    """What one logger has sent so far, and what was wrong with it since it was last asked."""

    frame: LocalFrame | None
    """The site's, for places in metres from its origin."""
    readings: list[LightReading] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)
    """A sentence for each of the newest lines that could not be used."""
    refused: int = 0
    """All lines that could not be used."""
    _head: CsvHead | None = None
    _stated: dict[str, dict[str, float]] = field(default_factory=dict)
    """Numbers of the sensors' places, by name and key."""
    _rest: bytes = b""
    _is_too_long: bool = False
    _first: str = ""
    """The head's line, which tells the separator."""
    _line: int = 0

    def push(self, data: bytes, now_ns: int) -> None:
        """Take bytes that came at a Unix time."""
        *lines, rest = (self._rest + data).split(b"\n")
        for line in lines:
            self._line += 1
            if self._is_too_long or len(line) > LONGEST_LINE_BYTES:
                self._is_too_long = False
                self._refuse(f"expected at most {LONGEST_LINE_BYTES} bytes, got more")
            elif line.strip():
                self._take(line, now_ns)
        self._is_too_long = self._is_too_long or len(rest) > LONGEST_LINE_BYTES
        self._rest = b"" if self._is_too_long else rest

    def taken(self, source: str) -> tuple[LightRead | None, list[str]]:
        """Return what came since the last call, None if nothing did, and the problems."""
        read, problems = None, self.problems
        if self.readings or self.refused:
            problem = problems[-1] if problems else ""
            read = LightRead(source, tuple(self.readings), self.refused, problem)
        self.readings, self.problems, self.refused = [], [], 0
        return read, problems

    def _take(self, line: bytes, now_ns: int) -> None:
        try:
            self._read(line.decode("utf-8-sig").strip("\r"), now_ns)
        except UnicodeDecodeError:
            self._refuse("expected a line of CSV in UTF-8, got other bytes")
        except (RecordError, csv.Error) as problem:
            self._refuse(str(problem))

    def _read(self, line: str, now_ns: int) -> None:
        if not line:
            return  # a byte order mark alone
        (cells,) = cells_of_lines([line], self._first or line)
        if self._head is None:
            self._begin(line, cells)
        elif [each.strip() for each in cells] != self._head.cells:  # a logger that began anew
            self._row(read_row(self._head, cells, now_ns))

    def _begin(self, line: str, cells: list[str]) -> None:
        head = read_head(cells)
        if len(head.values) > MOST_SENSORS:
            raise RecordError(f"expected at most {MOST_SENSORS} sensors, got {len(head.values)}")
        self._head, self._first = head, line

    def _row(self, row: LightRow) -> None:
        names = [one_line(name, LONGEST_NAME + 1) for name in row.names]
        if row.time_ns is None:
            for name, value in zip(names, row.values, strict=True):
                self._stated.setdefault(name, {})[row.place_key] = value
            return
        for name, value in zip(names, row.values, strict=True):
            if isfinite(value):
                _expect_name(name)
            stated = self._stated.get(name)
            if stated is None:
                if len(self._stated) >= MOST_SENSORS:
                    raise RecordError(f"expected at most {MOST_SENSORS} sensors, got more")
                stated = self._stated[name] = {}
            stated.update(row.place or {})
            if abs(value) > LARGEST:
                raise RecordError(f"expected a value of light, got {value:g}")
            if isfinite(value):
                place = _place(stated, self.frame)
                self.readings.append(LightReading(name, row.time_ns, value, place))

    def _refuse(self, problem: str) -> None:
        self.refused += 1
        self.problems = [*self.problems, f"line {self._line}: {problem}"][-PROBLEMS_KEPT:]


def _expect_name(name: str) -> None:
    """Raise `RecordError` for a name that nobody could tell from another one."""
    if not 1 <= len(name) <= LONGEST_NAME:
        raise RecordError(
            f"expected a sensor's name of 1 to {LONGEST_NAME} characters, got {name!r}"
        )


def _place(stated: Mapping[str, float], frame: LocalFrame | None) -> LatLon | None:
    """Return the place that numbers by key state, if they state one; raises `RecordError`."""
    known = {key: [value] for key, value in stated.items() if isfinite(value)}
    places, is_geographic = placed([""], {key: known[key] for key in PLACE_KEYS & known.keys()})
    if not places:
        return None
    first, second = places[""]
    if is_geographic:
        place = LatLon(first, second)
    elif frame is None:
        raise RecordError("expected lat and lon: metres need a site with an origin (--site)")
    elif max(abs(first), abs(second)) > FARTHEST_M:
        raise RecordError(f"expected metres from the site's origin, got {first:g} and {second:g}")
    else:
        latitude, longitude, _height = geo_from_enu(frame, [[first, second, 0.0]])
        place = LatLon(float(latitude[0]), float(longitude[0]))
    if not place.is_valid():
        raise RecordError(f"expected degrees of latitude and longitude, got {first:g}, {second:g}")
    if is_geographic and frame is not None:
        _expect_near(place, frame)
    return place


def _expect_near(place: LatLon, frame: LocalFrame) -> None:
    """Raise `RecordError` for a place off the site: `recon verify` refuses records with one."""
    at = (place.latitude_deg, place.longitude_deg, frame.origin.ellipsoid_height_m)
    if hypot(*enu_from_geo(frame, *at)[0]) > FARTHEST_M:  # up too: the antipode lies below
        raise RecordError(
            f"expected a place (lat, lon) within {FARTHEST_M / 1e3:g} km of the site, got "
            f"{at[0]:g}, {at[1]:g}"
        )
