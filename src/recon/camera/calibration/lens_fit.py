"""Least squares over all lens parameters and all board poses, from a linear start.

Free of the lens: four coefficients of the depth, the centre, and two of the three affine
parameters. The third one is a rotation about the optical axis, which the poses have already, so the
affine matrix [[c, d], [e, 1]] is kept symmetric (d = e). The radius of a point is the root of
radius Z - depth(radius) R = 0, with R across and Z along the axis; its derivatives are those of an
implicit function.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares
from scipy.sparse import csr_matrix
from scipy.spatial.transform import Rotation

from recon.camera.calibration.linear_start import POWERS, BoardPose
from recon.model.arrays import FloatArray

CENTRE = len(POWERS)
"""Index of the centre's column in the parameters; then its row, c - 1, and d."""
LENS_PARAMETERS = CENTRE + 4
POSE_PARAMETERS = 6
NEWTON_STEPS = 6
"""Newton steps from the observed radius, which is within pixels of the root."""
HUBER_PX = 0.5
"""Residuals beyond this count linearly: good corners are within 0.3 px."""
MOST_EVALUATIONS = 60
"""Ten to twenty suffice; the robust fit, whose end is only a start, may creep on for hundreds."""
FARTHEST_PX = 1e6
LEAST_INFORMATION = 1e-13
"""Share of the largest eigenvalue: below it, that combination of parameters is unknown."""


@dataclass(frozen=True, slots=True, eq=False)
class LensFit:
    """A fitted lens and the boards' poses."""

    parameters: FloatArray
    """(8,): the depth's coefficients at `POWERS` of radius / `radius_px`, in units of `radius_px`;
    the centre's column and row; c - 1; d."""
    radius_px: float
    poses: tuple[BoardPose, ...]
    residuals_px: FloatArray
    """(K, N, 2): observed minus predicted (col, row), left-out corners included."""
    sigma: FloatArray
    """(8,) standard deviations of the parameters, by the scatter of the corners used."""


@dataclass(frozen=True, slots=True, eq=False)
class Observations:
    """Corners (K, N, 2) of K photos, which of them count (K, N), and the board's points (N, 3)."""

    corners_px: FloatArray
    is_used: npt.NDArray[np.bool_]
    points_mm: FloatArray


def fit_lens(
    seen: Observations,
    start: FloatArray,
    radius_px: float,
    poses: Sequence[BoardPose],
    *,
    is_robust: bool,
) -> LensFit:
    """Return the least-squares fit from `start` (8,) and one pose for each photo.

    `is_robust` has outliers count linearly; without it every used corner counts fully.
    """
    reach_mm = float(np.abs(seen.points_mm).max())
    first = _packed(start, poses, reach_mm)
    weights = np.repeat(seen.is_used.reshape(-1), 2).astype(np.float64)

    def residuals(parameters: FloatArray) -> FloatArray:
        predicted, _ = _predicted(parameters, seen, radius_px, reach_mm)
        left = (predicted - seen.corners_px).reshape(-1) * weights
        return _finite(left)

    def jacobian(parameters: FloatArray) -> csr_matrix:
        _, derivatives = _predicted(parameters, seen, radius_px, reach_mm)
        return _assembled(derivatives, weights)

    # Corners of no lens lead the fit astray: it ends, and its residuals are refused.
    with np.errstate(all="ignore"):
        found = least_squares(
            residuals,
            first,
            jac=jacobian,
            x_scale="jac",
            loss="huber" if is_robust else "linear",
            f_scale=HUBER_PX,
            # A photo's corners depend on the lens and its own pose alone: most derivatives are 0.
            tr_solver="lsmr",
            max_nfev=MOST_EVALUATIONS,
        )
        predicted, derivatives = _predicted(found.x, seen, radius_px, reach_mm)
    predicted = _finite(predicted)
    errors = seen.corners_px - predicted
    return LensFit(
        found.x[:LENS_PARAMETERS],
        radius_px,
        _unpacked(found.x, reach_mm),
        errors,
        _sigma(_assembled(derivatives, weights), errors[seen.is_used]),
    )


def _packed(start: FloatArray, poses: Sequence[BoardPose], reach_mm: float) -> FloatArray:
    turns = Rotation.from_matrix(np.stack([pose.rotation for pose in poses])).as_rotvec()
    offsets = np.stack([pose.offset_mm for pose in poses]) / reach_mm
    return np.concatenate([start, np.hstack([turns, offsets]).ravel()])


def _unpacked(parameters: FloatArray, reach_mm: float) -> tuple[BoardPose, ...]:
    poses = parameters[LENS_PARAMETERS:].reshape(-1, POSE_PARAMETERS)
    rotations = Rotation.from_rotvec(poses[:, :3]).as_matrix()
    return tuple(
        BoardPose(rotation, pose[3:] * reach_mm)
        for rotation, pose in zip(rotations, poses, strict=True)
    )


def _predicted(
    parameters: FloatArray, seen: Observations, radius_px: float, reach_mm: float
) -> tuple[FloatArray, tuple[FloatArray, FloatArray]]:
    """Return pixels (K, N, 2) and their derivatives by the lens and by each photo's pose."""
    poses = parameters[LENS_PARAMETERS:].reshape(-1, POSE_PARAMETERS)
    board = seen.points_mm / reach_mm
    rotation, turned_by = _rotations(poses[:, :3])
    points = np.einsum("kij,nj->kni", rotation, board) + poses[:, np.newaxis, 3:]
    observed = np.linalg.norm(seen.corners_px - parameters[CENTRE : CENTRE + 2], axis=2) / radius_px
    pixels, by_lens, by_point = project(parameters[:LENS_PARAMETERS], points, observed, radius_px)
    moved_by = np.einsum("kmij,nj->knim", turned_by, board)
    by_pose = np.concatenate([by_point @ moved_by, by_point], axis=3)
    return pixels, (by_lens, by_pose)


