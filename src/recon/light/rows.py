"""Lines of light sensors' CSV, one by one: the head, then rows of values or of places.

Names of columns are those of `NAMES`, in any case. In wide form each other column is a sensor, and
rows named lat, lon, east_m or north_m in the place of a time state where it is; in long form a row
is one sensor's value. Times are ISO 8601 (UTC where no zone is stated) or Unix seconds.
"""

import csv
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import chain

from recon.model.errors import RecordError
from recon.model.units import unix_ns

NAMES = {
    "time": ("time", "utc", "time_utc", "time_unix_s", "timestamp", "datetime", "unix"),
    "sensor": ("sensor", "station", "name", "id"),
    "lat": ("lat", "latitude", "latitude_deg"),
    "lon": ("lon", "longitude", "longitude_deg"),
    "east_m": ("east_m", "east", "x"),
    "north_m": ("north_m", "north", "y"),
}
PLACE_PAIRS = (("lat", "lon"), ("east_m", "north_m"))
PLACE_KEYS = frozenset(chain(*PLACE_PAIRS))
UNKNOWN = frozenset({"", "nan", "na", "n/a", "null", "none", "-"})
EARLIEST_S, LATEST_S = 1e8, 9.2e9
"""Unix seconds from 1973 to 2261: milliseconds are larger, and later nanoseconds need 65 bits."""

Places = Mapping[str, tuple[float, float]]


@dataclass(frozen=True, slots=True)
class CsvHead:
    """The columns of a CSV of light sensors."""

    cells: Sequence[str]
    at: Mapping[str, int]
    """Columns of `NAMES`, by key."""
    values: Sequence[int]
    """Columns of values: one of each sensor, or the one of a long table."""

    @property
    def is_long(self) -> bool:
        """Whether each row is one sensor's value."""
        return "sensor" in self.at

    @property
    def names(self) -> tuple[str, ...]:
        """The sensors of a wide table."""
        return () if self.is_long else tuple(self.cells[column] for column in self.values)


@dataclass(frozen=True, slots=True)
class LightRow:
    """One row: values of sensors at a time, or numbers of their places."""

    names: tuple[str, ...]
    values: Sequence[float]
    """By name; NaN where unknown."""
    time_ns: int | None = None
    """Unix time; None for a row of places."""
    place_key: str = ""
    """What the values of a row of places are: lat, lon, east_m or north_m."""
    place: Mapping[str, float] | None = None
    """What a row of a long table states of its sensor's place, by key."""


def read_head(cells: Sequence[str]) -> CsvHead:
    """Return the columns of a head; raises `RecordError`."""
    cells = [each.strip() for each in cells]
    expect_once(cells)
    at = columns(cells)
    if "time" not in at:
        raise RecordError(f"expected a head with a column time, got {', '.join(cells)}")
    is_long = "sensor" in at
    values = [n for n in range(len(cells)) if n not in at.values()]
    if not is_long:
        values = [n for n in range(len(cells)) if n != at["time"]]
    elif len(values) != 1:
        named = ", ".join(cells[n] for n in values) or "none"
        raise RecordError(f"expected one column of values beside the sensor, got {named}")
    return CsvHead(cells, at, values)


def read_row(head: CsvHead, cells: Sequence[str], now_ns: int | None = None) -> LightRow:
    """Return a row; raises `RecordError`.

    `now_ns` is the Unix time of a value without one: of a logger without a clock, heard live.
    """
    expect_cells(head.cells, cells)
    values, time = [number(cells[n]) for n in head.values], cells[head.at["time"]]
    if not head.is_long:
        key = key_of(time)
        if key in PLACE_KEYS:
            return LightRow(head.names, values, place_key=key)
        return LightRow(head.names, values, _time_ns(time, now_ns))
    names = (cells[head.at["sensor"]].strip(),)
    place = {key: number(cells[head.at[key]]) for key in PLACE_KEYS & head.at.keys()}
    return LightRow(names, values, _time_ns(time, now_ns), place=place)


def placed(names: Sequence[str], stated: Mapping[str, Sequence[float]]) -> tuple[Places, bool]:
    """Return the places that values by `PLACE_PAIRS` state, and whether they are geographic."""
    for first, second in PLACE_PAIRS:
        if first in stated and second in stated:
            both = zip(stated[first], stated[second], strict=True)
            return dict(zip(names, both, strict=True)), first == "lat"
    return {}, False


def cells_of_lines(lines: Iterable[str], first: str) -> list[list[str]]:
    """Return the cells of lines, by the separator that the first one has most of."""
    return [row for row in csv.reader(lines, delimiter=max(",;\t", key=first.count)) if row]


def columns(head: Sequence[str]) -> dict[str, int]:
    """Return the columns of `NAMES`, by key."""
    return {key: n for n, name in enumerate(head) if (key := key_of(name)) in NAMES}


def key_of(name: str) -> str:
    """Return the key of `NAMES` that a name stands for; else the name."""
    plain = name.strip().lower()
    return next((key for key, others in NAMES.items() if plain in others), plain)


def expect_once(head: Sequence[str]) -> None:
    """Raise `RecordError` for a column that is there twice."""
    repeated = {each for each in head if head.count(each) > 1}
    if repeated:
        raise RecordError(f"expected each column once, got {min(repeated)} twice")


def expect_cells(head: Sequence[str], cells: Sequence[str]) -> None:
    """Raise `RecordError` for a row that has not as many values as the head."""
    if len(cells) != len(head):
        raise RecordError(
            f"expected {len(head)} values, one for each column of the head, got {len(cells)}"
        )


def number(text: str) -> float:
    """Return a cell's number, NaN where unknown; raises `RecordError`."""
    if text.strip().lower() in UNKNOWN:
        return float("nan")
    try:
        return float(text)
    except ValueError:
        raise RecordError(f"expected a number such as 1480 or 0.5, got {text!a:.80}") from None


def expect_seconds(at_s: float) -> None:
    """Raise `RecordError` for what is no Unix time in seconds."""
    if not EARLIEST_S <= at_s <= LATEST_S:
        more = " (milliseconds?)" if at_s > LATEST_S else ""
        raise RecordError(f"expected Unix seconds, got {at_s:g}{more}")


def _time_ns(text: str, now_ns: int | None) -> int:
    if now_ns is not None and text.strip().lower() in UNKNOWN:
        return now_ns
    try:
        at_s = float(text)
    except ValueError:
        try:
            at_s = _datetime_s(text)
        except (ValueError, OverflowError):
            raise RecordError(
                f"expected a time in ISO 8601 or Unix seconds, got {text!a:.80}"
            ) from None
    expect_seconds(at_s)
    return unix_ns(at_s)


def _datetime_s(text: str) -> float:
    found = datetime.fromisoformat(text.strip().removesuffix("UTC").strip())
    return (found if found.tzinfo else found.replace(tzinfo=UTC)).timestamp()
