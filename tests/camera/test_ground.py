"""Frames on the ground: maps, colours, masks, refusals. Truth by construction."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.camera.constructions import FRAME, seen_pixels, solved, tilted_pose
from tests.examples import examples, family
from tools.demo_site import demo_camera

from recon.camera import (
    FrameDecodeError,
    FrameSizeError,
    GroundProjector,
    ImageCircle,
    OmnidirectionalCamera,
    PoseError,
    decode_jpeg,
    ground_maps,
    load_camera,
    load_control_points,
)
from recon.camera.ground import lattice_step, source_mask
from recon.camera.sight import COARSEST_M, farthest_sight_m
from recon.geo import enu_from_geo
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.imagery import CameraPose, Frame, Registration

DEMO = demo_camera()
GRID = GroundGrid(FRAME, -256.0, 256.0, 1.0, 512, 512)
POSE = tilted_pose(8.0, -12.0, 125.0, (3.0, -2.0, 35.0))


def cell_centres(grid: GroundGrid) -> np.ndarray:
    """(R, C, 3) east, north, up of every cell's centre."""
    east = grid.west_m + (np.arange(grid.cols) + 0.5) * grid.cell_m
    north = grid.north_m - (np.arange(grid.rows) + 0.5) * grid.cell_m
    centres = np.zeros((grid.rows, grid.cols, 3))
    centres[..., 0], centres[..., 1] = east, north[:, np.newaxis]
    return centres


def worst_map_error_px(grid: GroundGrid, camera: OmnidirectionalCamera, pose: CameraPose) -> float:
    """Largest distance between the maps and every cell projected separately, where in range."""
    exact = seen_pixels(camera, pose, cell_centres(grid).reshape(-1, 3))
    maps = np.stack([m.ravel() for m in ground_maps(grid, camera, pose)], axis=1)
    is_shown = np.isfinite(exact[:, 0]) & camera.is_in_frame(exact)
    return float(np.hypot(*(maps - exact)[is_shown].T).max(initial=0.0))


@settings(max_examples=examples(60), deadline=None)
@given(
    st.floats(5.0, 500.0),
    st.tuples(st.floats(-25, 25), st.floats(-25, 25), st.floats(-180, 180)),
    st.floats(-100.0, 100.0),
    st.floats(0.2, 4.0),
)
def test_the_maps_miss_by_less_than_a_tenth_of_a_pixel(
    height_m: float, turn_deg: tuple[float, float, float], east_m: float, cell_m: float
) -> None:
    grid = GroundGrid(FRAME, -100.0 * cell_m, 90.0 * cell_m, cell_m, 180, 200)
    pose = tilted_pose(east_m, -east_m / 2.0, height_m, turn_deg)
    assert worst_map_error_px(grid, DEMO, pose) < 0.1


def test_the_real_lens_maps_miss_by_less_than_a_tenth_of_a_pixel(fisheye_data: Path) -> None:
    camera = load_camera(fisheye_data / "camera-model.txt")
    assert lattice_step(GRID, camera, 125.0) >= 3
    assert worst_map_error_px(GRID, camera, POSE) < 0.1


@pytest.mark.parametrize("height_m", [2.0, 30.0, 120.0, 400.0, 3_000.0])
def test_a_higher_camera_gets_a_coarser_lattice(height_m: float) -> None:
    step = lattice_step(GRID, DEMO, height_m)
    assert 1 <= step <= 16
    assert step <= lattice_step(GRID, DEMO, 2.0 * height_m)


def painted_ground(east_m: np.ndarray, north_m: np.ndarray) -> np.ndarray:
    """A smooth pattern that tells every place from its neighbours."""
    return np.stack(
        [
            127.5 + 100.0 * np.sin(east_m / 15.0),
            127.5 + 100.0 * np.sin(north_m / 18.0),
            127.5 + 100.0 * np.sin((east_m + 2.0 * north_m) / 40.0),
        ],
        axis=-1,
    )


def frame_of_painted_ground(camera: OmnidirectionalCamera, pose: CameraPose) -> np.ndarray:
    """What the camera sees of the pattern: every pixel's ray followed to the ground."""
    col, row = np.meshgrid(np.arange(float(camera.cols)), np.arange(float(camera.rows)))
    rays = camera.unproject(np.stack([col.ravel(), row.ravel()], axis=1))
    rays_enu = rays @ pose.rotation_enu_camera.T
    drop = np.where(rays_enu[:, 2] < -0.05, rays_enu[:, 2], np.nan)
    hits = pose.position_enu_m - rays_enu * (pose.position_enu_m[2] / drop)[:, np.newaxis]
    painted = np.nan_to_num(painted_ground(hits[:, 0], hits[:, 1]))
    return np.rint(painted).astype(np.uint8).reshape(camera.rows, camera.cols, 3)


