"""`recon calibrate` on photos of a chessboard: the lens, its residuals, and refusals."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from tests.camera.calibration.boards import angle_errors_deg, photo, places, small_camera
from typer.testing import CliRunner, Result

from recon.camera import load_camera
from recon.cli.commands import app
from recon.model.imagery import RgbImage

BOARDS = 12
BOARD = ["--rows", "5", "--cols", "7", "--square-mm", "30"]


def write(path: Path, picture: RgbImage) -> str:
    path.write_bytes(cv2.imencode(path.suffix, picture[..., ::-1])[1].tobytes())
    return str(path)


@pytest.fixture(scope="module")
def photos(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Photos by a known lens; the last one does not show the board."""
    folder, camera = tmp_path_factory.mktemp("photos"), small_camera()
    pictures = [photo(camera, where, n) for n, where in enumerate(places(BOARDS, 3))]
    pictures.append(np.full_like(pictures[0], 90))
    return [write(folder / f"board-{n}.png", picture) for n, picture in enumerate(pictures)]


def calibrate(out: Path, *words: str) -> Result:
    return CliRunner().invoke(app, ["calibrate", *words, "--out", str(out)])


def test_photos_give_the_lens_within_a_twentieth_of_a_degree(
    photos: list[str], tmp_path: Path
) -> None:
    out = tmp_path / "camera-model.txt"
    done = calibrate(out, *photos, *BOARD)
    assert done.exit_code == 0, done.output
    assert angle_errors_deg(small_camera(), load_camera(out)).max() < 0.05
    lines = done.stdout.splitlines()
    assert [line.split()[0] for line in lines[:BOARDS]] == [f"board-{n}.png" for n in range(BOARDS)]
    assert lines[0].endswith("35 of 35")
    assert lines[BOARDS].startswith("overall: rms 0.")
    assert "coverage: " in done.stdout
    assert "of the image circle" in done.stdout
    assert "warning: large residuals" not in done.stdout
    assert "board-12.png: no whole chessboard found, skipped" in done.stderr
    picture = cv2.imread(str(tmp_path / "camera-model.png"))
    assert picture is not None
    assert picture.shape == (1020, 1280, 3)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "camera-model.png",
        "camera-model.txt",
    ]


def refused(done: Result, words: str, folder: Path) -> None:
    """One sentence, exit code 2, and nothing written."""
    assert done.exit_code == 2
    assert done.stdout == ""
    last = done.stderr.splitlines()[-1]
    assert last.startswith("recon calibrate: ")
    assert words in last
    assert not list(folder.glob("camera-model*"))


def test_foreign_and_broken_files_are_named(photos: list[str], tmp_path: Path) -> None:
    out = tmp_path / "camera-model.txt"
    text = tmp_path / "notes.jpg"
    text.write_text("not a photo")
    refused(
        calibrate(out, photos[0], str(text), *BOARD),
        "notes.jpg: expected a JPEG or PNG file, got one that begins with b'not a ",
        tmp_path,
    )
    torn = tmp_path / "torn.png"
    torn.write_bytes(Path(photos[1]).read_bytes()[:5000])
    refused(calibrate(out, photos[0], str(torn), *BOARD), "torn.png: PNG: expected", tmp_path)
    refused(
        calibrate(out, str(tmp_path / "none.jpg"), *BOARD),
        "none.jpg: expected a readable photo, got: No such file",
        tmp_path,
    )


def test_photos_of_different_sizes_are_refused(photos: list[str], tmp_path: Path) -> None:
    picture = cv2.imread(photos[0])
    assert picture is not None
    other = write(tmp_path / "other.jpg", cv2.resize(picture, (320, 180)))
    refused(
        calibrate(tmp_path / "camera-model.txt", photos[0], other, *BOARD),
        "other.jpg: expected 640 x 360 pixels as in",
        tmp_path,
    )


def test_a_board_counted_in_squares_is_refused_with_a_hint(
    photos: list[str], tmp_path: Path
) -> None:
    words = [*photos[:2], "--rows", "6", "--cols", "8", "--square-mm", "30"]
    refused(
        calibrate(tmp_path / "camera-model.txt", *words),
        "expected a chessboard with 6 x 8 inner corners in the photos, got none in 2",
        tmp_path,
    )


def test_too_few_photos_are_refused(photos: list[str], tmp_path: Path) -> None:
    refused(
        calibrate(tmp_path / "camera-model.txt", *photos[:2], *BOARD),
        "expected at least 3 photos with corners that fit one lens, got 2",
        tmp_path,
    )


def test_a_folder_that_does_not_exist_is_named(photos: list[str], tmp_path: Path) -> None:
    refused(
        calibrate(tmp_path / "nowhere" / "camera-model.txt", *photos[:4], *BOARD),
        "nowhere/camera-model.txt: expected to write",
        tmp_path,
    )
