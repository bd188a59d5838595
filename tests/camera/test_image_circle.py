"""The lit circle of a fisheye frame."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from recon.camera import (
    ImageCircle,
    OmnidirectionalCamera,
    decode_jpeg,
    find_image_circle,
    load_camera,
)

COL, ROW = np.meshgrid(np.arange(1280.0), np.arange(720.0))


def fisheye_frame(col: float, row: float, radius: float, seed: int = 1) -> np.ndarray:
    """Scenery with dark patches inside a circle, stray light outside."""
    rng = np.random.default_rng(seed)
    scenery = cv2.resize(
        rng.integers(0, 256, (18, 32, 3), dtype=np.uint8), (1280, 720), interpolation=0
    )
    is_inside = np.hypot(COL - col, ROW - row) <= radius
    stray = rng.integers(0, 14, (720, 1280, 3), dtype=np.uint8)
    return np.where(is_inside[..., np.newaxis], scenery, stray)


@pytest.mark.parametrize(
    ("col", "row", "radius"), [(640.0, 360.0, 300.0), (655.5, 352.3, 270.0), (640.0, 360.0, 150.0)]
)
def test_the_circle_is_found_and_drawn_in_by_its_rim(
    camera: OmnidirectionalCamera, col: float, row: float, radius: float
) -> None:
    circle = find_image_circle(fisheye_frame(col, row, radius), camera)
    assert circle is not None
    assert (circle.centre_col_px, circle.centre_row_px) == pytest.approx((col, row), abs=3.0)
    assert circle.radius_px == pytest.approx(0.98 * radius, abs=4.0)


def test_a_circle_cut_by_the_frame_is_found(camera: OmnidirectionalCamera) -> None:
    circle = find_image_circle(fisheye_frame(640.0, 360.0, 420.0), camera)
    assert circle is not None
    assert circle.radius_px == pytest.approx(0.98 * 420.0, abs=8.0)


def test_no_circle_is_found_where_there_is_none(camera: OmnidirectionalCamera) -> None:
    assert find_image_circle(fisheye_frame(640.0, 360.0, 2_000.0), camera) is None
    assert find_image_circle(np.zeros((720, 1280, 3), np.uint8), camera) is None
    rectangle = np.zeros((720, 1280, 3), np.uint8)
    rectangle[200:500, 300:1000] = 200
    assert find_image_circle(rectangle, camera) is None


def test_scaling_moves_the_centre_by_pixel_centres() -> None:
    assert ImageCircle(639.5, 359.5, 300.0).scaled(0.5) == ImageCircle(319.5, 179.5, 150.0)


@pytest.mark.parametrize("site", ["becker-1", "elgin-5", "grand-meadow-7"])
def test_the_real_lens_shows_the_same_circle_in_every_frame(fisheye_data: Path, site: str) -> None:
    camera = load_camera(fisheye_data / "camera-model.txt").scaled_to(2160, 3840)
    frame = decode_jpeg((fisheye_data / site / "RefFrame.jpeg").read_bytes())
    circle = find_image_circle(frame, camera)
    assert circle is not None
    assert circle.radius_px / 3.0 == pytest.approx(277.5, abs=3.0)
    assert (circle.centre_col_px / 3, circle.centre_row_px / 3) == pytest.approx((643, 361), abs=4)
