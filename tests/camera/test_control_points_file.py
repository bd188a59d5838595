"""The control points' file: what it holds, and what bad ones get."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.camera import (
    ControlPoint,
    ControlPointsError,
    format_control_points,
    load_control_points,
    parse_control_points,
)

GOOD = "# a comment\n\nA, 10.5, 20, 45.1, -93.2, 288\nB, 1, 2, 45.2, -93.3, 289.5\n"

points = st.lists(
    st.builds(
        ControlPoint,
        name=st.text("abcXYZ0189-_", min_size=1, max_size=12),
        col_px=st.floats(-0.5, 65_535.0),
        row_px=st.floats(-0.5, 65_535.0),
        latitude_deg=st.floats(-90.0, 90.0),
        longitude_deg=st.floats(-180.0, 180.0),
        ellipsoid_height_m=st.floats(-1_000.0, 10_000.0),
    ),
    min_size=1,
    max_size=10,
    unique_by=lambda p: p.name,
).map(tuple)


def test_columns_come_before_rows_and_latitude_before_longitude() -> None:
    first, second = parse_control_points(GOOD, "GCPs.txt")
    assert first == ControlPoint("A", 10.5, 20.0, 45.1, -93.2, 288.0)
    assert second.name == "B"


@given(points)
def test_writing_and_reading_gives_the_same_points(written: tuple[ControlPoint, ...]) -> None:
    assert parse_control_points(format_control_points(written), "GCPs.txt") == written


@pytest.mark.parametrize(
    ("site", "count"), [("becker-1", 7), ("elgin-5", 5), ("grand-meadow-7", 4)]
)
def test_the_real_files_are_read(fisheye_data: Path, site: str, count: int) -> None:
    assert len(load_control_points(fisheye_data / site / "GCPs.txt")) == count


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("C, 1, 2, 45, -93", r"expected 6 comma-separated values .* got 5: 'C, 1, 2, 45, -93'"),
        ("C, 1, 2, 45, -93, 288, 7", r"expected 6 comma-separated values .* got 7"),
        ("C, 1; 2, 45, -93, 288, 7", r"column: expected a number from -0.5 to 65535, got '1; 2'"),
        ("C, 1, 2, 145, -93, 288", r"latitude: expected a number from -90 to 90, got '145'"),
        ("C, 1, 2, 45, -193, 288", r"longitude: expected a number from -180 to 180, got '-193'"),
        ("C, 1, 2, 45, -93, 1e5", r"altitude: expected a number from -1000 to 10000, got '1e5'"),
        ("C, nan, 2, 45, -93, 288", r"column: expected a number .* got 'nan'"),
        ("C, 1, -7, 45, -93, 288", r"row: expected a number .* got '-7'"),
        (", 1, 2, 45, -93, 288", r"expected an identifier of 1 to 32 printable characters, got ''"),
        ("\x1b[2J, 1, 2, 45, -93, 288", r"expected an identifier .* got '\\x1b\[2J'"),
        ("x" * 5000, r"expected 6 comma-separated values .* got 1: 'x{60}\.\.\.'"),
        ("A, 1, 2, 45, -93, 288", r"expected a new identifier, got 'A' again \(first on line 3\)"),
    ],
)
def test_a_bad_line_is_named_with_what_was_expected(line: str, message: str) -> None:
    with pytest.raises(ControlPointsError, match=rf"^GCPs\.txt, line 5: {message}"):
        parse_control_points(GOOD + line + "\n", "GCPs.txt")


def test_no_points_and_too_many_are_refused() -> None:
    with pytest.raises(ControlPointsError, match=r"GCPs\.txt, line 1: expected lines of"):
        parse_control_points("# only a comment\n", "GCPs.txt")
    many = "".join(f"P{i}, 1, 2, 45, -93, 288\n" for i in range(201))
    with pytest.raises(ControlPointsError, match=r"line 201: expected at most 200 points, got 201"):
        parse_control_points(many, "GCPs.txt")


def error_message(text: str) -> str | None:
    """Return the error message of reading this, None when it gives points."""
    try:
        parsed = parse_control_points(text, "GCPs.txt")
    except ControlPointsError as problem:
        return str(problem)
    assert parsed
    return None


@given(st.text(max_size=300))
def test_any_text_gives_points_or_a_named_line(text: str) -> None:
    message = error_message(text)
    assert message is None or message.startswith("GCPs.txt, line ")
    assert message is None or message.isprintable()


@given(st.lists(st.text("0123456789.,-+eAnif \n#", max_size=40), max_size=8))
def test_text_that_looks_like_points_gives_points_or_a_named_line(lines: list[str]) -> None:
    message = error_message("\n".join(lines))
    assert message is None or message.startswith("GCPs.txt, line ")
