"""Files of light sensors, checked: what cannot be used is counted and named, or refused."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from recon.geo import enu_from_geo
from recon.light.points import FULL_PERCENTILE, LightPoints
from recon.light.rows import Places
from recon.light.tables import LightTable, read_places, read_table
from recon.model.arrays import FloatArray
from recon.model.errors import RecordError
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.units import NS_PER_S

FEWEST_SENSORS, FEWEST_TIMES = 3, 3
WIDEST_M = 20_000.0
"""Farther apart places are degrees taken for metres, or of several fields."""
LONG_GAP_STEPS = 1.5
LONGEST_S = 3.0 * 3600.0
"""Over more the sun's height changes full light by more than thin cloud does."""
MOST_NAMES = 5


def read_points(
    path: Path, places_path: Path | None = None, fewest: int = FEWEST_SENSORS
) -> LightPoints:
    """Return the sensors of a file, in the order of time; raises `RecordError`."""
    table = read_table(path)
    if places_path is not None:
        places, is_geographic = read_places(places_path)
        table = replace(table, places=places, is_geographic=is_geographic)
    return points_of(path, table, fewest)


def points_of(path: Path, table: LightTable, fewest: int = FEWEST_SENSORS) -> LightPoints:
    """Return the sensors of a table in the order of time: `fewest` or more, three for maps between
    them; raises `RecordError`."""
    places = table.places
    if not places:
        raise RecordError(
            f"{path}: expected places of the sensors (rows or columns lat and lon, or east_m and "
            "north_m), or --places with a CSV of them"
        )
    notes: list[str] = []
    order = _order(table, notes)
    light, columns = table.light[order], _usable(table, places, notes)
    if len(columns) < fewest or len(order) < FEWEST_TIMES:
        raise RecordError(
            f"{path}: expected {fewest} sensors with light and a place and "
            f"{FEWEST_TIMES} times or more, got {len(columns)} and {len(order)}"
            + "".join(f"; {note}" for note in notes)
        )
    names = tuple(table.names[column] for column in columns)
    at = np.array([places[name] for name in names], dtype=np.float64)
    frame, east_m, north_m = _placed(path, names, at, table.is_geographic)
    times_ns, light = table.times_ns[order], light[:, columns]
    points = LightPoints(names, times_ns, light, east_m, north_m, frame)
    notes += _facts(points)
    return LightPoints(names, times_ns, light, east_m, north_m, frame, tuple(notes))


def _order(table: LightTable, notes: list[str]) -> np.ndarray:
    """Return the rows in order of time, the first one of each."""
    _times, first = np.unique(table.times_ns, return_index=True)
    repeated = len(table.times_ns) - len(first) + table.repeated
    if repeated:
        notes.append(f"{repeated} values or rows at a time seen before, not used")
    return first


def _usable(table: LightTable, places: Places, notes: list[str]) -> list[int]:
    known = [np.isfinite(places.get(name, (np.nan, np.nan))).all() for name in table.names]
    _name(notes, "without a place", [n for n, k in zip(table.names, known, strict=True) if not k])
    values = np.isfinite(table.light)
    full = np.array(
        [
            np.percentile(light[is_known], FULL_PERCENTILE) if is_known.any() else 0.0
            for light, is_known in zip(table.light.T, values.T, strict=True)
        ]
    )
    lit = full > 0.0
    dark = [n for n, k, on in zip(table.names, known, lit, strict=True) if k and not on]
    _name(notes, "without light", dark)
    return [number for number, (k, on) in enumerate(zip(known, lit, strict=True)) if k and on]


def _name(notes: list[str], what: str, names: list[str]) -> None:
    if names:
        more = ", ..." if len(names) > MOST_NAMES else ""
        notes.append(f"{len(names)} sensors {what}: {', '.join(names[:MOST_NAMES])}{more}")


def _farthest(east_m: FloatArray, north_m: FloatArray) -> int:
    """Return the sensor that is farthest from most others."""
    return int(np.argmax(np.hypot(east_m - np.median(east_m), north_m - np.median(north_m))))


def _placed(
    path: Path, names: Sequence[str], at: FloatArray, is_geographic: bool
) -> tuple[LocalFrame | None, FloatArray, FloatArray]:
    frame, east_m, north_m = None, at[:, 0], at[:, 1]
    if is_geographic:
        if (np.abs(at) > (90.0, 180.0)).any():
            raise RecordError(f"{path}: expected latitudes and longitudes in degrees, got others")
        middle = at.mean(axis=0)
        frame = LocalFrame(GeoPoint(float(middle[0]), float(middle[1]), 0.0))
        enu_m = enu_from_geo(frame, at[:, 0], at[:, 1], np.zeros(len(at)))
        east_m, north_m = enu_m[:, 0], enu_m[:, 1]
    wide_m = max(float(np.ptp(east_m)), float(np.ptp(north_m)))
    if wide_m > WIDEST_M:
        raise RecordError(
            f"{path}: expected places within {WIDEST_M / 1e3:g} km, got {wide_m / 1e3:.0f} km: "
            f"correct that of {names[_farthest(east_m, north_m)]}, or leave it out"
        )
    if wide_m < 1.0 and len(at) >= FEWEST_SENSORS:
        raise RecordError(
            f"{path}: expected places in metres or degrees apart, got {wide_m:.3f} m "
            "(degrees named east and north?)"
        )
    return frame, east_m, north_m


def _facts(points: LightPoints) -> list[str]:
    found, gaps_s = [], np.diff(points.times_ns) / NS_PER_S
    long = gaps_s > LONG_GAP_STEPS * points.step_s
    if long.any():
        found.append(f"{int(long.sum())} gaps in time, the longest {gaps_s.max():g} s")
    missing = float(np.isnan(points.light).mean())
    if missing:
        found.append(f"{100.0 * missing:.1f} % of the values unknown")
    span_s = float(points.times_ns[-1] - points.times_ns[0]) / NS_PER_S
    if span_s > LONGEST_S:
        found.append(
            f"{span_s / 3600.0:.1f} h in one file: full light changes with the sun; cut it in hours"
        )
    return found
