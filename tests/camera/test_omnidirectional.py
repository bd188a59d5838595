"""The lens model: axes, inverse, range, scaling, and what is refused."""

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tools.demo_site import demo_camera

from recon.camera import CalibrationError, FrameSizeError, OmnidirectionalCamera, load_camera

DEMO = demo_camera()


def rays_within(angle_deg: float, count: int, seed: int) -> np.ndarray:
    """Unit rays, evenly over the cap of this angle about the axis."""
    rng = np.random.default_rng(seed)
    forward = rng.uniform(math.cos(math.radians(angle_deg)), 1.0, count)
    turn = rng.uniform(0.0, 2.0 * math.pi, count)
    across = np.sqrt(1.0 - forward**2)
    return np.stack([across * np.cos(turn), across * np.sin(turn), forward], axis=1)


def ray_in_the_files_convention(camera: OmnidirectionalCamera, col: float, row: float) -> list:
    """cam2world as the toolbox's document has it, one pixel at a time, in the file's own axes."""
    determinant = camera.affine_c - camera.affine_d * camera.affine_e
    along_row = row - camera.centre_row_px
    along_col = col - camera.centre_col_px
    first = (along_row - camera.affine_d * along_col) / determinant
    second = (-camera.affine_e * along_row + camera.affine_c * along_col) / determinant
    radius = math.sqrt(first * first + second * second)
    third = sum(a * radius**power for power, a in enumerate(camera.direct))
    length = math.sqrt(first * first + second * second + third * third)
    return [first / length, second / length, third / length]


def worst_round_trip_px(camera: OmnidirectionalCamera) -> float:
    pixels = camera.project(rays_within(85.0, 20_000, seed=5))
    assert np.isfinite(pixels).all()
    return float(np.abs(camera.project(camera.unproject(pixels)) - pixels).max())


def test_round_trip_of_the_synthetic_lens_is_exact_within_85_degrees() -> None:
    assert worst_round_trip_px(DEMO) < 1e-6
    rays = rays_within(85.0, 20_000, seed=6)
    assert np.abs(DEMO.unproject(DEMO.project(rays)) - rays).max() < 1e-9


def test_round_trip_of_the_real_lens_is_exact_within_85_degrees(fisheye_data: Path) -> None:
    assert worst_round_trip_px(load_camera(fisheye_data / "camera-model.txt")) < 1e-6


def test_the_real_files_inverse_polynomial_agrees_to_a_hundredth_of_a_pixel(
    fisheye_data: Path,
) -> None:
    camera = load_camera(fisheye_data / "camera-model.txt")
    angles = np.deg2rad(np.linspace(0.0, 85.0, 200))
    by_inverse = np.polynomial.polynomial.polyval(angles - np.pi / 2.0, camera.inverse)
    assert np.abs(by_inverse - camera.profile.radius_px(angles)).max() < 0.01


def test_the_fast_table_agrees_to_a_hundredth_of_a_pixel() -> None:
    rays = rays_within(95.0, 20_000, seed=7)
    exact = DEMO.project_beyond_range(rays)
    assert np.abs(DEMO.project_beyond_range(rays, fast=True) - exact).max() < 0.01


@given(st.floats(0.0, 340.0), st.floats(0.0, 2.0 * math.pi))
def test_rays_are_those_of_the_toolbox_with_its_axes_renamed(radius: float, turn: float) -> None:
    col = DEMO.centre_col_px + radius * math.cos(turn)
    row = DEMO.centre_row_px + radius * math.sin(turn)
    down, right, backward = ray_in_the_files_convention(DEMO, col, row)
    assert DEMO.unproject([[col, row]])[0] == pytest.approx([right, down, -backward], abs=1e-12)


def test_the_axes_are_right_down_and_forward() -> None:
    centre = [DEMO.centre_col_px, DEMO.centre_row_px]
    assert DEMO.project([[0.0, 0.0, 1.0]])[0] == pytest.approx(centre)
    right, down = DEMO.project([[0.1, 0.0, 1.0], [0.0, 0.1, 1.0]])
    assert right[0] > centre[0] + 20.0
    assert right[1] == pytest.approx(centre[1], abs=0.1)
    assert down[1] > centre[1] + 20.0
    assert down[0] == pytest.approx(centre[0], abs=0.1)


