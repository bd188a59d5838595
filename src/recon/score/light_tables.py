"""Files of light sensors as tables: CSV in wide and in long form, NumPy's .npz, NetCDF.

Names of columns and arrays are those of `NAMES`, in any case. In wide form each other column is a
sensor, and rows named lat, lon, east_m or north_m in the place of a time state where it is; in long
form a row is one sensor's value. Times are ISO 8601 (UTC where no zone is stated) or Unix seconds.
"""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import chain
from pathlib import Path

import numpy as np

from recon.model.arrays import FloatArray, IntArray
from recon.model.errors import RecordError
from recon.model.units import NS_PER_S, unix_ns

NAMES = {
    "time": ("time", "utc", "time_utc", "time_unix_s", "timestamp", "datetime", "unix"),
    "sensor": ("sensor", "station", "name", "id"),
    "lat": ("lat", "latitude", "latitude_deg"),
    "lon": ("lon", "longitude", "longitude_deg"),
    "east_m": ("east_m", "east", "x"),
    "north_m": ("north_m", "north", "y"),
}
PLACE_PAIRS = (("lat", "lon"), ("east_m", "north_m"))
UNKNOWN = frozenset({"", "nan", "na", "n/a", "null", "none", "-"})
MOST_BYTES = 500_000_000
EARLIEST_S, LATEST_S = 1e8, 1e10
"""Unix seconds from 1973 to 2286: milliseconds are larger."""
UNIX_TIME = "seconds since 1970-01-01"

Places = Mapping[str, tuple[float, float]]


@dataclass(frozen=True, slots=True, eq=False)
class LightTable:
    """Values of sensors as a file states them: times may be repeated and in any order."""

    names: tuple[str, ...]
    times_ns: IntArray
    """(T,)"""
    light: FloatArray
    """(T, N); NaN where unknown."""
    places: Places
    """By name: east and north in metres, or latitude and longitude in degrees."""
    is_geographic: bool
    repeated: int = 0
    """Values of one sensor at a time that another one has; the last counts."""


def read_table(path: Path) -> LightTable:
    """Return a file's table; raises `RecordError`."""
    try:
        if path.stat().st_size > MOST_BYTES:
            raise RecordError(f"{path}: expected at most {MOST_BYTES // 1_000_000} MB of values")
        return READERS[path.suffix.lower()](path)
    except OSError as problem:
        reason = problem.strerror or problem
        raise RecordError(f"{path}: expected a file of light sensors, got: {reason}") from problem


def read_places(path: Path) -> tuple[Places, bool]:
    """Return the places in a CSV of sensors, and whether they are geographic; raises
    `RecordError`."""
    try:
        head, rows = _rows(path)
    except OSError as problem:
        raise RecordError(f"{path}: expected a CSV of places: {problem.strerror}") from problem
    at = _columns(head)
    if "sensor" in at:
        places, is_geographic = _places_of_rows(path, rows, at)
        if places:
            return places, is_geographic
    raise RecordError(
        f"{path}: expected columns sensor and lat, lon or sensor and east_m, north_m, "
        f"got {', '.join(head)}"
    )


def _csv_table(path: Path) -> LightTable:
    head, rows = _rows(path)
    at = _columns(head)
    if "time" not in at:
        raise RecordError(f"{path}: expected a column time, got {', '.join(head)}")
    if "sensor" in at:
        return _long_form(path, head, rows, at)
    columns = [number for number in range(len(head)) if number != at["time"]]
    names = tuple(head[column] for column in columns)
    stated: dict[str, list[float]] = {}
    times_ns, light = [], []
    for line, row in enumerate(rows, start=2):
        values = [_number(path, line, row[column]) for column in columns]
        key = _key(row[at["time"]])
        if key in _PLACE_KEYS:
            stated[key] = values
        else:
            times_ns.append(_time_ns(path, line, row[at["time"]]))
            light.append(values)
    table = np.array(light, dtype=np.float64).reshape(len(light), len(names))
    places, is_geographic = _places(names, stated)
    return LightTable(names, np.array(times_ns, dtype=np.int64), table, places, is_geographic)


