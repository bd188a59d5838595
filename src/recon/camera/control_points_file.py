"""The control points file (GCPs.txt): marked points in the frame and on the globe.

One point per line: identifier, column, row, latitude, longitude, WGS84 altitude, comma-separated.
The centre of the frame's upper-left pixel has column 0 and row 0. Comments start with #.
"""

import math
from dataclasses import dataclass
from pathlib import Path

from recon.camera.data_lines import DataLine, data_lines, read_small_text, shown
from recon.camera.errors import ControlPointsError
from recon.model.geo import GeoPoint

FIELDS = ("column", "row", "latitude", "longitude", "altitude")
RANGES = {
    "column": (-0.5, 65_535.0),
    "row": (-0.5, 65_535.0),
    "latitude": (-90.0, 90.0),
    "longitude": (-180.0, 180.0),
    "altitude": (-1_000.0, 10_000.0),
}
MOST_POINTS = 200
LONGEST_NAME = 32


@dataclass(frozen=True, slots=True)
class ControlPoint:
    """A marked point: pixel in the marked frame (col, row from 0) and WGS84 position."""

    name: str
    col_px: float
    row_px: float
    latitude_deg: float
    longitude_deg: float
    ellipsoid_height_m: float

    @property
    def place(self) -> GeoPoint:
        """Position on the globe."""
        return GeoPoint(self.latitude_deg, self.longitude_deg, self.ellipsoid_height_m)


def load_control_points(path: Path) -> tuple[ControlPoint, ...]:
    """Return the points of a file; raises `ControlPointsError` naming file and line."""
    return parse_control_points(read_small_text(path, ControlPointsError), str(path))


def parse_control_points(text: str, source: str) -> tuple[ControlPoint, ...]:
    """Return the points of a file's text; `source` is its name for messages.

    Raises `ControlPointsError`. `pose_from_points` checks how many points a pose needs.
    """
    lines = data_lines(text)
    if not lines:
        raise ControlPointsError(
            f"{source}, line 1: expected lines of identifier, {', '.join(FIELDS)}, got none"
        )
    if len(lines) > MOST_POINTS:
        raise ControlPointsError(
            f"{source}, line {lines[MOST_POINTS].number}: expected at most {MOST_POINTS} points, "
            f"got {len(lines)}"
        )
    first_line_of: dict[str, int] = {}
    points = []
    for line in lines:
        point = _point(line, source)
        if point.name in first_line_of:
            raise ControlPointsError(
                f"{source}, line {line.number}: expected a new identifier, got "
                f"{shown(point.name)} again (first on line {first_line_of[point.name]})"
            )
        first_line_of[point.name] = line.number
        points.append(point)
    return tuple(points)


def format_control_points(points: tuple[ControlPoint, ...]) -> str:
    """Return the text of a control points file; parsing it gives equal points."""
    header = (
        "# Ground control points: identifier, column, row (pixels of the marked frame),\n"
        "# latitude, longitude (degrees), WGS84 altitude (m).\n"
        "# The centre of the upper-left pixel has column 0 and row 0.\n"
    )
    return header + "".join(
        f"{p.name}, {p.col_px!r}, {p.row_px!r}, {p.latitude_deg!r}, {p.longitude_deg!r}, "
        f"{p.ellipsoid_height_m!r}\n"
        for p in points
    )


def _point(line: DataLine, source: str) -> ControlPoint:
    words = [word.strip() for word in line.text.split(",")]
    if len(words) != 1 + len(FIELDS):
        raise ControlPointsError(
            f"{source}, line {line.number}: expected {1 + len(FIELDS)} comma-separated values "
            f"(identifier, {', '.join(FIELDS)}), got {len(words)}: {shown(line.text)}"
        )
    name = words[0]
    if not name or len(name) > LONGEST_NAME or not name.isprintable():
        raise ControlPointsError(
            f"{source}, line {line.number}: expected an identifier of 1 to {LONGEST_NAME} "
            f"printable characters, got {shown(name)}"
        )
    values = (
        _value(word, field, line, source) for word, field in zip(words[1:], FIELDS, strict=True)
    )
    return ControlPoint(name, *values)


def _value(word: str, field: str, line: DataLine, source: str) -> float:
    lowest, highest = RANGES[field]
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not lowest <= value <= highest:
        raise ControlPointsError(
            f"{source}, line {line.number}: {field}: expected a number from {lowest:g} to "
            f"{highest:g}, got {shown(word)}"
        )
    return value
