"""The lens's file: what it holds, and what bad ones get."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tools.demo_site import demo_camera

from recon.camera import CalibrationError, format_camera, load_camera, parse_camera

TEXT = format_camera(demo_camera())
DATA_LINES = [i for i, line in enumerate(TEXT.split("\n")) if line and not line.startswith("#")]


def with_line(index: int, text: str) -> str:
    lines = TEXT.split("\n")
    lines[DATA_LINES[index]] = text
    return "\n".join(lines)


def test_writing_and_reading_gives_the_same_camera() -> None:
    assert parse_camera(TEXT, "lens.txt") == demo_camera()


def test_windows_line_ends_and_a_byte_order_mark_do_no_harm(tmp_path: Path) -> None:
    path = tmp_path / "lens.txt"
    path.write_bytes(b"\xef\xbb\xbf" + TEXT.replace("\n", "\r\n").encode())
    assert load_camera(path) == demo_camera()


def test_the_real_file_is_read_with_row_before_column(fisheye_data: Path) -> None:
    camera = load_camera(fisheye_data / "camera-model.txt")
    assert (camera.rows, camera.cols) == (720, 1280)
    assert (camera.centre_row_px, camera.centre_col_px) == (359.0, 639.0)
    assert len(camera.direct) == 5
    assert len(camera.inverse) == 15


@pytest.mark.parametrize(
    ("index", "text", "message"),
    [
        (0, "5 -250 0 0 x 1e-8", "direct polynomial .*: expected a finite number, got 'x'"),
        (0, "5 -250 0 0 nan 1e-8", "expected a finite number, got 'nan'"),
        (0, "4 -250 0 0 0 1e-8", "expected a count of 1 to 32 .* got the count 4 and 5"),
        (0, "0", "expected a count of 1 to 32"),
        (0, "1e300 1", "expected a count"),
        (1, "2 350 1e999", "inverse polynomial .*: expected a finite number, got '1e999'"),
        (1, "2 350 160", "inverse polynomial: expected radii that agree"),
        (2, "359", r"centre \(row, column\): expected 2 numbers, got 1"),
        (2, "900 639", "centre: expected a point inside"),
        (3, "1 0 0 0", "affine .*: expected 3 numbers, got 4"),
        (3, "0 0 0", "affine: expected c near 1"),
        (4, "720.5 1280", "expected whole numbers from 2 to 16384, got 720.5"),
        (4, "720 99999", "expected whole numbers from 2 to 16384"),
        (4, "720 \x1b[31m", r"expected a finite number, got '\\x1b\[31m'"),
    ],
)
def test_a_bad_line_is_named_with_what_was_expected(index: int, text: str, message: str) -> None:
    line = DATA_LINES[index] + 1
    with pytest.raises(CalibrationError, match=rf"^lens\.txt, line {line}: .*{message}"):
        parse_camera(with_line(index, text), "lens.txt")


def test_missing_and_surplus_lines_are_named() -> None:
    with pytest.raises(CalibrationError, match=r"line 1: expected the direct polynomial"):
        parse_camera("# nothing\n", "lens.txt")
    short = "\n".join(TEXT.split("\n")[: DATA_LINES[2] + 1])
    with pytest.raises(
        CalibrationError, match=rf"after line {DATA_LINES[2] + 1}: expected the affine .* end of"
    ):
        parse_camera(short, "lens.txt")
    with pytest.raises(CalibrationError, match=r"expected nothing after the image size"):
        parse_camera(TEXT + "\n1 2 3\n", "lens.txt")


def test_files_that_are_no_text_too_large_or_missing_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "lens.txt"
    with pytest.raises(CalibrationError, match=r"lens.txt: expected a readable file"):
        load_camera(path)
    path.write_bytes(b"# ok\n\n5 \xff\xfe\n")
    with pytest.raises(CalibrationError, match=r"lens.txt, line 3: expected UTF-8 .* 0xff"):
        load_camera(path)
    path.write_bytes(b"#" * 70_000)
    with pytest.raises(CalibrationError, match=r"expected at most 65536 bytes"):
        load_camera(path)
    with pytest.raises(CalibrationError, match=r"expected a readable file"):
        load_camera(tmp_path)


def error_message(text: str) -> str | None:
    """Return the error message of reading this, None when it gives a camera."""
    try:
        parse_camera(text, "lens.txt")
    except CalibrationError as problem:
        return str(problem)
    return None


@given(st.text(max_size=300))
def test_any_text_gives_a_named_line(text: str) -> None:
    message = error_message(text)
    assert message is not None
    assert message.startswith("lens.txt, ")
    assert message.isprintable()


numbers = st.one_of(
    st.floats(), st.floats(-1e3, 1e3), st.integers(-5, 4000), st.sampled_from([0.0, 1.0])
)


@given(st.lists(st.lists(numbers, min_size=1, max_size=8), min_size=5, max_size=5))
def test_any_five_lines_of_numbers_give_a_camera_or_a_named_line(lines: list) -> None:
    polynomials = [f"{len(line)} " + " ".join(map(str, line)) for line in lines[:2]]
    text = "\n".join(polynomials + [" ".join(map(str, line)) for line in lines[2:]])
    message = error_message(text)
    assert message is None or message.startswith("lens.txt, line ")


@given(
    st.floats(-1e4, -1e-3),
    st.lists(st.floats(-1e30, 1e30), max_size=5),
    st.floats(0.6, 1.9),
    st.integers(2, 4000),
)
def test_wild_polynomials_give_a_camera_or_a_named_line(
    first: float, rest: list[float], affine_c: float, side: int
) -> None:
    direct = [first, *rest]
    text = "\n".join(
        [
            f"{len(direct)} " + " ".join(map(repr, direct)),
            f"2 {-first * 1.5} 100",
            f"{side / 2} {side / 2}",
            f"{affine_c} 0 0",
            f"{side} {side}",
        ]
    )
    message = error_message(text)
    assert message is None or message.startswith("lens.txt, line ")
