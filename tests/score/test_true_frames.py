"""When and from where frames were truly taken, and how far a ground image is off."""

from collections import deque
from dataclasses import replace

import numpy as np
import pytest
from tools.demo_site import demo_camera

from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.imagery import CameraPose, GroundImage
from recon.model.units import NS_PER_S
from recon.score.run_score import registration_quantiles_m
from recon.score.true_frames import TrueFrames, ground_seen, registration_errors_m
from recon.sim.app.camera_feed import CaptureTimes
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import CameraView
from recon.sim.camera.settings import CameraSettings

HEIGHT_M = 120.0
DOWN = np.diag([1.0, -1.0, -1.0])
LEVEL = CameraPose(DOWN, np.array([10.0, 20.0, HEIGHT_M]))


def moved(east_m: float = 0.0, north_m: float = 0.0, up_m: float = 0.0) -> CameraPose:
    return CameraPose(DOWN, LEVEL.position_enu_m + np.array([east_m, north_m, up_m]))


def turned(degrees: float) -> CameraPose:
    """The level camera yawed about the vertical."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    yaw = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return CameraPose(yaw @ DOWN, LEVEL.position_enu_m)


def test_a_camera_that_is_elsewhere_sees_the_ground_elsewhere() -> None:
    points_m = np.array([[0.0, 0.0], [50.0, -30.0]])
    assert ground_seen(moved(3.0, -1.0), LEVEL, points_m) == pytest.approx(
        points_m + np.array([3.0, -1.0])
    )
    # From a tenth higher, the same ray ends a tenth farther from the point below the camera.
    below_m = LEVEL.position_enu_m[:2]
    assert ground_seen(moved(up_m=12.0), LEVEL, points_m) == pytest.approx(
        below_m + 1.1 * (points_m - below_m)
    )


def test_registration_errors_of_a_shift_and_of_a_turn() -> None:
    assert registration_errors_m(moved(3.0, 4.0), LEVEL) == pytest.approx(5.0)
    assert registration_errors_m(LEVEL, LEVEL) == pytest.approx(0.0, abs=1e-9)
    # By one degree of yaw a point is off by its distance times 2 sin(0.5 degrees); the median
    # point of a disk of 195 m lies at 195 / sqrt(2), the 95th percentile at 195 sqrt(0.95).
    chord = 2.0 * np.sin(np.radians(0.5))
    found = registration_quantiles_m([registration_errors_m(LEVEL, turned(1.0))])
    assert found == pytest.approx(
        (195.0 * np.sqrt(0.5) * chord, 195.0 * np.sqrt(0.95) * chord), rel=0.01
    )


def test_errors_of_all_images_count_alike() -> None:
    assert registration_quantiles_m([]) is None
    near, far = np.full(30, 1.0), np.full(10, 9.0)
    median_m, high_m = registration_quantiles_m([near, far]) or (0.0, 0.0)
    assert (median_m, high_m) == (1.0, 9.0)


def test_a_ray_over_the_horizon_sees_no_ground() -> None:
    up = CameraPose(np.eye(3), LEVEL.position_enu_m)
    assert np.isnan(ground_seen(up, LEVEL, np.array([[0.0, 0.0]]))).all()


def capture(taken_s: float, sent_s: float) -> CaptureTimes:
    view = CameraView(taken_s, round(taken_s), LEVEL)
    return CaptureTimes(view, round(taken_s * NS_PER_S), round(sent_s * NS_PER_S))


def test_an_image_is_of_the_newest_frame_sent_when_it_arrived() -> None:
    renderer = FieldRenderer(demo_camera(), imager=CameraSettings(seed=3))
    sent = deque([capture(0.0, 0.4), capture(5.0, 5.6), capture(10.0, 10.3)])
    frames = TrueFrames(sent, renderer, latency_s=0.5)
    grid = GroundGrid(LocalFrame(GeoPoint(45.0, -93.0, 250.0)), 0.0, 4.0, 4.0, 1, 1)
    nothing = np.zeros((1, 1, 3), dtype=np.uint8)
    # Received at 5.6 s; the station assumes a latency of 0.5 s, it was 0.6 s.
    image = GroundImage(grid, 1, round(5.1 * NS_PER_S), nothing, nothing[..., 0] > 0, LEVEL)
    true = frames.of_image(image)
    assert true is not None
    assert true.taken_at_s == 5.0
    expected = renderer.true_pose(CameraView(5.0, 5, LEVEL))
    assert true.pose.position_enu_m == pytest.approx(expected.position_enu_m)
    assert frames.of_image(replace(image, captured_at_ns=-(10**9))) is None
