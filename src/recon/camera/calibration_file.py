"""The calibration file, as exported by Scaramuzza's toolbox (calib_results.txt).

Five lines of numbers, with comments (#) and empty lines between: the direct and the inverse
polynomial, each preceded by its number of coefficients, lowest power first (the exporting tool
writes the inverse one lowest power first too); the centre as row and column from 0; the affine
parameters c, d, e; image height and width.
"""

import math
from pathlib import Path

from recon.camera.data_lines import DataLine, data_lines, read_small_text, shown
from recon.camera.errors import CalibrationError
from recon.camera.omnidirectional import OmnidirectionalCamera

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