def test_what_the_lens_cannot_see_is_nan() -> None:
    limit = DEMO.largest_angle_rad
    rays = [
        [0.0, 0.0, -1.0],
        [0.0, 0.0, 0.0],
        [math.nan, 0.0, 1.0],
        [math.inf, 0.0, 1.0],
        [math.sin(limit + 0.01), 0.0, math.cos(limit + 0.01)],
        [5e-324, 0.0, -1.0],
    ]
    assert np.isnan(DEMO.project(rays)).all()
    assert np.isnan(DEMO.unproject([[-300.0, 360.0], [math.nan, 1.0], [1e308, 1e308]])).all()
    assert np.isfinite(DEMO.project([[1e300, 0.0, 1e300], [1e-300, 0.0, 1e-300]])).all()


def test_a_polynomial_that_folds_back_is_used_only_well_before_the_fold() -> None:
    # depth = 250 - 0.004 r^2 + 1.0e-5 r^3 turns back near r = 300: there the angle stops growing.
    direct = (-250.0, 0.0, 0.004, -1.0e-5)
    radii = np.linspace(0.0, 400.0, 40_001)
    angles = np.arctan2(radii, 250.0 - 0.004 * radii**2 + 1e-5 * radii**3)
    slopes = np.gradient(angles, radii)
    end = int(np.argmax(slopes < 0.2 * slopes[0]))
    below = angles[:end] - np.pi / 2
    inverse = np.polynomial.Polynomial.fit(below, radii[:end], 14).convert().coef
    camera = dataclasses.replace(DEMO, direct=direct, inverse=tuple(inverse.tolist()))
    assert camera.profile.largest_radius_px == pytest.approx(radii[end], abs=0.5)
    assert worst_radius_step(camera) > 0.0
    inside = rays_within(math.degrees(camera.largest_angle_rad), 5_000, seed=9)
    assert np.abs(camera.unproject(camera.project(inside)) - inside).max() < 1e-6


def worst_radius_step(camera: OmnidirectionalCamera) -> float:
    angles = np.linspace(0.0, camera.largest_angle_rad * 1.2, 5_000)
    return float(np.diff(camera.profile.radius_px(angles)).min())


def test_radius_grows_with_the_angle_also_beyond_the_range() -> None:
    assert worst_radius_step(DEMO) > 0.0


def test_in_frame_is_the_frames_area() -> None:
    corners = np.array([[-0.5, -0.5], [1279.5, 719.5], [-0.51, 0.0], [0.0, 719.6], [np.nan, 0.0]])
    assert DEMO.is_in_frame(corners).tolist() == [True, True, False, False, False]


@pytest.mark.parametrize(("rows", "cols"), [(2160, 3840), (360, 640), (90, 160), (720, 1280)])
def test_scaling_moves_pixels_by_their_centres(rows: int, cols: int) -> None:
    scaled = DEMO.scaled_to(rows, cols)
    rays = rays_within(80.0, 500, seed=8)
    expected = (DEMO.project(rays) + 0.5) * (cols / 1280) - 0.5
    assert np.abs(scaled.project(rays) - expected).max() < 1e-6
    assert (scaled.rows, scaled.cols) == (rows, cols)


@pytest.mark.parametrize(("rows", "cols"), [(480, 640), (719, 1280), (0, 0), (-720, -1280)])
def test_another_aspect_ratio_is_refused(rows: int, cols: int) -> None:
    with pytest.raises(FrameSizeError, match=rf"expected a frame of 1280 x 720.*{cols} x {rows}"):
        DEMO.scaled_to(rows, cols)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"direct": (250.0, 0.0)}, "direct polynomial: expected .* a negative first"),
        ({"direct": ()}, "direct polynomial"),
        ({"direct": (-250.0, 0.0, math.nan)}, "finite"),
        ({"direct": (-0.01, 0.0, 0.01)}, "direct polynomial: expected rays that lean further out"),
        ({"direct": (-300.0,)}, "inverse polynomial: expected radii that agree"),
        ({"inverse": DEMO.inverse[::-1]}, "inverse polynomial: expected radii that agree"),
        ({"inverse": (1e308, 1e308, 1e308)}, "inverse polynomial"),
        ({"centre_row_px": 800.0}, "centre: expected a point inside 1280 x 720"),
        ({"affine_c": -1.0}, "affine: expected c near 1"),
        ({"affine_e": 0.9}, "affine: expected c near 1"),
        ({"rows": 1, "centre_row_px": 0.0}, "image size: expected at least 2 x 2"),
    ],
)
def test_numbers_that_make_no_camera_are_refused(change: dict, message: str) -> None:
    with pytest.raises(CalibrationError, match=message):
        dataclasses.replace(DEMO, **change)
