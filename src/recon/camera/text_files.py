"""The text files of a camera, hand-edited and untrusted: calibration and control points.

The calibration file is what Scaramuzza's toolbox exports (calib_results.txt). Five lines of
numbers, with comments (#) and empty lines between: the direct and the inverse polynomial, each
preceded by its number of coefficients, lowest power first (the exporting tool writes the inverse
one lowest power first too); the centre as row and column from 0; the affine parameters c, d, e;
image height and width.

The control points file (GCPs.txt) has marked points in the frame and on the globe, one per line:
identifier, column, row, latitude, longitude, WGS84 altitude, comma-separated. The centre of the
frame's upper-left pixel has column 0 and row 0. Comments start with #.
"""

import math
from dataclasses import dataclass
from pathlib import Path

from recon.camera.errors import CalibrationError, CameraError, ControlPointsError
from recon.camera.omnidirectional import OmnidirectionalCamera
from recon.model.geo import GeoPoint

LARGEST_FILE_BYTES = 64 * 1024
"""Real files have under 2 KiB; anything much larger is a wrong file."""

SHOWN_CHARACTERS = 60


@dataclass(frozen=True, slots=True)
class DataLine:
    """A line that is neither empty nor a comment; `number` counts from 1."""

    number: int
    text: str


def read_small_text(path: Path, error: type[CameraError]) -> str:
    """Return the text of a UTF-8 file; raises `error` when it cannot be one."""
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE_BYTES + 1)
    except OSError as problem:
        raise error(
            f"{path}: expected a readable file, got: {problem.strerror or problem}; check the name "
            "on the command line or in site.toml"
        ) from problem
    if len(data) > LARGEST_FILE_BYTES:
        raise error(
            f"{path}: expected at most {LARGEST_FILE_BYTES} bytes, got more; is it the right file?"
        )
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        line = data[: problem.start].count(b"\n") + 1
        raise error(
            f"{path}, line {line}: expected UTF-8 text, got byte 0x{data[problem.start]:02x}; "
            "save the file as plain text"
        ) from problem


def data_lines(text: str) -> list[DataLine]:
    """Return the lines that carry data; a comment starts with # and fills its line."""
    # str.splitlines also splits at form feeds and the like: line numbers would differ from an
    # editor's.
    numbered = enumerate(text.split("\n"), start=1)
    stripped = (DataLine(number, line.strip()) for number, line in numbered)
    return [line for line in stripped if line.text and not line.text.startswith("#")]


def shown(text: str) -> str:
    """Return the text quoted, shortened and without control characters, for a message."""
    short = text if len(text) <= SHOWN_CHARACTERS else text[:SHOWN_CHARACTERS] + "..."
    return ascii(short)


SECTIONS = (
    "direct polynomial (count, then coefficients)",
    "inverse polynomial (count, then coefficients)",
    "centre (row, column)",
    "affine parameters (c, d, e)",
    "image size (height, width)",
)
MOST_COEFFICIENTS = 32
LARGEST_SIDE_PX = 16_384


def load_camera(path: Path) -> OmnidirectionalCamera:
    """Return the camera of a calibration file; raises `CalibrationError` naming file and line."""
    return parse_camera(read_small_text(path, CalibrationError), str(path))


def parse_camera(text: str, source: str) -> OmnidirectionalCamera:
    """Return the camera that the text of a calibration file describes.

    `source` is the file's name for messages. Raises `CalibrationError`.
    """
    lines = data_lines(text)
    if len(lines) != len(SECTIONS):
        raise CalibrationError(_wrong_line_count(lines, source))
    direct = _polynomial(lines[0], SECTIONS[0], source)
    inverse = _polynomial(lines[1], SECTIONS[1], source)
    centre_row, centre_col = _numbers(lines[2], 2, SECTIONS[2], source)
    c, d, e = _numbers(lines[3], 3, SECTIONS[3], source)
    size = _numbers(lines[4], 2, SECTIONS[4], source)
    rows, cols = (_side(value, lines[4], source) for value in size)
    try:
        return OmnidirectionalCamera(
            direct, inverse, centre_row, centre_col, c, d, e, rows=rows, cols=cols
        )
    except CalibrationError as problem:
        line = lines[_section_of(str(problem))].number
        raise CalibrationError(f"{source}, line {line}: {problem}") from problem


def format_camera(camera: OmnidirectionalCamera) -> str:
    """Return the text of a calibration file; `parse_camera` reads it back to an equal camera."""
    rows = (
        (len(camera.direct), *camera.direct),
        (len(camera.inverse), *camera.inverse),
        (camera.centre_row_px, camera.centre_col_px),
        (camera.affine_c, camera.affine_d, camera.affine_e),
        (camera.rows, camera.cols),
    )
    return "\n".join(
        f"# {title}\n\n{' '.join(repr(value) for value in row)}\n"
        for title, row in zip(SECTIONS, rows, strict=True)
    )


def _wrong_line_count(lines: list[DataLine], source: str) -> str:
    if len(lines) < len(SECTIONS):
        where = f"after line {lines[-1].number}" if lines else "line 1"
        return (
            f"{source}, {where}: expected the {SECTIONS[len(lines)]}, got the end of the file; "
            f"{len(SECTIONS)} lines of numbers are needed"
        )
    extra = lines[len(SECTIONS)]
    return (
        f"{source}, line {extra.number}: expected nothing after the {SECTIONS[-1]}, "
        f"got {shown(extra.text)}; comments start with #"
    )


def _polynomial(line: DataLine, section: str, source: str) -> tuple[float, ...]:
    values = _numbers(line, None, section, source)
    count = values[0]
    if not 1 <= count <= MOST_COEFFICIENTS or count != len(values) - 1:
        raise CalibrationError(
            f"{source}, line {line.number}: {section}: expected a count of 1 to "
            f"{MOST_COEFFICIENTS} and that many coefficients, got the count {count:g} and "
            f"{len(values) - 1} coefficients"
        )
    return values[1:]


def _numbers(line: DataLine, count: int | None, section: str, source: str) -> tuple[float, ...]:
    words = line.text.split()
    if count is not None and len(words) != count:
        raise CalibrationError(
            f"{source}, line {line.number}: {section}: expected {count} numbers, "
            f"got {len(words)}: {shown(line.text)}"
        )
    return tuple(_number(word, line, section, source) for word in words)


def _number(word: str, line: DataLine, section: str, source: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise CalibrationError(
            f"{source}, line {line.number}: {section}: expected a finite number, got {shown(word)}"
        )
    return value


def _side(value: float, line: DataLine, source: str) -> int:
    if value != int(value) or not 2 <= value <= LARGEST_SIDE_PX:
        raise CalibrationError(
            f"{source}, line {line.number}: {SECTIONS[4]}: expected whole numbers from 2 to "
            f"{LARGEST_SIDE_PX}, got {value:g}"
        )
    return int(value)


def _section_of(problem: str) -> int:
    """Return the index of the line that an error of the camera model refers to."""
    starts = ("direct", "inverse", "centre", "affine", "image")
    return next((i for i, start in enumerate(starts) if problem.startswith(start)), 0)


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
