"""Light by cell against a slow sum over pixels, and the ground that a pixel covers."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.detection.shaded_field import FRAME, HEIGHT_M, LOOKS_DOWN
from tests.examples import examples

from recon.detection import DetectionSettings
from recon.detection.cells import cell_light, field_grid
from recon.detection.frame_step import metres_per_pixel
from recon.model.geo import GroundGrid
from recon.model.imagery import CameraPose, GroundImage

POSE = CameraPose(LOOKS_DOWN, np.array([3.0, -5.0, HEIGHT_M]))
SETTINGS = DetectionSettings()


def projected(seed: int, grid: GroundGrid) -> GroundImage:
    """Random levels, a random third of them not seen."""
    rng = np.random.default_rng(seed)
    rgb = rng.integers(0, 256, (grid.rows, grid.cols, 3), dtype=np.uint8)
    valid = rng.random((grid.rows, grid.cols)) < 0.67
    return GroundImage(grid, 1, 0, rgb * valid[..., np.newaxis], valid, POSE)


@settings(max_examples=examples(40))
@given(
    st.integers(0, 999),
    st.integers(1, 6),
    st.integers(-5, 5),
    st.integers(-5, 5),
    st.integers(1, 8),
    st.integers(1, 8),
)
def test_a_cell_is_the_mean_of_the_pixels_it_holds(
    seed: int, per_cell: int, right: int, down: int, rows: int, cols: int
) -> None:
    image = projected(seed, GroundGrid(FRAME, -10.0, 30.0, 0.5, 24, 32))
    cell_m = 0.5 * per_cell
    field = GroundGrid(FRAME, -10.0 + 0.5 * right, 30.0 - 0.5 * down, cell_m, rows, cols)
    found = cell_light(image, field, SETTINGS)
    light = (np.maximum(image.rgb[..., 1], 0.5) / 255.0) ** SETTINGS.gamma
    for row in range(rows):
        for col in range(cols):
            top, left = down + row * per_cell, right + col * per_cell
            held = np.s_[
                max(top, 0) : max(top + per_cell, 0), max(left, 0) : max(left + per_cell, 0)
            ]
            shown = image.valid[held]
            share = shown.sum() / per_cell**2
            if abs(share - SETTINGS.least_seen) > 1e-3:
                assert found.seen[row, col] == (share > SETTINGS.least_seen)
            if found.seen[row, col]:
                mean = light[held][shown].mean()
                assert found.light[row, col] == pytest.approx(mean, rel=1e-3, abs=1e-5)
            else:
                assert np.isnan(found.light[row, col])


def test_between_pixels_it_is_interpolated() -> None:
    """A ramp of light keeps its slope on a grid that meets no pixel's edge."""
    grid = GroundGrid(FRAME, 0.0, 64.0, 1.0, 64, 64)
    light = np.linspace(0.2, 0.8, 64)
    levels = np.rint(255.0 * light ** (1.0 / SETTINGS.gamma)).astype(np.uint8)
    rgb = np.broadcast_to(levels[np.newaxis, :, np.newaxis], (64, 64, 3)).copy()
    image = GroundImage(grid, 1, 0, rgb, np.ones((64, 64), bool), POSE)
    field = GroundGrid(FRAME, 5.3, 60.1, 3.7, 12, 14)
    found = cell_light(image, field, SETTINGS)
    middles_m = 5.3 + (np.arange(14) + 0.5) * 3.7
    expected = np.interp(middles_m, np.arange(64) + 0.5, light)
    assert np.abs(found.light - expected).max() < 0.006


def test_the_field_is_the_first_frames_grid_in_coarser_cells() -> None:
    laid_on = GroundGrid(FRAME, -100.0, 50.0, 1.0, 101, 199)
    assert field_grid(laid_on, SETTINGS) == GroundGrid(FRAME, -100.0, 50.0, 4.0, 26, 50)
    coarse = GroundGrid(FRAME, -100.0, 50.0, 8.0, 10, 10)
    assert field_grid(coarse, SETTINGS) == coarse
    assert field_grid(laid_on, DetectionSettings(grid=coarse)) == coarse


def test_the_ground_of_a_pixel_by_the_two_rays_at_its_sides() -> None:
    """An equidistant fisheye: a pixel is 1 / f of a radian wide, outwards from the nadir."""
    grid = GroundGrid(FRAME, -200.0, 200.0, 8.0, 50, 50)
    found = metres_per_pixel(grid, POSE, 250.0)
    for row, col in ((0, 0), (10, 40), (25, 25), (49, 3)):
        east_m = grid.west_m + (col + 0.5) * 8.0 - 3.0
        north_m = grid.north_m - (row + 0.5) * 8.0 + 5.0
        angle = np.arctan2(np.hypot(east_m, north_m), HEIGHT_M)
        sides_m = HEIGHT_M * np.tan(angle + np.array([-0.5, 0.5]) / 250.0)
        assert found[row, col] == pytest.approx(np.diff(sides_m)[0], rel=1e-3)
