"""Files of light sensors as tables: CSV in wide and in long form, NumPy's .npz, NetCDF.

Names of columns and arrays are those of `rows.NAMES`, in any case; `rows` states what lines are.
"""

import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from recon.light.rows import (
    PLACE_KEYS,
    Places,
    cells_of_lines,
    columns,
    expect_cells,
    expect_once,
    expect_seconds,
    key_of,
    number,
    placed,
    read_head,
    read_row,
)
from recon.model.array_archive import ArchiveError, read_arrays
from recon.model.arrays import FloatArray, IntArray
from recon.model.errors import RecordError
from recon.model.extras import from_extra
from recon.model.units import NS_PER_S

Read = TypeVar("Read")
MOST_BYTES = 500_000_000
MOST_UNPACKED_BYTES = 130_000_000
"""Eight hours of 500 sensors, each second."""
NUMBERS = frozenset("fiu")
"""Kinds of NumPy's types that are numbers."""


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
        _expect_bytes(path, path.stat().st_size, MOST_BYTES)
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
    at = columns(head)
    if "sensor" in at:
        places, is_geographic = _places_of_rows(path, rows, at)
        if places:
            return places, is_geographic
    raise RecordError(
        f"{path}: expected columns sensor and lat, lon or sensor and east_m, north_m, "
        f"got {', '.join(head)}"
    )


def long_table(
    names: Sequence[str],
    times_ns: IntArray,
    light: FloatArray,
    places: Places,
    is_geographic: bool,
) -> LightTable:
    """Return a table of values of one sensor and one time each, at the sensors' usual step."""
    columns = tuple(dict.fromkeys(names))
    number_of = {name: number for number, name in enumerate(columns)}
    sensors = np.array([number_of[name] for name in names], dtype=np.int64)
    step_ns = _usual_step_ns(times_ns, sensors)
    # Loggers do not write at one moment: each value counts for the step that it is nearest to.
    first_ns = int(times_ns.min())
    steps, row_of = np.unique(np.rint((times_ns - first_ns) / step_ns), return_inverse=True)
    found = np.full((len(steps), len(columns)), np.nan)
    found[row_of, sensors] = light
    repeated = len(names) - len(np.unique(row_of * len(columns) + sensors))
    at_ns = first_ns + (steps * step_ns).astype(np.int64)
    return LightTable(columns, at_ns, found, places, is_geographic, repeated)


def _csv_table(path: Path) -> LightTable:
    cells, lines = _rows(path)
    try:
        head = read_head(cells)
    except RecordError as problem:
        raise RecordError(f"{path}: {problem}") from problem
    rows = [_at_line(path, n, read_row, head, cells) for n, cells in enumerate(lines, start=2)]
    if head.is_long:
        names = [row.names[0] for row in rows]
        stated = [row.place or {} for row in rows]
        places = placed(names, {key: [each[key] for each in stated] for key in stated[0]})
        light = np.array([row.values[0] for row in rows], dtype=np.float64)
        times_ns = np.array([row.time_ns for row in rows], dtype=np.int64)
        return long_table(names, times_ns, light, *places)
    timed = [row for row in rows if row.time_ns is not None]
    light = np.array([row.values for row in timed], dtype=np.float64)
    times_ns = np.array([row.time_ns for row in timed], dtype=np.int64)
    places = placed(head.names, {row.place_key: row.values for row in rows if row.place_key})
    return LightTable(head.names, times_ns, light.reshape(len(timed), len(head.names)), *places)


def _at_line(path: Path, line: int, read: Callable[..., Read], *given: Any) -> Read:
    """Return what is read of a line; raises `RecordError` that names it."""
    try:
        return read(*given)
    except RecordError as problem:
        raise RecordError(f"{path}, row {line}: {problem}") from problem


def _places_of_rows(
    path: Path, rows: Sequence[Sequence[str]], at: Mapping[str, int]
) -> tuple[Places, bool]:
    """Return the places that rows state of the sensor in them."""
    stated = {
        key: [_at_line(path, n, number, row[at[key]]) for n, row in enumerate(rows, start=2)]
        for key in PLACE_KEYS & at.keys()
    }
    return placed([row[at["sensor"]].strip() for row in rows], stated)


