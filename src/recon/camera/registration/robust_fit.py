"""The pose that sees the reference's ground points where a frame has them: a robust fit.

Six parameters: a rotation vector (rad, ENU) and a shift (m, ENU) from the prior pose. Residuals lie
on the unit sphere, in the plane across each measured ray, scaled to pixels. Gauss-Newton with
weights by Cauchy's and then Tukey's function of the residual over a robust scale: features on
moving shadow edges get no weight. The prior keeps directions that no feature fixes.
Nothing is drawn at random: the same input gives the same pose.
"""

from dataclasses import dataclass

import numpy as np

from recon.camera.registration.settings import RegistrationSettings
from recon.model.arrays import FloatArray
from recon.model.imagery import CameraPose

MOST_ROUNDS, CONVERGED_PX = 10, 0.01
CAUCHY, TUKEY = 2.385, 4.685
"""Tuning constants for 95 % efficiency on normal errors (Huber, Robust Statistics)."""
LEAST_SCALE_PX, LARGEST_SCALE_PX = 0.15, 4.0
DEVIATION_PER_MEDIAN = 1.4826
"""Standard deviation of normal errors over the median of their sizes."""


@dataclass(frozen=True, slots=True, eq=False)
class PoseEstimate:
    """A fitted pose with its covariance, and each feature's residual (N,) in pixels.

    The covariance is relative to the reference frame's pose.
    """

    pose: CameraPose
    residuals_px: FloatArray


def fit_to_rays(
    ground_m: FloatArray,
    rays: FloatArray,
    start: CameraPose,
    prior: CameraPose,
    px_per_rad: float,
    settings: RegistrationSettings,
) -> PoseEstimate:
    """Return the pose that sees `ground_m` (N, 3, ENU) along the camera's unit `rays` (N, 3).

    The search begins at `start`; `prior` is telemetry's pose.
    """
    sigmas = np.repeat(
        [settings.rotation_sigma_rad, settings.horizontal_sigma_m, settings.vertical_sigma_m],
        [3, 2, 1],
    )
    prior_information = np.diag((settings.feature_sigma_px / sigmas) ** 2)
    rotation, position = start.rotation_enu_camera, start.position_enu_m
    information = prior_information
    for is_last in (False, True):
        for _ in range(MOST_ROUNDS):
            errors, jacobian = _linearised(ground_m, rays, rotation, position, px_per_rad)
            weights = _weights(np.hypot(*errors.T), is_last=is_last)
            design = jacobian.reshape(-1, 6)
            weighted = (jacobian * weights[:, np.newaxis, np.newaxis]).reshape(-1, 6)
            information = weighted.T @ design + prior_information
            pull = weighted.T @ errors.ravel()
            pull -= prior_information @ _moved(prior, rotation, position)
            step: FloatArray = np.linalg.solve(information, pull).astype(np.float64, copy=False)
            rotation, position = turned(rotation, step[:3]), position + step[3:]
            if np.abs(design @ step).max() < CONVERGED_PX:
                break
    errors, _ = _linearised(ground_m, rays, rotation, position, px_per_rad)
    covariance: FloatArray = np.linalg.inv(information).astype(np.float64, copy=False)
    covariance = covariance * settings.feature_sigma_px**2
    return PoseEstimate(CameraPose(rotation, position, covariance), np.hypot(*errors.T))


def turned(rotation: FloatArray, vector_rad: FloatArray) -> FloatArray:
    """Return a rotation (3, 3) turned further by a rotation vector in ENU."""
    from scipy.spatial.transform import Rotation

    turn: FloatArray = Rotation.from_rotvec(vector_rad).as_matrix()
    return turn @ rotation


def _moved(prior: CameraPose, rotation: FloatArray, position: FloatArray) -> FloatArray:
    """Return rotation vector (rad, ENU) and shift (m, ENU) from the prior pose, (6,)."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_matrix(rotation @ prior.rotation_enu_camera.T).as_rotvec()
    return np.concatenate([turn, position - prior.position_enu_m])


def _linearised(
    ground_m: FloatArray,
    rays: FloatArray,
    rotation: FloatArray,
    position: FloatArray,
    px_per_rad: float,
) -> tuple[FloatArray, FloatArray]:
    """Return measured less predicted (N, 2) in pixels, and how the prediction moves (N, 2, 6)."""
    offsets = ground_m - position
    distance_m = np.linalg.norm(offsets, axis=1)[:, np.newaxis]
    predicted = offsets / distance_m
    measured = rays @ rotation.T
    across = _across(measured)
    errors = np.einsum("nij,nj->ni", across, measured - predicted) * px_per_rad
    # Turning the camera by w moves a measured ray by w x ray; shifting it by s moves the predicted
    # one by -s / distance. Both make the error smaller by what is returned.
    by_turn = np.cross(across, predicted[:, np.newaxis, :])
    by_shift = -across / distance_m[:, :, np.newaxis]
    return errors, np.concatenate([by_turn, by_shift], axis=2) * px_per_rad


def _across(rays: FloatArray) -> FloatArray:
    """Return two unit vectors (N, 2, 3) across each unit ray and each other."""
    axis = np.where(np.abs(rays[:, :1]) < 0.7, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    first = np.cross(rays, axis)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(rays, first)], axis=1)


def _weights(sizes_px: FloatArray, *, is_last: bool) -> FloatArray:
    """Return each feature's weight 0 to 1 by the size of its error."""
    scale_px = DEVIATION_PER_MEDIAN * float(np.median(sizes_px))
    scale_px = min(max(scale_px, LEAST_SCALE_PX), LARGEST_SCALE_PX)
    if not is_last:
        cauchy: FloatArray = 1.0 / (1.0 + (sizes_px / (CAUCHY * scale_px)) ** 2)
        return cauchy
    tukey: FloatArray = np.clip(1.0 - (sizes_px / (TUKEY * scale_px)) ** 2, 0.0, None) ** 2
    return tukey