def project(
    lens: FloatArray, points: FloatArray, radius_start: FloatArray, radius_px: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return pixels (K, N, 2) of points (K, N, 3), and their derivatives.

    Those by the lens are (K, N, 2, 8), by the point (K, N, 2, 3). `radius_start` (K, N) is near the
    points' radii, in units of `radius_px`.
    """
    across = np.maximum(np.hypot(points[..., 0], points[..., 1]), 1e-12)
    along = points[..., 2]
    depth = lens[:CENTRE]
    radius = radius_start
    for _ in range(NEWTON_STEPS):
        value, slope = _depth_and_slope(depth, radius)
        radius = radius - (radius * along - value * across) / (along - slope * across)
    value, slope = _depth_and_slope(depth, radius)
    rate = along - slope * across
    direction = points[..., :2] / across[..., np.newaxis]
    affine = np.array([[1.0, lens[CENTRE + 3]], [lens[CENTRE + 3], 1.0 + lens[CENTRE + 2]]])
    offset = radius_px * radius[..., np.newaxis] * direction
    pixels = offset @ affine.T + lens[CENTRE : CENTRE + 2]

    by_lens = np.zeros((*pixels.shape, LENS_PARAMETERS))
    for index, power in enumerate(POWERS):
        grown = radius_px * radius**power * across / rate
        by_lens[..., index] = (grown[..., np.newaxis] * direction) @ affine.T
    by_lens[..., 0, CENTRE] = by_lens[..., 1, CENTRE + 1] = 1.0
    by_lens[..., 1, CENTRE + 2] = offset[..., 1]
    by_lens[..., 0, CENTRE + 3], by_lens[..., 1, CENTRE + 3] = offset[..., 1], offset[..., 0]

    # Along the radius the offset changes with across and along, around it by radius / across.
    outward = direction[..., :, np.newaxis] * direction[..., np.newaxis, :]
    around = np.eye(2) - outward
    shape = (..., np.newaxis, np.newaxis)
    by_side = (value / rate)[shape] * outward + (radius / across)[shape] * around
    by_along = (-radius / rate)[..., np.newaxis] * direction
    by_point = radius_px * np.concatenate([by_side, by_along[..., np.newaxis]], axis=-1)
    return pixels, by_lens, affine @ by_point


def _depth_and_slope(depth: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
    value, slope = np.zeros_like(radius), np.zeros_like(radius)
    for coefficient, power in zip(depth, POWERS, strict=True):
        value = value + coefficient * radius**power
        if power:
            slope = slope + power * coefficient * radius ** (power - 1)
    return value, slope


def _rotations(turns: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return rotations (K, 3, 3) of rotation vectors (K, 3), and derivatives (K, 3, 3, 3)."""
    step = 1e-6
    shifted = turns[:, np.newaxis, np.newaxis] + step * np.stack([np.eye(3), -np.eye(3)], axis=1)
    both = Rotation.from_rotvec(shifted.reshape(-1, 3)).as_matrix().reshape(-1, 3, 2, 3, 3)
    return Rotation.from_rotvec(turns).as_matrix(), (both[:, :, 0] - both[:, :, 1]) / (2.0 * step)


def _finite(values: FloatArray) -> FloatArray:
    """Return the values within +-`FARTHEST_PX`, as an optimiser needs them."""
    within: FloatArray = np.clip(np.nan_to_num(values, nan=FARTHEST_PX), -FARTHEST_PX, FARTHEST_PX)
    return within


def _assembled(derivatives: tuple[FloatArray, FloatArray], weights: FloatArray) -> csr_matrix:
    """Return the Jacobian (2 K N, 8 + 6 K) of all residuals, each times its weight (2 K N,)."""
    by_lens, by_pose = (part.reshape(len(part), -1, part.shape[-1]) for part in derivatives)
    photos, residuals, _ = by_lens.shape
    values = np.concatenate([by_lens, by_pose], axis=2) * weights.reshape(photos, residuals, 1)
    values = _finite(values)
    own = LENS_PARAMETERS + POSE_PARAMETERS * np.arange(photos)[:, np.newaxis]
    columns = np.hstack(
        [np.tile(np.arange(LENS_PARAMETERS), (photos, 1)), own + np.arange(POSE_PARAMETERS)]
    )
    width = columns.shape[1]
    indices = np.repeat(columns, residuals, axis=0).ravel()
    starts = width * np.arange(photos * residuals + 1)
    shape = (photos * residuals, LENS_PARAMETERS + POSE_PARAMETERS * photos)
    return csr_matrix((values.ravel(), indices, starts), shape=shape)


def _sigma(jacobian: csr_matrix, errors_px: FloatArray) -> FloatArray:
    """Return (8,): the lens parameters' standard deviations; huge where undetermined."""
    information = (jacobian.T @ jacobian).toarray()
    sizes = np.sqrt(np.maximum(np.diag(information), 1e-24))
    values, vectors = np.linalg.eigh(information / np.outer(sizes, sizes))
    variance = 1.0 / np.maximum(values, LEAST_INFORMATION * values[-1])
    freedom = max(errors_px.size - jacobian.shape[1], 1)
    spread = (
        np.sum(vectors[:LENS_PARAMETERS] ** 2 * variance, axis=1) / sizes[:LENS_PARAMETERS] ** 2
    )
    deviations: FloatArray = np.sqrt(spread * np.sum(errors_px**2) / freedom)
    return deviations