def _usual_step_ns(times_ns: IntArray, sensors: IntArray) -> int:
    """Return the median time between two values of one sensor."""
    gaps = [np.diff(np.unique(times_ns[sensors == number])) for number in np.unique(sensors)]
    together = np.concatenate([*gaps, np.array([], dtype=np.int64)])
    return max(1, int(np.median(together))) if len(together) else NS_PER_S


def _npz_table(path: Path) -> LightTable:
    return _of_arrays(path, _arrays_of(path, path))


def _arrays_of(path: Path, file: Path | BytesIO) -> dict[str, np.ndarray]:
    try:
        return read_arrays(file, MOST_UNPACKED_BYTES)
    except ArchiveError as problem:
        raise RecordError(f"{path}: {problem}") from problem


def _netcdf_table(path: Path) -> LightTable:
    """Return the table of a NetCDF file: one variable by time and sensor, its times and places."""
    with from_extra("netcdf", "NetCDF"):
        import netCDF4  # noqa: F401
    with path.open("rb"):
        pass  # An error to open it is told as of any file.
    ended = subprocess.run(
        (sys.executable, "-I", "-m", "recon.light.netcdf_process", str(path.resolve())),
        capture_output=True,
        check=False,
    )
    if ended.returncode != 0:
        why = ended.stdout.decode(errors="replace").strip() if ended.returncode == 1 else ""
        raise RecordError(f"{path}: expected a NetCDF file, got: {why or 'a damaged one'}")
    arrays = _arrays_of(path, BytesIO(ended.stdout))
    names = arrays.pop("names").tolist()
    return _of_arrays(path, dict(zip(names, arrays.values(), strict=True)))


def _of_arrays(path: Path, arrays: Mapping[str, np.ndarray]) -> LightTable:
    at = {key_of(name): each for name, each in arrays.items()}
    for name in ({"time"} | PLACE_KEYS) & at.keys():
        if at[name].dtype.kind not in NUMBERS:
            raise RecordError(f"{path}: expected numbers in {name}, got {at[name].dtype}")
    values = [n for n, each in arrays.items() if each.ndim == 2 and each.dtype.kind in NUMBERS]
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
    names = tuple(map(str, range(count) if given is None else np.ravel(given).tolist()))
    stated = {key: at[key].tolist() for key in PLACE_KEYS & at.keys() if at[key].shape == (count,)}
    if len(names) != count:
        raise RecordError(f"{path}: expected {count} names of sensors, got {len(names)}")
    places, is_geographic = placed(names, stated)
    times_s = at["time"].astype(np.float64)
    for at_s in (times_s.min(), times_s.max()) if len(times_s) else ():
        _expect_seconds(path, at_s)
    times_ns = np.rint(times_s * 1e3).astype(np.int64) * (NS_PER_S // 1_000)
    return LightTable(names, times_ns, light, places, is_geographic)


def _rows(path: Path) -> tuple[list[str], list[list[str]]]:
    """Return head and rows of a CSV, by the separator that its first line has most of."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as problem:
        raise RecordError(f"{path}: expected a CSV in UTF-8, got other bytes") from problem
    rows = cells_of_lines(text.splitlines(), text.partition("\n")[0])
    if len(rows) < 2:
        raise RecordError(f"{path}: expected a head and rows of values, got {len(rows)} lines")
    head = [each.strip() for each in rows[0]]
    try:
        expect_once(head)
    except RecordError as problem:
        raise RecordError(f"{path}: {problem}") from problem
    for line, row in enumerate(rows[1:], start=2):
        _at_line(path, line, expect_cells, head, row)
    return head, rows[1:]


def _expect_bytes(path: Path, size: int, most: int) -> None:
    """Raise `RecordError` for more than is read of a file, as it is or unpacked."""
    if size > most:
        raise RecordError(f"{path}: expected at most {most // 1_000_000} MB of values")


def _expect_seconds(path: Path, at_s: float) -> None:
    try:
        expect_seconds(at_s)
    except RecordError as problem:
        raise RecordError(f"{path}: {problem}") from problem


READERS = {".csv": _csv_table, ".txt": _csv_table, ".npz": _npz_table, ".nc": _netcdf_table}
"""By the ending of a file."""
