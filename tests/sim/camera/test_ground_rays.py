"""Rays meet the ground where the station's camera model projects them."""

import numpy as np
import pytest

from recon.model.imagery import CameraPose
from recon.sim.camera import HoverSettings, LensSettings
from recon.sim.camera.lens import RELIEF_TANGENT, Lens, ground_rays
from recon.sim.camera.rig import true_pose
from recon.sim.world.relief import Relief, ReliefSettings

PIXELS = np.stack(np.meshgrid(np.arange(330, 950, 37), np.arange(60, 660, 41)), axis=-1)
LEANING = HoverSettings(mount_error_deg=4.0)


@pytest.fixture(scope="module")
def lens(camera, circle):
    return Lens(camera, circle, LensSettings())


@pytest.mark.parametrize("height_m", [60.0, 400.0])
@pytest.mark.parametrize("seed", range(4))
def test_a_pixels_ground_point_is_the_camera_models(lens, pose, height_m: float, seed: int) -> None:
    there = true_pose(pose(height_m, 30.0, -50.0, 25.0), LEANING, seed, 12.0)
    seen = ground_rays(lens, there, None)
    rays = lens.camera.unproject(PIXELS.reshape(-1, 2)) @ there.rotation_enu_camera.T
    tangent = np.hypot(rays[:, 0], rays[:, 1]) / np.maximum(-rays[:, 2], 1e-9)
    counts = np.isfinite(tangent) & (rays[:, 2] < 0.0) & (tangent < 4.0)
    assert counts.sum() > 100
    share = there.position_enu_m[2] / -rays[counts, 2]
    expected = there.position_enu_m[:2] + rays[counts, :2] * share[:, np.newaxis]
    rows, cols = lens.window
    at = PIXELS.reshape(-1, 2)[counts] - (cols.start, rows.start)
    found = np.stack(
        [lens.full(plane)[at[:, 1], at[:, 0]] for plane in (seen.east_m, seen.north_m)], axis=1
    )
    miss_px = np.linalg.norm(found - expected, axis=1)
    miss_px /= height_m * (1.0 + tangent[counts] ** 2) * lens.radians_per_px
    assert miss_px.max() < 0.2


def test_above_the_horizon_there_is_no_ground(lens, pose) -> None:
    level = pose(100.0)
    upside_down = CameraPose(-level.rotation_enu_camera, level.position_enu_m)
    seen = ground_rays(lens, upside_down, None)
    assert seen.sees_ground.mean() < 0.1
    assert np.isinf(seen.distance_m).mean() > 0.9


def test_a_camera_on_the_ground_looks_from_just_above_it(lens, pose) -> None:
    seen = ground_rays(lens, pose(-3.0), None)
    assert seen.footprint_m.min() > 0.0


def test_rays_meet_rolling_ground_at_its_height(lens, pose) -> None:
    relief = Relief(ReliefSettings(3, height_m=6.0))
    there = pose(150.0, 80.0, -40.0)
    seen = ground_rays(lens, there, relief)
    tangent = np.hypot(seen.directions[..., 0], seen.directions[..., 1]) / np.maximum(
        -seen.directions[..., 2], 1e-9
    )
    near = tangent < 0.5 * RELIEF_TANGENT
    ground_m = relief.height_m(seen.east_m, seen.north_m)
    from_camera = np.hypot(
        seen.east_m - there.position_enu_m[0], seen.north_m - there.position_enu_m[1]
    )
    on_ray_m = there.position_enu_m[2] - from_camera / np.maximum(tangent, 1e-9)
    beneath = near & (tangent > 0.05)
    assert np.ptp(ground_m[beneath]) > 5.0
    assert np.abs(on_ray_m - ground_m)[beneath].max() < 0.2
