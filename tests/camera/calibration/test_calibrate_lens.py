"""A lens is recovered from the corners of boards at known places, exactly or within the noise."""

from dataclasses import replace

import numpy as np
import pytest
from tests.camera.calibration.boards import (
    BOARD,
    angle_errors_deg,
    board_photos,
    photo,
    place,
    places,
    small_camera,
)

from recon.camera import CalibrationError, ImageCircle, format_camera, parse_camera
from recon.camera.calibration import (
    BoardPhoto,
    Chessboard,
    calibrate_lens,
    coverage_of,
    find_corners,
    residual_picture,
    warnings_of,
)
from recon.camera.calibration.lens_fit import project

PHOTOS = 9


@pytest.mark.parametrize("centre_px", [(322.0, 178.0), (345.0, 165.0)])
def test_true_corners_give_the_true_lens(centre_px: tuple[float, float]) -> None:
    camera = small_camera(centre_px)
    found = calibrate_lens(BOARD, board_photos(camera, PHOTOS), 360, 640)
    assert found.rms_px < 1e-6
    assert angle_errors_deg(camera, found.camera).max() < 1e-6
    assert found.camera.centre_col_px == pytest.approx(centre_px[0], abs=1e-5)
    assert found.camera.centre_row_px == pytest.approx(centre_px[1], abs=1e-5)
    assert found.camera.affine_c == pytest.approx(camera.affine_c, abs=1e-7)
    assert found.camera.direct == pytest.approx(camera.direct, rel=1e-6, abs=1e-12)


def test_the_order_of_corners_may_begin_at_either_end() -> None:
    camera = small_camera()
    photos = board_photos(camera, PHOTOS)
    photos[::2] = [replace(p, corners_px=p.corners_px[::-1]) for p in photos[::2]]
    found = calibrate_lens(BOARD, photos, 360, 640)
    assert angle_errors_deg(camera, found.camera).max() < 1e-6


def test_noise_is_reported_and_its_effect_is_within_the_stated_deviations() -> None:
    camera = small_camera()
    found = calibrate_lens(BOARD, board_photos(camera, 16, noise_px=0.1, seed=3), 360, 640)
    assert found.rms_px == pytest.approx(0.1 * np.sqrt(2.0), rel=0.15)
    assert angle_errors_deg(camera, found.camera).max() < 0.08
    focal_px = -camera.direct[0]
    assert abs(-found.camera.direct[0] / focal_px - 1.0) < 4.0 * found.focal_sigma_share
    assert 0.0002 < found.focal_sigma_share < 0.005
    miss_px = np.hypot(
        found.camera.centre_col_px - camera.centre_col_px,
        found.camera.centre_row_px - camera.centre_row_px,
    )
    assert miss_px < 4.0 * found.centre_sigma_px


def test_wrong_corners_and_a_wrong_photo_are_excluded() -> None:
    camera = small_camera()
    photos = board_photos(camera, 10)
    torn = photos[4].corners_px.copy()
    torn[7] += (4.0, -3.0)
    photos[4] = replace(photos[4], corners_px=torn)
    wrong = np.random.default_rng(1).uniform(100.0, 300.0, torn.shape)
    photos.append(BoardPhoto("foreign.png", wrong))
    found = calibrate_lens(BOARD, photos, 360, 640)
    used = {p.name: int(p.is_used.sum()) for p in found.photos}
    assert used.pop("foreign.png") == 0
    assert used.pop(photos[4].name) == 34
    assert set(used.values()) == {35}
    assert angle_errors_deg(camera, found.camera).max() < 1e-6


def test_the_derivatives_are_those_of_the_projection() -> None:
    lens = np.array([0.6, -0.3, -0.1, -0.05, 320.0, 180.0, 0.01, 0.004])
    points = np.array([[[0.3, -0.2, 0.5], [0.9, 0.4, 0.1], [0.01, 0.02, 1.0]]])
    start = np.array([[0.35, 0.8, 0.02]])
    _, by_lens, by_point = project(lens, points, start, 320.0)
    step = 1e-6
    for index in range(8):
        moved = [
            project(lens + s * np.eye(8)[index], points, start, 320.0)[0] for s in (step, -step)
        ]
        assert by_lens[..., index] == pytest.approx((moved[0] - moved[1]) / (2 * step), abs=1e-4)
    for index in range(3):
        shift = step * np.eye(3)[index]
        moved = [project(lens, points + s * shift, start, 320.0)[0] for s in (1.0, -1.0)]
        assert by_point[..., index] == pytest.approx((moved[0] - moved[1]) / (2 * step), abs=1e-3)