def _places(names: Sequence[str], stated: Mapping[str, Sequence[float]]) -> tuple[Places, bool]:
    """Return the places that values by `PLACE_PAIRS` state, and whether they are geographic."""
    for first, second in PLACE_PAIRS:
        if first in stated and second in stated:
            both = zip(stated[first], stated[second], strict=True)
            return dict(zip(names, both, strict=True)), first == "lat"
    return {}, False


_PLACE_KEYS = frozenset(chain(*PLACE_PAIRS))


def _places_of_rows(
    path: Path, rows: Sequence[Sequence[str]], at: Mapping[str, int]
) -> tuple[Places, bool]:
    """Return the places that rows state of the sensor in them."""
    stated = {
        key: [_number(path, line, row[at[key]]) for line, row in enumerate(rows, start=2)]
        for key in _PLACE_KEYS & at.keys()
    }
    return _places([row[at["sensor"]].strip() for row in rows], stated)


def _long_form(
    path: Path, head: Sequence[str], rows: Sequence[Sequence[str]], at: Mapping[str, int]
) -> LightTable:
    """Return a table of rows of one sensor and one time each, at the sensors' usual step."""
    values = [n for n in range(len(head)) if n not in at.values()]
    if len(values) != 1:
        named = ", ".join(head[n] for n in values) or "none"
        raise RecordError(f"{path}: expected one column of values beside the sensor, got {named}")
    names = tuple(dict.fromkeys(row[at["sensor"]].strip() for row in rows))
    number_of = {name: number for number, name in enumerate(names)}
    sensors = np.array([number_of[row[at["sensor"]].strip()] for row in rows], dtype=np.int64)
    times_ns = np.array(
        [_time_ns(path, line, row[at["time"]]) for line, row in enumerate(rows, start=2)],
        dtype=np.int64,
    )
    light = [_number(path, line, row[values[0]]) for line, row in enumerate(rows, start=2)]
    step_ns = _usual_step_ns(times_ns, sensors)
    # Loggers do not write at one moment: each value counts for the step that it is nearest to.
    first_ns = int(times_ns.min())
    steps, row_of = np.unique(np.rint((times_ns - first_ns) / step_ns), return_inverse=True)
    found = np.full((len(steps), len(names)), np.nan)
    found[row_of, sensors] = light
    repeated = len(rows) - len(np.unique(row_of * len(names) + sensors))
    places, is_geographic = _places_of_rows(path, rows, at)
    at_ns = first_ns + (steps * step_ns).astype(np.int64)
    return LightTable(names, at_ns, found, places, is_geographic, repeated)


def _usual_step_ns(times_ns: IntArray, sensors: IntArray) -> int:
    """Return the median time between two values of one sensor."""
    gaps = [np.diff(np.unique(times_ns[sensors == number])) for number in np.unique(sensors)]
    together = np.concatenate([*gaps, np.array([], dtype=np.int64)])
    return max(1, int(np.median(together))) if len(together) else NS_PER_S


def _npz_table(path: Path) -> LightTable:
    try:
        with np.load(path, allow_pickle=False) as found:
            arrays = {name: np.asarray(found[name]) for name in found}
    except (ValueError, KeyError) as problem:
        raise RecordError(f"{path}: expected an .npz of arrays, got: {problem}") from problem
    return _of_arrays(path, arrays)


def _netcdf_table(path: Path) -> LightTable:
    """Return the table of a NetCDF file: one variable by time and sensor, its times and places."""
    import netCDF4

    with netCDF4.Dataset(path) as file:
        found = {name: each for name, each in file.variables.items() if each.dtype.kind in "fiu"}
        arrays = {
            name: np.ma.filled(np.ma.asarray(each[...], np.float64), np.nan)
            for name, each in found.items()
        }
        named = next((name for name in found if _key(name) == "time"), None)
        if named is not None:
            about = found[named]
            units, calendar = (getattr(about, what, "") for what in ("units", "calendar"))
            try:
                at = netCDF4.num2date(arrays[named], units, calendar or "standard")
                arrays[named] = np.asarray(netCDF4.date2num(at, UNIX_TIME), np.float64)
            except (ValueError, TypeError, AttributeError, OverflowError) as problem:
                raise RecordError(
                    f"{path}: expected time in units 'seconds since ...', got {units!a:.80}"
                ) from problem
    return _of_arrays(path, arrays)


