"""The start of a lens fit: Scaramuzza's linear solution for an assumed image centre.

Scaramuzza, Martinelli, Siegwart, "A Flexible Technique for Accurate Omnidirectional Camera
Calibration and Structure from Motion", ICVS 2006. Axes as in `recon.camera.omnidirectional`: a
pixel at offset (x right, y down) from the centre has the ray (x, y, depth(radius)), and a point of
the board lies at p = r1 X + r2 Y + t. Both are parallel:

    x p2 - y p1 = 0                      linear in r11 r12 t1 r21 r22 t2, one photo at a time
    depth(radius) across = radius p3     linear in the depth's coefficients and every photo's t3

with across = (x p1 + y p2) / radius. The third row of the rotation follows from its columns being
of equal length and at right angles, up to a sign for each photo.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from recon.model.arrays import FloatArray

POWERS = (0, 2, 3, 4)
"""Powers of the radius in the depth: a lens is smooth at its centre, so none is of degree 1."""
ROUNDS = 5
"""Rounds of weighting photos by their residual and choosing their signs anew."""


@dataclass(frozen=True, slots=True, eq=False)
class BoardPose:
    """A board in the camera's axes: point = rotation @ point on the board + offset_mm."""

    rotation: FloatArray
    offset_mm: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _HalfPose:
    """What one photo gives alone: two rows of the rotation, two offsets; the third row but for
    its sign."""

    rows: FloatArray
    """(3, 2): the rotation's first two columns."""
    offset_mm: FloatArray
    """(2,)"""


def linear_start(
    offsets_px: Sequence[FloatArray], points_mm: FloatArray, radius_px: float
) -> tuple[FloatArray, list[BoardPose]]:
    """Return the depth's coefficients (4,) at `POWERS` of radius / `radius_px`, and the poses.

    `offsets_px` has the corners (N, 2) of each photo less the assumed centre, `points_mm` (N, 3)
    the corners on the board. The depth has the unit of `radius_px` too.
    """
    halves = [half_pose(offsets / radius_px, points_mm[:, :2]) for offsets in offsets_px]
    designs = [
        _design(offsets / radius_px, points_mm[:, :2], half)
        for offsets, half in zip(offsets_px, halves, strict=True)
    ]
    signs = np.ones(len(halves))
    weights = np.ones(len(halves))
    for _ in range(ROUNDS):
        depth, thirds_mm = _joint(designs, signs, weights)
        signs, misses = _best_signs(designs, depth)
        # A photo whose corners are wrong must not decide: its weight falls with its residual.
        weights = 1.0 / np.maximum(misses, np.median(misses))
    depth, thirds_mm = _joint(designs, signs, weights)
    poses = [
        _pose(half, sign, third) for half, sign, third in zip(halves, signs, thirds_mm, strict=True)
    ]
    return depth, poses


def turning_miss(offsets_px: FloatArray, points_mm: FloatArray) -> float:
    """Return how badly the boards (K, N, 2) turn about the assumed centre: 0 for the true one.

    It is the median over photos, which one with wrong corners does not move.
    """
    rows, _ = _turning_rows(offsets_px / float(np.abs(offsets_px).max()), points_mm[:, :2])
    smallest = np.linalg.eigvalsh(np.swapaxes(rows, 1, 2) @ rows)[:, :2]
    return float(np.median(smallest[:, 0] / np.maximum(smallest[:, 1], 1e-30)))


def half_pose(offsets: FloatArray, points_mm: FloatArray) -> _HalfPose:
    """Return what the offsets (N, 2) of one photo's corners give by themselves."""
    rows, scale = _turning_rows(offsets, points_mm)
    found = np.linalg.svd(rows, full_matrices=False)[2][-1].reshape(2, 3) / scale
    # The board is where the pixels are, not on the opposite side of the centre.
    on_board = np.column_stack([points_mm, np.ones(len(points_mm))])
    if np.sum(offsets * (on_board @ found.T)) < 0.0:
        found = -found
    return _with_third_row(found)


