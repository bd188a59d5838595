"""The camera hangs a little off, by as much as is set, whenever it is asked."""

import numpy as np
import pytest

from recon.model.imagery import CameraPose
from recon.sim.camera import HoverSettings
from recon.sim.camera.rig import true_pose

STILL = HoverSettings(wobble_deg=0.0, mount_error_deg=0.0, drift_m=0.0, drift_up_m=0.0)


def leans_deg(level: CameraPose, settings: HoverSettings, seed: int, times: list[float]):
    """Return the rotation vector (N, 3) in the camera's axes between believed and true pose."""
    leans = []
    for time_s in times:
        there = true_pose(level, settings, seed, time_s)
        turn = level.rotation_enu_camera.T @ there.rotation_enu_camera
        assert turn @ turn.T == pytest.approx(np.eye(3), abs=1e-12)
        assert np.linalg.det(turn) == pytest.approx(1.0)
        skew = (turn - turn.T) / 2.0
        leans.append(np.degrees([skew[2, 1], skew[0, 2], skew[1, 0]]))
    return np.array(leans)


def test_without_errors_the_true_pose_is_the_computed_one(pose) -> None:
    level = pose(120.0, 3.0, 4.0, 20.0)
    there = true_pose(level, STILL, 7, 55.0)
    assert np.array_equal(there.rotation_enu_camera, level.rotation_enu_camera)
    assert np.array_equal(there.position_enu_m, level.position_enu_m)


def test_wobble_has_its_deviation_and_its_time(pose) -> None:
    settings = HoverSettings(
        wobble_deg=0.5, wobble_s=2.0, mount_error_deg=0.0, drift_m=0.0, drift_up_m=0.0
    )
    times = [0.5 * step for step in range(4_000)]
    leans = leans_deg(pose(), settings, 3, times)
    assert leans.std(axis=0) == pytest.approx(np.full(3, 0.5), rel=0.12)
    after_2_s = np.mean(leans[:-4] * leans[4:]) / np.mean(leans**2)
    assert after_2_s == pytest.approx(np.exp(-1.0), abs=0.1)
    assert abs(np.corrcoef(leans.T)[0, 1]) < 0.1


def test_the_mounts_error_stays(pose) -> None:
    settings = HoverSettings(wobble_deg=0.0, mount_error_deg=1.0)
    leans = np.array([leans_deg(pose(), settings, seed, [0.0, 999.0]) for seed in range(150)])
    assert np.array_equal(leans[:, 0], leans[:, 1])
    assert leans.std(axis=(0, 1)) == pytest.approx(np.ones(3), rel=0.2)


def test_drift_has_its_deviations(pose) -> None:
    settings = HoverSettings(drift_m=1.5, drift_up_m=0.4, drift_s=5.0)
    level = pose(100.0)
    away = np.array(
        [true_pose(level, settings, 1, 3.0 * n).position_enu_m for n in range(2_000)]
    ) - (0.0, 0.0, 100.0)
    assert away.std(axis=0) == pytest.approx([1.5, 1.5, 0.4], rel=0.12)