def test_the_file_written_is_read_back_as_the_same_lens() -> None:
    found = calibrate_lens(BOARD, board_photos(small_camera(), PHOTOS), 360, 640)
    assert parse_camera(format_camera(found.camera), "lens.txt") == found.camera
    assert len(found.camera.direct) == 5
    assert found.camera.direct[1] == 0.0


def test_corners_are_found_to_a_fraction_of_a_pixel_in_a_photo() -> None:
    camera = small_camera()
    for number, where in enumerate(
        (place(70.0, 10.0, 180.0, (20.0, -15.0, 30.0)), places(4, 0)[3])
    ):
        corners = find_corners(photo(camera, where, number), BOARD)
        assert corners is not None
        true = camera.project(where.points_mm(BOARD))
        misses = min(
            (np.linalg.norm(corners - pixels, axis=1) for pixels in (true, true[::-1])), key=np.sum
        )
        assert np.sqrt(np.mean(misses**2)) < 0.15


def test_no_board_is_found_where_there_is_none() -> None:
    where = place(0.0, 20.0, 200.0, (0.0, 0.0, 0.0))
    assert find_corners(photo(small_camera(), where, 0), Chessboard(6, 9, 30.0)) is None


@pytest.mark.parametrize("count", [0, 1, 2])
def test_too_few_photos_are_refused(count: int) -> None:
    photos = board_photos(small_camera(), 6)[:count]
    with pytest.raises(CalibrationError, match=f"at least 3 photos .* got {count}; take 10 to 30"):
        calibrate_lens(BOARD, photos, 360, 640)


def test_corners_of_no_lens_are_refused() -> None:
    rng = np.random.default_rng(5)
    photos = [BoardPhoto(str(n), rng.uniform(50.0, 300.0, (35, 2))) for n in range(6)]
    with pytest.raises(CalibrationError):
        calibrate_lens(BOARD, photos, 360, 640)


@pytest.mark.parametrize(
    ("rows", "cols", "square_mm", "message"),
    [
        (2, 7, 30.0, "expected 3 to 50 rows of inner corners, got 2"),
        (5, 51, 30.0, "expected 3 to 50 cols of inner corners, got 51"),
        (5, 7, 0.0, "expected squares of 0.1 to 10000 mm, got 0 mm"),
        (5, 7, float("nan"), "got nan mm"),
    ],
)
def test_an_impossible_board_is_refused(
    rows: int, cols: int, square_mm: float, message: str
) -> None:
    with pytest.raises(CalibrationError, match=message):
        Chessboard(rows, cols, square_mm)


def test_boards_in_the_middle_alone_are_warned_of() -> None:
    camera = small_camera()
    wide = board_photos(camera, 24)
    in_middle = [p for p in wide if np.hypot(*(p.corners_px - (322.0, 178.0)).T).max() < 110.0]
    circle = ImageCircle(camera.centre_col_px, camera.centre_row_px, 170.0)
    narrow = calibrate_lens(BOARD, in_middle, 360, 640)
    sentences = warnings_of(narrow, coverage_of(narrow, circle))
    assert any("few photos" in sentence for sentence in sentences)
    assert any("poor coverage" in sentence for sentence in sentences)
    assert any("the rim is extrapolated" in sentence for sentence in sentences)
    full = calibrate_lens(BOARD, wide, 360, 640)
    coverage = coverage_of(full, circle)
    assert coverage.share > 0.8
    assert 75.0 < coverage.reach_deg <= 87.0
    assert coverage.field_deg == pytest.approx(85.0, abs=3.0)
    assert warnings_of(full, coverage) == []


def test_the_picture_shows_uncovered_cells_and_left_out_corners() -> None:
    camera = small_camera()
    photos = board_photos(camera, PHOTOS)
    photos[0].corners_px[3] += 20.0
    found = calibrate_lens(BOARD, photos, 360, 640)
    circle = ImageCircle(camera.centre_col_px, camera.centre_row_px, 170.0)
    picture = residual_picture(found, coverage_of(found, circle), circle)
    assert picture.shape == (720 + 300, 1280, 3)
    for color in ((255, 226, 214), (222, 240, 222), (200, 30, 30)):
        assert (picture == color).all(axis=2).any()