def _turning_rows(offsets: FloatArray, points_mm: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the factors (..., N, 6) of r11 r12 t1 r21 r22 t2, and the units (3,) of each three."""
    scale = np.append(np.full(2, np.abs(points_mm).max()), 1.0)
    on_board = np.column_stack([points_mm, np.ones(len(points_mm))]) / scale
    rows = np.concatenate([-offsets[..., 1:] * on_board, offsets[..., :1] * on_board], axis=-1)
    return rows, scale


def _with_third_row(found: FloatArray) -> _HalfPose:
    first, second = found[:, 0], found[:, 1]
    product = -float(first @ second)
    longer = float(first @ first - second @ second)
    root = np.hypot(longer, 2.0 * product)
    # Squares of the third row's entries; the larger one is taken first, so that nothing small
    # divides.
    squares = max(0.0, (root - longer) / 2.0), max(0.0, (root + longer) / 2.0)
    if squares[0] >= squares[1]:
        third = np.sqrt(squares[0])
        last = np.array([third, product / third if third > 0.0 else 0.0])
    else:
        third = np.sqrt(squares[1])
        last = np.array([product / third, third])
    columns = np.vstack([found[:, :2], last])
    scale = float(np.linalg.norm(columns) / np.sqrt(2.0))
    return _HalfPose(columns / scale, found[:, 2] / scale)


def _design(
    offsets: FloatArray, points_mm: FloatArray, half: _HalfPose
) -> tuple[FloatArray, FloatArray]:
    """Return (N, 5) factors of the depth's coefficients and -t3, and (N,) r31 X + r32 Y.

    Each equation is divided by the board's distance across, so that it is in units of the radius.
    """
    radius = np.maximum(np.linalg.norm(offsets, axis=1), 1e-9)
    placed = points_mm @ half.rows[:2].T + half.offset_mm
    across = np.sum(offsets * placed, axis=1) / radius
    typical = float(np.median(np.abs(across)))
    by_power = np.stack([across * radius**power for power in POWERS], axis=1)
    factors = np.column_stack([by_power, -radius]) / typical
    return factors, radius * (points_mm @ half.rows[2]) / typical


def _joint(
    designs: Sequence[tuple[FloatArray, FloatArray]], signs: FloatArray, weights: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the depth's coefficients (4,) and t3 (K,) with the least squares over all photos."""
    count = len(POWERS)
    rows, sides = [], []
    for number, (factors, side) in enumerate(designs):
        wide = np.zeros((len(side), count + len(designs)))
        wide[:, :count] = factors[:, :count]
        wide[:, count + number] = factors[:, count]
        rows.append(weights[number] * wide)
        sides.append(weights[number] * signs[number] * side)
    matrix = np.vstack(rows)
    sizes = np.maximum(np.linalg.norm(matrix, axis=0), 1e-12)
    solved, *_ = np.linalg.lstsq(matrix / sizes, np.concatenate(sides), rcond=None)
    solved = solved / sizes
    # The equations hold as well with every sign changed: the scene is in front of the lens.
    direction = 1.0 if solved[0] >= 0.0 else -1.0
    return direction * solved[:count], direction * solved[count:]


def _best_signs(
    designs: Sequence[tuple[FloatArray, FloatArray]], depth: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return each photo's sign (K,) that fits these coefficients, and its residual (K,)."""
    signs, misses = np.ones(len(designs)), np.zeros(len(designs))
    for number, (factors, side) in enumerate(designs):
        radii = factors[:, len(POWERS)]
        known = factors[:, : len(POWERS)] @ depth
        by_sign = []
        for sign in (1.0, -1.0):
            left = sign * side - known
            left = left - radii * (radii @ left) / (radii @ radii)
            by_sign.append(float(np.sqrt(np.mean(left**2))))
        signs[number] = 1.0 if by_sign[0] <= by_sign[1] else -1.0
        misses[number] = min(by_sign)
    return signs, np.maximum(misses, 1e-12)


def _pose(half: _HalfPose, sign: float, third_mm: float) -> BoardPose:
    columns = half.rows.copy()
    columns[2] *= sign
    left, _, right = np.linalg.svd(columns, full_matrices=False)
    first, second = (left @ right).T
    rotation = np.stack([first, second, np.cross(first, second)], axis=1)
    return BoardPose(rotation, np.append(half.offset_mm, third_mm))
