"""Poses from control points: known poses, honest sigmas, real frames, refusals."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from tests.camera.constructions import (
    FRAME,
    SIZE_PX,
    control_points,
    field_points,
    solved,
    tilted_pose,
)
from tests.examples import examples
from tools.demo_site import demo_camera

from recon.camera import (
    FrameSizeError,
    OmnidirectionalCamera,
    PoseError,
    load_camera,
    load_control_points,
)
from recon.camera.pose import PoseSolution
from recon.model.geo import GeoPoint, LocalFrame

DEMO = demo_camera()
TRUE_POSE = tilted_pose(12.0, -20.0, 118.0, (2.5, -3.0, 140.0))


def turn_between_rad(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return Rotation.from_matrix(first @ second.T).as_rotvec()


@settings(max_examples=examples(40), deadline=None)
@given(
    st.integers(0, 10_000),
    st.integers(4, 9),
    st.floats(40.0, 300.0),
    st.tuples(st.floats(-12, 12), st.floats(-12, 12), st.floats(-180, 180)),
)
def test_perfect_marks_give_the_pose_they_were_made_with(
    seed: int, count: int, height_m: float, turn_deg: tuple[float, float, float]
) -> None:
    pose = tilted_pose(10.0, 5.0, height_m, turn_deg)
    corners = np.array([[-90.0, -80.0, 0.0], [100.0, -70.0, 0.0], [80.0, 95.0, 0.0]])
    points = np.vstack([corners, field_points(count - 3, seed, relief_m=3.0) / 2.0])
    corner_marks = control_points(DEMO, pose, points)
    solution = solved(DEMO, corner_marks, SIZE_PX, FRAME)
    assert solution.rms_px < 1e-4
    assert np.abs(solution.pose.position_enu_m - pose.position_enu_m).max() < 0.01
    turned = turn_between_rad(solution.pose.rotation_enu_camera, pose.rotation_enu_camera)
    assert np.abs(turned).max() < 1e-4


def test_marks_at_another_size_are_brought_to_the_models_by_pixel_centres() -> None:
    at_model = control_points(DEMO, TRUE_POSE, field_points(6, 3))
    at_full = [
        replace(p, col_px=(p.col_px + 0.5) * 3 - 0.5, row_px=(p.row_px + 0.5) * 3 - 0.5)
        for p in at_model
    ]
    solution = solved(DEMO, at_full, (3840, 2160), FRAME)
    assert solution.rms_px < 1e-4
    assert solution.height_above_ground_m == pytest.approx(118.0, abs=0.01)


def noisy_solution(seed: int) -> PoseSolution:
    points = control_points(DEMO, TRUE_POSE, field_points(8, 11), noise_px=1.0, seed=seed)
    return solved(DEMO, points, SIZE_PX, FRAME)


@pytest.mark.flight
def test_the_standard_deviations_are_those_of_the_errors() -> None:
    """Over many markings of the same points the errors agree with the covariance."""
    solutions = [noisy_solution(seed) for seed in range(150)]
    errors = np.array(
        [
            np.concatenate(
                [
                    turn_between_rad(s.pose.rotation_enu_camera, TRUE_POSE.rotation_enu_camera),
                    s.pose.position_enu_m - TRUE_POSE.position_enu_m,
                ]
            )
            for s in solutions
        ]
    )
    variance = np.mean([np.diag(s.pose.covariance) for s in solutions], axis=0)
    # 150 samples of a variance scatter by 12 %; bounds at four times that.
    assert np.all(np.abs(errors.var(axis=0) / variance - 1.0) < 0.48)
    true_tilt_deg = np.rad2deg(np.arccos(-TRUE_POSE.rotation_enu_camera[2, 2]))
    tilt_errors = np.array([s.tilt_deg - true_tilt_deg for s in solutions])
    tilt_variance = np.mean([s.tilt_sigma_deg**2 for s in solutions])
    assert abs(tilt_errors.var() / tilt_variance - 1.0) < 0.48
    height_variance = np.mean([s.height_sigma_m**2 for s in solutions])
    heights = np.array([s.height_above_ground_m for s in solutions])
    assert abs(heights.var() / height_variance - 1.0) < 0.48


@pytest.mark.flight
def test_the_rms_is_the_root_of_the_mean_squared_two_dimensional_error() -> None:
    solution = noisy_solution(1)
    squared = [r.col_px**2 + r.row_px**2 for r in solution.residuals]
    assert solution.rms_px == pytest.approx(np.sqrt(np.mean(squared)))
    expected_px = np.sqrt(2.0 * (1.0 - 6.0 / 16.0))
    rms = [noisy_solution(seed).rms_px for seed in range(60)]
    assert np.mean(rms) == pytest.approx(expected_px, rel=0.1)


def test_ground_residuals_point_to_a_moved_mark() -> None:
    points = control_points(DEMO, TRUE_POSE, field_points(60, 12))
    # One mark in sixty moved to where a place 5 m further east is seen: the fit barely follows.
    enu = field_points(60, 12)[7:8]
    moved = control_points(DEMO, TRUE_POSE, enu + np.array([5.0, 0.0, 0.0]))[0]
    points[7] = replace(points[7], col_px=moved.col_px, row_px=moved.row_px)
    residual = solved(DEMO, points, SIZE_PX, FRAME).residuals[7]
    assert residual.east_m == pytest.approx(5.0, abs=1.0)
    assert residual.north_m == pytest.approx(0.0, abs=0.7)
    assert residual.ground_m == pytest.approx(np.hypot(residual.east_m, residual.north_m))


@pytest.mark.parametrize(
    ("site", "rms_px", "height_m"),
    [("becker-1", 3.62, 133.0), ("elgin-5", 1.27, 124.0), ("grand-meadow-7", 1.97, 139.0)],
)
def test_the_real_frames_are_fitted_as_well_as_they_can_be(
    fisheye_data: Path, site: str, rms_px: float, height_m: float
) -> None:
    camera = load_camera(fisheye_data / "camera-model.txt")
    points = load_control_points(fisheye_data / site / "GCPs.txt")
    frame = LocalFrame(
        GeoPoint(points[0].latitude_deg, points[0].longitude_deg, points[0].ellipsoid_height_m)
    )
    solution = solved(camera, points, (3840, 2160), frame)
    assert solution.rms_px == pytest.approx(rms_px, abs=0.02)
    assert solution.height_above_ground_m == pytest.approx(height_m, abs=1.0)
    assert solution.tilt_deg < 5.0
    assert 0.0 < solution.height_sigma_m < 5.0


def refusal(points: list, camera: OmnidirectionalCamera = DEMO) -> str:
    with pytest.raises(PoseError) as caught:
        solved(camera, points, SIZE_PX, FRAME)
    return str(caught.value)


@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_fewer_than_four_points_are_refused_with_the_reason(count: int) -> None:
    points = control_points(DEMO, TRUE_POSE, field_points(max(count, 1), 5))[:count]
    assert f"at least 4 control points, got {count}: three allow up to four" in refusal(points)


def test_points_on_one_line_are_refused() -> None:
    along = np.linspace(-100.0, 100.0, 6)
    enu = np.column_stack([along, 0.5 * along, np.zeros(6)])
    assert "points on one line" in refusal(control_points(DEMO, TRUE_POSE, enu))


def test_four_points_at_three_places_are_refused() -> None:
    enu = field_points(3, 9)[[0, 1, 2, 2]]
    assert "got 4 at 3" in refusal(control_points(DEMO, TRUE_POSE, enu))


def test_points_at_one_place_are_refused() -> None:
    enu = np.zeros((5, 3))
    assert "one place" in refusal(control_points(DEMO, TRUE_POSE, enu))


def test_mixed_up_points_are_refused_and_the_worst_is_named() -> None:
    points = control_points(DEMO, TRUE_POSE, field_points(7, 4))
    first, second = points[0], points[3]
    points[0] = replace(first, col_px=second.col_px, row_px=second.row_px)
    points[3] = replace(second, col_px=first.col_px, row_px=first.row_px)
    assert "worst: P" in refusal(points)


def test_a_mirrored_image_is_refused() -> None:
    points = control_points(DEMO, TRUE_POSE, field_points(7, 4))
    assert "expected control points that fit" in refusal(
        [replace(p, col_px=1279.0 - p.col_px) for p in points]
    )


def test_pixels_outside_the_frame_or_the_lens_are_named() -> None:
    points = control_points(DEMO, TRUE_POSE, field_points(5, 6))
    outside = [*points[:4], replace(points[4], row_px=900.0)]
    assert "control point P4: expected a pixel inside the marked frame of 1280 x 720" in refusal(
        outside
    )
    unseen = [*points[:4], replace(points[4], row_px=3.0, col_px=3.0)]
    assert "control point P4: expected a pixel inside the lens's field of view" in refusal(unseen)


def test_a_marked_frame_of_another_aspect_ratio_is_refused() -> None:
    points = control_points(DEMO, TRUE_POSE, field_points(5, 6))
    with pytest.raises(FrameSizeError, match="aspect ratio"):
        solved(DEMO, points, (4000, 3000), FRAME)


def test_many_points_are_solved_from_a_selection_of_triples() -> None:
    solution = solved(
        DEMO, control_points(DEMO, TRUE_POSE, field_points(120, 2), 0.5), SIZE_PX, FRAME
    )
    assert solution.height_above_ground_m == pytest.approx(118.0, abs=0.5)