def _of_arrays(path: Path, arrays: Mapping[str, np.ndarray]) -> LightTable:
    at = {_key(name): each for name, each in arrays.items()}
    values = [name for name, each in arrays.items() if each.ndim == 2]
    if "time" not in at or at["time"].ndim != 1 or len(values) != 1:
        raise RecordError(
            f"{path}: expected an array time and one of values by time and sensor, "
            f"got {', '.join(f'{name} {each.shape}' for name, each in arrays.items())}"
        )
    light = arrays[values[0]].astype(np.float64)
    count = light.shape[1]
    if len(light) != len(at["time"]):
        raise RecordError(
            f"{path}: expected {len(at['time'])} rows in {values[0]}, as times, got {len(light)}"
        )
    given = at.get("sensor")
    names = tuple(map(str, range(count) if given is None else given.tolist()))
    stated = {key: at[key].tolist() for key in _PLACE_KEYS & at.keys() if at[key].shape == (count,)}
    if len(names) != count:
        raise RecordError(f"{path}: expected {count} names of sensors, got {len(names)}")
    places, is_geographic = _places(names, stated)
    times_s = at["time"].astype(np.float64)
    _expect_seconds(path, 0, times_s)
    times_ns = np.rint(times_s * 1e3).astype(np.int64) * (NS_PER_S // 1_000)
    return LightTable(names, times_ns, light, places, is_geographic)


def _rows(path: Path) -> tuple[list[str], list[list[str]]]:
    """Return head and rows of a CSV, by the separator that its first line has most of."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as problem:
        raise RecordError(f"{path}: expected a CSV in UTF-8, got other bytes") from problem
    first = text.partition("\n")[0]
    separator = max(",;\t", key=first.count)
    rows = [row for row in csv.reader(text.splitlines(), delimiter=separator) if row]
    if len(rows) < 2:
        raise RecordError(f"{path}: expected a head and rows of values, got {len(rows)} lines")
    head = [each.strip() for each in rows[0]]
    for line, row in enumerate(rows[1:], start=2):
        if len(row) != len(head):
            raise RecordError(f"{path}, row {line}: expected {len(head)} values, got {len(row)}")
    repeated = {each for each in head if head.count(each) > 1}
    if repeated:
        raise RecordError(f"{path}: expected each column once, got {min(repeated)} twice")
    return head, rows[1:]


def _key(name: str) -> str:
    """Return the key of `NAMES` that a name stands for; else the name."""
    plain = name.strip().lower()
    return next((key for key, others in NAMES.items() if plain in others), plain)


def _columns(head: Sequence[str]) -> dict[str, int]:
    return {key: n for n, name in enumerate(head) if (key := _key(name)) in NAMES}


def _number(path: Path, line: int, text: str) -> float:
    if text.strip().lower() in UNKNOWN:
        return float("nan")
    try:
        return float(text)
    except ValueError:
        raise RecordError(f"{path}, row {line}: expected a number, got {text!a}") from None


def _time_ns(path: Path, line: int, text: str) -> int:
    try:
        at_s = float(text)
    except ValueError:
        try:
            return unix_ns(_datetime_s(text))
        except ValueError:
            raise RecordError(
                f"{path}, row {line}: expected a time in ISO 8601 or Unix seconds, got {text!a}"
            ) from None
    _expect_seconds(path, line, np.array([at_s]))
    return unix_ns(at_s)


def _datetime_s(text: str) -> float:
    found = datetime.fromisoformat(text.strip().removesuffix("UTC").strip())
    return (found if found.tzinfo else found.replace(tzinfo=UTC)).timestamp()


def _expect_seconds(path: Path, line: int, times_s: FloatArray) -> None:
    wrong = ~((times_s >= EARLIEST_S) & (times_s <= LATEST_S))
    if wrong.any():
        where = f", row {line}" if line else ""
        raise RecordError(
            f"{path}{where}: expected Unix seconds, got {times_s[wrong][0]:g}"
            f"{' (milliseconds?)' if times_s[wrong][0] > LATEST_S else ''}"
        )


READERS = {".csv": _csv_table, ".txt": _csv_table, ".npz": _npz_table, ".nc": _netcdf_table}
"""By the ending of a file."""
