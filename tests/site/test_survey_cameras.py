"""A site's own survey cameras, and invalid files."""

import contextlib
import tempfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.model.errors import SiteError
from recon.site.survey_cameras import read_survey_cameras

GOOD = 'name = "mine"\nimage_px = [6000, 4000]\ntimer_s = [2.0, 1.0]\n'


def written(folder: Path, text: str) -> Path:
    (folder / "cameras.toml").write_text(text, encoding="utf-8")
    return folder


def test_a_folder_without_the_file_has_no_cameras_of_its_own(tmp_path: Path) -> None:
    assert read_survey_cameras(tmp_path) == {}


def test_a_camera_is_read(tmp_path: Path) -> None:
    text = f"[[cameras]]\n{GOOD}diagonal_deg = 84.0\nshutter = 'global'\n"
    (model,) = read_survey_cameras(written(tmp_path, text)).values()
    assert (model.key, model.across_px, model.timer_s) == ("mine", 6000, (1.0, 2.0))
    assert model.across_deg > model.along_deg
    assert model.shutter == "global"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("camera = 1", "expected only the keys cameras"),
        (f"[[cameras]]\n{GOOD}", "expected sensor_mm and focal_mm, or diagonal_deg alone"),
        (f"[[cameras]]\n{GOOD}focal_mm = 8.0", "expected sensor_mm and focal_mm, or"),
        (
            f"[[cameras]]\n{GOOD}diagonal_deg = 84.0\nfocal_mm = 8.0",
            "expected sensor_mm and focal_mm, or",
        ),
        (
            f"[[cameras]]\n{GOOD}sensor_mm = [17.3, 13.0]\nfocal_mm = 8.0",
            "expected square pixels, got 2.88 x 3.25 micrometres",
        ),
        (f"[[cameras]]\n{GOOD}diagonal_deg = nan", "expected a finite number, got nan"),
        (f"[[cameras]]\n{GOOD}diagonal_deg = 200.0", "a number of 5 to 150, got 200.0"),
        (f"[[cameras]]\n{GOOD}diagonal_deg = 84.0\n" * 2, "each name once, got 'mine' again"),
        ("[[cameras]]\nname = 'A b'", "expected a name of 1 to 40 lower-case"),
        ("[[cameras]]\nname = 'a'", "image_px is missing"),
    ],
)
def test_a_wrong_file_is_a_sentence_with_its_place(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(SiteError) as problem:
        read_survey_cameras(written(tmp_path, text))
    assert words in str(problem.value)
    assert "cameras.toml" in str(problem.value)


@given(st.text(max_size=200))
def test_any_text_is_cameras_or_a_site_error(text: str) -> None:
    with tempfile.TemporaryDirectory() as folder, contextlib.suppress(SiteError):
        assert read_survey_cameras(written(Path(folder), text)) == {}