@pytest.mark.parametrize("size", family((540, 960), (720, 1280), (1440, 2560)))
def test_the_ground_gets_its_own_colours_back(size: tuple[int, int]) -> None:
    rows, cols = size
    frame = frame_of_painted_ground(DEMO.scaled_to(rows, cols), POSE)
    projected, valid = GroundProjector(GRID, DEMO).project_pixels(frame, POSE)
    centres = cell_centres(GRID)
    expected = painted_ground(centres[..., 0], centres[..., 1])
    near = np.hypot(centres[..., 0] - 8.0, centres[..., 1] + 12.0) < 200.0
    assert valid[near].all()
    # One pixel sees up to 3 m of ground out there, over which the pattern changes by some levels.
    assert np.abs(projected.astype(float) - expected)[near].mean() < 1.5
    assert np.abs(projected.astype(float) - expected)[near].max() < 20.0


def frame_of(rgb: np.ndarray | None = None, jpeg: bytes | None = None) -> Frame:
    return Frame(41, "IMAGER", 2_000, 1_000, 0.25, rgb=rgb, jpeg=jpeg)


def test_the_ground_image_has_pose_and_time() -> None:
    rgb = np.full((720, 1280, 3), 90, np.uint8)
    image = GroundProjector(GRID, DEMO).project(frame_of(rgb), POSE)
    assert (image.frame_id, image.serial, image.captured_at_ns) == (41, "IMAGER", 1_000)
    assert image.registration is Registration.UNREGISTERED
    assert image.rgb.shape == (512, 512, 3)
    assert image.valid.dtype == np.bool_
    assert image.pose is POSE
    assert image.grid is GRID


def test_a_jpeg_frame_is_projected_like_its_pixels() -> None:
    _, data = cv2.imencode(".jpg", frame_of_painted_ground(DEMO, POSE)[..., ::-1])
    projector = GroundProjector(GRID, DEMO)
    image = projector.project(frame_of(jpeg=data.tobytes()), POSE)
    rgb, _ = projector.project_pixels(decode_jpeg(data.tobytes()), POSE)
    assert np.array_equal(image.rgb, rgb)


def test_cells_outside_the_image_circle_are_invalid_and_black() -> None:
    circle = ImageCircle(DEMO.centre_col_px, DEMO.centre_row_px, 200.0)
    white = np.full((720, 1280, 3), 255, np.uint8)
    projected, valid = GroundProjector(GRID, DEMO, circle).project_pixels(white, POSE)
    pixels = seen_pixels(DEMO, POSE, cell_centres(GRID).reshape(-1, 3))
    radius = np.hypot(*(pixels - (DEMO.centre_col_px, DEMO.centre_row_px)).T).reshape(512, 512)
    assert valid[radius < 198.5].all()
    assert not valid[radius > 201.5].any()
    assert (projected[valid] == 255).all()
    assert (projected[~valid] == 0).all()
    assert 0.1 < valid.mean() < 0.9


@pytest.mark.parametrize("turn_deg", [(80.0, 0.0, 0.0), (0.0, 175.0, 0.0), (0.0, 0.0, 0.0)])
def test_what_the_lens_cannot_see_is_invalid_however_it_is_turned(
    turn_deg: tuple[float, float, float],
) -> None:
    pose = tilted_pose(0.0, 0.0, 60.0, turn_deg)
    wide = GroundGrid(FRAME, -2_000.0, 2_000.0, 20.0, 200, 200)
    white = np.full((720, 1280, 3), 255, np.uint8)
    _, valid = GroundProjector(wide, DEMO).project_pixels(white, pose)
    rays = (cell_centres(wide).reshape(-1, 3) - pose.position_enu_m) @ pose.rotation_enu_camera
    angle_deg = np.rad2deg(np.arctan2(np.hypot(rays[:, 0], rays[:, 1]), rays[:, 2]))
    col, row = DEMO.project_beyond_range(rays).T
    # How far inside the frame and the lens's range, in pixels; half a pixel is rounding.
    edge_px = np.min([col, 1279.0 - col, row, 719.0 - row], axis=0).reshape(200, 200)
    limit_deg = np.rad2deg(DEMO.largest_angle_rad)
    slack_deg = (limit_deg - angle_deg).reshape(200, 200)
    assert not valid[(edge_px < -0.6) | (slack_deg < -0.3)].any()
    most_m = farthest_sight_m(60.0, DEMO.pixels_per_radian, COARSEST_M)
    is_near = (np.linalg.norm(rays, axis=1) <= most_m).reshape(200, 200)
    assert valid[(edge_px > 1.6) & (slack_deg > 0.3) & is_near].all()
    assert not valid[~is_near].any(), "a pixel shows too much ground there"


