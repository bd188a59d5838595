"""A mission from a file: Recon's own JSON, or a GeoJSON line as QGIS and others write it."""

import json
from dataclasses import fields
from math import isfinite
from pathlib import Path
from typing import Any

from recon.client import ClientError, Mission, Waypoint
from recon.model.file_kind import file_kind

LARGEST_FILE_BYTES = 4 * 1024 * 1024
MOST_WAYPOINTS = 5_000
"""The station splits missions that are too long for an aircraft; more is surely not a mission."""

_WAYPOINT_KEYS = frozenset(field.name for field in fields(Waypoint))
_MISSION_KEYS = frozenset({"waypoints", "land_at_end", "curved"})


class MissionFileError(ClientError):
    """Not a mission; the text names the file and the place in it."""


def read_mission(path: Path, height_m: float | None, speed_mps: float | None) -> Mission:
    """Return the mission of a file; height and speed are for GeoJSON, which may lack them.

    Raises `MissionFileError`.
    """
    data = _read(path)
    kind = data.get("type")
    if kind in ("FeatureCollection", "Feature", "LineString"):
        return _from_line(path, data, height_m, speed_mps)
    if kind is not None or "waypoints" not in data:
        raise MissionFileError(
            f"{path}: expected a mission with waypoints, or GeoJSON with one LineString, got "
            f"{json.dumps(kind)[:40] if kind is not None else 'neither'}"
        )
    _refuse_unknown(path, "the mission", data, _MISSION_KEYS)
    waypoints = data["waypoints"]
    if not isinstance(waypoints, list):
        raise MissionFileError(f"{path}: waypoints: expected a list, got {_shown(waypoints)}")
    _refuse_too_many(path, len(waypoints))
    return Mission(
        tuple(_waypoint(path, number, w) for number, w in enumerate(waypoints, start=1)),
        land_at_end=_flag(path, data, "land_at_end"),
        curved=_flag(path, data, "curved"),
    )


def _read(path: Path) -> dict[str, Any]:
    try:
        with path.open("rb") as file:
            text = file.read(LARGEST_FILE_BYTES + 1)
    except OSError as problem:
        raise MissionFileError(f"{path}: cannot be read: {problem.strerror}") from problem
    if len(text) > LARGEST_FILE_BYTES:
        raise MissionFileError(f"{path}: expected up to {LARGEST_FILE_BYTES} bytes, got more")
    try:
        data = json.loads(text, parse_constant=_no_constant)
    except (ValueError, RecursionError) as problem:
        raise MissionFileError(
            f"{path}: expected a mission: Recon's own JSON with waypoints, or GeoJSON with one "
            f"LineString; got {_kind(text, problem)}"
        ) from problem
    if not isinstance(data, dict):
        raise MissionFileError(f"{path}: expected a JSON object, got {_shown(data)}")
    return data


def _kind(text: bytes, problem: Exception) -> str:
    """Return what came, and where other files are read."""
    kind = file_kind(text[:8])
    if kind.startswith("a JSON"):
        return f"damaged JSON: {problem}"
    areas = "XML" in kind or "KML" in kind or "KMZ" in kind
    return kind + (": recon plan and recon site import read areas" if areas else "")


def _no_constant(word: str) -> float:
    raise ValueError(f"{word} is not a JSON number")


def _waypoint(path: Path, number: int, data: Any) -> Waypoint:
    place = f"waypoint {number}"
    if not isinstance(data, dict):
        raise MissionFileError(f"{path}: {place}: expected an object, got {_shown(data)}")
    _refuse_unknown(path, place, data, _WAYPOINT_KEYS)
    values: dict[str, Any] = {}
    for key, value in data.items():
        may_be_null = key in ("loiter_s", "gimbal_pitch_deg")
        values[key] = (
            None if value is None and may_be_null else _number(path, f"{place}: {key}", value)
        )
    try:
        return Waypoint(**values)
    except TypeError as problem:
        missing = sorted(
            {"latitude_deg", "longitude_deg", "height_above_takeoff_m", "speed_mps"} - set(values)
        )
        raise MissionFileError(f"{path}: {place}: expected {', '.join(missing)}") from problem


def _from_line(
    path: Path, data: dict[str, Any], height_m: float | None, speed_mps: float | None
) -> Mission:
    """Return the mission along the one LineString: longitude, latitude, optional height above
    takeoff."""
    lines = list(_lines(data, 0))
    if len(lines) != 1:
        raise MissionFileError(f"{path}: expected one LineString, got {len(lines)}")
    positions = lines[0].get("coordinates")
    if not isinstance(positions, list):
        raise MissionFileError(f"{path}: coordinates: expected a list, got {_shown(positions)}")
    _refuse_too_many(path, len(positions))
    if speed_mps is None:
        raise MissionFileError(f"{path}: GeoJSON has no speed: use --speed")
    return Mission(
        tuple(
            _position(path, number, position, height_m, speed_mps)
            for number, position in enumerate(positions, start=1)
        )
    )


def _lines(data: Any, depth: int) -> Any:
    if not isinstance(data, dict) or depth > 2:
        return
    match data.get("type"):
        case "LineString":
            yield data
        case "Feature":
            yield from _lines(data.get("geometry"), depth + 1)
        case "FeatureCollection":
            features = data.get("features")
            for feature in features if isinstance(features, list) else []:
                yield from _lines(feature, depth + 1)


def _position(
    path: Path, number: int, position: Any, height_m: float | None, speed_mps: float
) -> Waypoint:
    place = f"position {number}"
    if not isinstance(position, list) or len(position) not in (2, 3):
        raise MissionFileError(
            f"{path}: {place}: expected longitude, latitude and an optional height, got "
            f"{_shown(position)}"
        )
    longitude, latitude, *rest = (_number(path, place, value) for value in position)
    if height_m is None and not rest:
        raise MissionFileError(f"{path}: {place} has no height: use --height")
    return Waypoint(latitude, longitude, rest[0] if height_m is None else height_m, speed_mps)


def _number(path: Path, place: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        raise MissionFileError(f"{path}: {place}: expected a number, got {_shown(value)}")
    return float(value)


def _flag(path: Path, data: dict[str, Any], key: str) -> bool:
    value = data.get(key, False)
    if not isinstance(value, bool):
        raise MissionFileError(f"{path}: {key}: expected true or false, got {_shown(value)}")
    return value


def _refuse_unknown(path: Path, place: str, data: dict[str, Any], known: frozenset[str]) -> None:
    for key in data:
        if key not in known:
            raise MissionFileError(
                f"{path}: {place}: expected {', '.join(sorted(known))}, got {_shown(key)}"
            )


def _refuse_too_many(path: Path, count: int) -> None:
    if count > MOST_WAYPOINTS:
        raise MissionFileError(f"{path}: expected up to {MOST_WAYPOINTS} waypoints, got {count}")


def _shown(value: Any) -> str:
    return json.dumps(value)[:60]
