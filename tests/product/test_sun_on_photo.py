"""The sun at a time and on a photo, against bands of shade that move by construction."""

import cv2
import numpy as np
import pytest
from tests.product.made_flight import (
    DRIFT_MPS,
    GRID,
    HEIGHT_M,
    ONE,
    START_NS,
    flight,
    sun,
    times_s,
)

from recon.model.units import NS_PER_S
from recon.product.footprint import Aim, PhotoView, projected, sun_on_photo
from recon.product.sun_at import SunHistory
from recon.product.write import mask_jpeg, upright

COLS, ROWS = 80, 60


@pytest.fixture(scope="module")
def history() -> SunHistory:
    made = flight()
    return SunHistory(GRID, made.maps)


def test_a_camera_straight_down_shows_what_its_field_covers() -> None:
    aim = Aim(10.0, 20.0, 50.0, 0.0)
    half_m = 50.0 * np.tan(np.deg2rad(33.0))
    corners = PhotoView(aim, 66.0, 400, 300).corners_m
    west, north = 10.0 - half_m, 20.0 + 0.75 * half_m
    assert corners[0] == pytest.approx([west, north], abs=1e-9)
    assert corners[2] == pytest.approx([20.0 - west, 40.0 - north], abs=1e-9)
    turned = PhotoView(Aim(10.0, 20.0, 50.0, 90.0), 66.0, 400, 300).corners_m
    assert turned[0] == pytest.approx([10.0 + 0.75 * half_m, 20.0 + half_m], abs=1e-9)


def test_a_tilted_camera_looks_ahead() -> None:
    aim = Aim(0.0, 0.0, 100.0, 90.0, -60.0)
    middle = np.array([[199.5, 149.5]])
    (point,) = projected(PhotoView(aim, 66.0, 400, 300).homography, middle)
    assert point == pytest.approx([100.0 / np.tan(np.deg2rad(60.0)), 0.0], abs=1e-9)


def test_the_shadows_velocity_is_found(history: SunHistory) -> None:
    east_mps, north_mps = history.velocity_mps(START_NS + 120 * NS_PER_S)
    # Bands along a slant: only the motion across them can be seen.
    across = (east_mps + 0.4 * north_mps) / np.hypot(1.0, 0.4)
    assert across == pytest.approx(DRIFT_MPS / np.hypot(1.0, 0.4), abs=0.8)


@pytest.mark.parametrize("middle_m", [(10.0, 20.0), (-145.0, 140.0), (400.0, 0.0)])
def test_the_sun_around_a_photo_is_a_part_of_all_of_it(
    history: SunHistory, middle_m: tuple[float, float]
) -> None:
    view = PhotoView(Aim(*middle_m, 50.0, 33.0), 66.0, COLS, ROWS)
    at_ns = START_NS + 61 * NS_PER_S
    part = sun_on_photo(*history.around(at_ns, view.corners_m), view)
    whole = sun_on_photo(history.at(at_ns), GRID, view)
    assert part.transmittance == pytest.approx(whole.transmittance, abs=1e-5)
    assert part.confidence == pytest.approx(whole.confidence, abs=1e-5)


def test_a_camera_that_shows_sky_is_known() -> None:
    assert PhotoView(Aim(0.0, 0.0, 50.0, 0.0, -20.0), 66.0, 400, 300).shows_sky
    assert not PhotoView(Aim(0.0, 0.0, 50.0, 0.0, -60.0), 66.0, 400, 300).shows_sky


def only_nearest(history: SunHistory, at_ns: int) -> SunHistory:
    nearest = min(history.maps, key=lambda each: abs(each.at_ns - at_ns))
    return SunHistory(history.grid, [nearest])


def errors(history: SunHistory, nearest: bool) -> tuple[float, float]:
    """Mean error of the sunlit share, and the share of wrong pixels."""
    share, wrong = [], []
    for at_s in times_s(ONE)[::4].tolist():
        east, north, yaw = (float(v) for v in ONE.place(at_s))
        view = PhotoView(Aim(east, north, HEIGHT_M, yaw), 66.0, COLS, ROWS)
        at_ns = START_NS + round(at_s * NS_PER_S)
        used = only_nearest(history, at_ns) if nearest else history
        found = sun_on_photo(used.at(at_ns), GRID, view)
        pixels = np.stack(np.meshgrid(np.arange(COLS), np.arange(ROWS)), axis=-1).reshape(-1, 2)
        ground = projected(view.homography, pixels.astype(float))
        true = sun(ground[:, 0], ground[:, 1], at_s).reshape(ROWS, COLS) >= 0.5
        known = found.confidence > 0.0
        lit = found.transmittance >= 0.5
        share.append(abs(lit[known].mean() - true[known].mean()))
        wrong.append((lit != true)[known].mean())
    return float(np.mean(share)), float(np.mean(wrong))


def test_moved_maps_tell_the_sunlit_share_of_photos_between_them(history: SunHistory) -> None:
    share, wrong = errors(history, nearest=False)
    by_nearest, wrong_by_nearest = errors(history, nearest=True)
    assert share < 0.02
    assert share < by_nearest
    assert wrong < 0.5 * wrong_by_nearest


def test_far_from_any_map_nothing_is_known(history: SunHistory) -> None:
    nothing = history.at(START_NS - 120 * NS_PER_S)
    assert not nothing.confidence.any()
    sure = history.at(START_NS + 100 * NS_PER_S).confidence.max()
    assert sure > history.at(history.maps[-1].at_ns + 20 * NS_PER_S).confidence.max() > 0.0


@pytest.mark.parametrize("orientation", range(1, 9))
def test_masks_stand_upright_as_opencv_turns_photos(orientation: int, tmp_path) -> None:
    from PIL import ExifTags, Image

    random = np.random.default_rng(orientation)
    pixels = (random.random((4, 6)) > 0.5).repeat(16, 0).repeat(16, 1).astype(np.uint8) * 255
    exif = Image.Exif()
    exif[ExifTags.Base.Orientation] = orientation
    path = tmp_path / "a.png"
    Image.fromarray(pixels).save(tmp_path / "a.jpg", quality=100, exif=exif)
    by_opencv = cv2.imread(str(tmp_path / "a.jpg"), cv2.IMREAD_GRAYSCALE)
    assert (upright(pixels, orientation) == (by_opencv > 127) * 255).all()
    path.with_suffix(".mask").write_bytes(mask_jpeg(pixels, orientation))
    mask = cv2.imread(str(path.with_suffix(".mask")), cv2.IMREAD_GRAYSCALE)
    assert ((mask > 0) == (by_opencv > 127)).all()