def test_the_circle_is_searched_until_a_frame_shows_it() -> None:
    col, row = np.meshgrid(np.arange(1280.0), np.arange(720.0))
    is_lit = np.hypot(col - 640.0, row - 360.0) < 250.0
    lit = np.where(is_lit[..., np.newaxis], np.uint8(200), np.uint8(3)).repeat(3, axis=2)
    dark = np.zeros_like(lit)
    projector = GroundProjector(GRID, DEMO)
    unmasked = projector.project_pixels(dark, POSE)[1].mean()
    masked = projector.project_pixels(lit, POSE)[1].mean()
    again = projector.project_pixels(dark, POSE)[1].mean()
    assert masked < unmasked
    assert again == masked


def test_a_ground_image_is_not_changed_by_the_next_one() -> None:
    projector = GroundProjector(GRID, DEMO)
    first_rgb, first_valid = projector.project_pixels(frame_of_painted_ground(DEMO, POSE), POSE)
    kept_rgb, kept_valid = first_rgb.copy(), first_valid.copy()
    other = tilted_pose(60.0, 40.0, 80.0, (0.0, 10.0, -70.0))
    projector.project_pixels(np.full((720, 1280, 3), 77, np.uint8), other)
    assert np.array_equal(first_rgb, kept_rgb)
    assert np.array_equal(first_valid, kept_valid)


def test_the_mask_leaves_out_the_frames_edge() -> None:
    mask = source_mask(DEMO, None)
    assert not mask[[0, -1], :].any()
    assert not mask[:, [0, -1]].any()
    assert mask[360, 640] == 255
    assert mask[360, 5] == 0


def test_a_frame_of_another_aspect_ratio_is_refused() -> None:
    with pytest.raises(FrameSizeError, match="aspect ratio, got 640 x 480"):
        GroundProjector(GRID, DEMO).project(frame_of(np.zeros((480, 640, 3), np.uint8)), POSE)


def test_an_unreadable_frame_is_refused() -> None:
    with pytest.raises(FrameDecodeError, match="JPEG: expected a file"):
        GroundProjector(GRID, DEMO).project(frame_of(jpeg=b"no picture"), POSE)


@pytest.mark.parametrize("up_m", [0.5, 0.0, -40.0, float("nan"), float("inf")])
def test_a_camera_on_the_ground_gives_no_ground_image(up_m: float) -> None:
    pose = replace(POSE, position_enu_m=np.array([0.0, 0.0, up_m]))
    with pytest.raises(PoseError, match="above the ground plane"):
        ground_maps(GRID, DEMO, pose)


def test_a_real_frames_control_points_project_onto_their_marks(fisheye_data: Path) -> None:
    """A dot painted at a marked pixel appears at the control point's place, off by its residual."""
    camera = load_camera(fisheye_data / "camera-model.txt")
    points = load_control_points(fisheye_data / "elgin-5" / "GCPs.txt")
    first = points[0]
    frame = LocalFrame(GeoPoint(first.latitude_deg, first.longitude_deg, first.ellipsoid_height_m))
    solution = solved(camera, points, (3840, 2160), frame)
    grid = GroundGrid(frame, -400.0, 300.0, 0.5, 1200, 1400)
    for point, residual in zip(points, solution.residuals, strict=True):
        rgb = np.zeros((2160, 3840, 3), np.uint8)
        # OpenCV draws at sixteenths of a pixel with shift=4.
        middle = (round(point.col_px * 16), round(point.row_px * 16))
        cv2.circle(rgb, middle, 3 * 16, (255, 255, 255), -1, cv2.LINE_AA, shift=4)
        everywhere = ImageCircle(camera.centre_col_px, camera.centre_row_px, 360.0)
        projected, _ = GroundProjector(grid, camera, everywhere).project_pixels(rgb, solution.pose)
        row, col = np.argwhere(projected[..., 0] > 127).mean(axis=0)
        east_m = grid.west_m + (col + 0.5) * grid.cell_m
        north_m = grid.north_m - (row + 0.5) * grid.cell_m
        place = enu_from_geo(
            frame, point.latitude_deg, point.longitude_deg, point.ellipsoid_height_m
        )[0]
        assert east_m - place[0] == pytest.approx(residual.east_m, abs=0.3)
        assert north_m - place[1] == pytest.approx(residual.north_m, abs=0.3)
