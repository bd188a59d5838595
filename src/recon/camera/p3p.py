"""The camera's pose from three points and the rays to them (perspective three-point problem).

Grunert (1841) as set out by Haralick, Lee, Ottenberg and Noelle (IJCV 13, 1994): the law of cosines
in the three triangles of camera and points gives a quartic in the ratio of two distances. Inputs
are rays, not image points, so fields of view over 180 degrees work as well.
"""

import numpy as np

from recon.model.arrays import FloatArray

LARGEST_IMAGINARY_PART = 1e-3
"""Roots this near the real axis count as real: under marking noise a double root splits into a
complex pair."""


def solve_p3p(rays: FloatArray, points_m: FloatArray) -> list[tuple[FloatArray, FloatArray]]:
    """Return up to four poses (rotation_world_camera (3, 3), position_m (3,)).

    `rays` (3, 3) are unit rays in camera axes, one per row; `points_m` (3, 3) the points they see.
    Points on one line, or rays that coincide, give an empty list.
    """
    poses = []
    for distances in _distances(rays, points_m):
        pose = _align(rays * distances[:, np.newaxis], points_m)
        if pose is not None:
            poses.append(pose)
    return poses


def _distances(rays: FloatArray, points_m: FloatArray) -> list[FloatArray]:
    """Return the camera's possible distances (3,) to the three points."""
    a2, b2, c2 = (
        float(np.sum((points_m[i] - points_m[j]) ** 2)) for i, j in ((1, 2), (0, 2), (0, 1))
    )
    cos_a, cos_b, cos_c = (float(rays[i] @ rays[j]) for i, j in ((1, 2), (0, 2), (0, 1)))
    if min(a2, b2, c2) <= 0.0:
        return []
    quartic = _quartic(a2 / b2, c2 / b2, cos_a, cos_b, cos_c)
    # A vanishing leading coefficient makes roots run off to infinity.
    if not np.isfinite(quartic).all() or abs(quartic[0]) < 1e-14:
        return []
    difference = (a2 - c2) / b2
    found = []
    for root in np.roots(quartic):
        v = float(root.real)
        # u and v are the distances to points 2 and 3 over that to point 1.
        denominator = 2.0 * (cos_c - v * cos_a)
        if abs(root.imag) > LARGEST_IMAGINARY_PART * max(1.0, abs(v)) or v <= 0.0:
            continue
        if abs(denominator) < 1e-12:
            continue
        u = ((difference - 1.0) * v * v - 2.0 * difference * cos_b * v + 1.0 + difference) / (
            denominator
        )
        first_squared = b2 / (1.0 + v * v - 2.0 * v * cos_b)
        if u > 0.0 and first_squared > 0.0:
            found.append(np.sqrt(first_squared) * np.array([1.0, u, v]))
    return found


def _quartic(a: float, c: float, cos_a: float, cos_b: float, cos_c: float) -> FloatArray:
    """Return coefficients, highest power first; `a`, `c` are the squared sides a, c over b^2."""
    d, s = a - c, a + c
    return np.array(
        [
            (d - 1.0) ** 2 - 4.0 * c * cos_a**2,
            4.0 * (d * (1.0 - d) * cos_b - (1.0 - s) * cos_a * cos_c + 2.0 * c * cos_a**2 * cos_b),
            2.0
            * (
                d * d
                - 1.0
                + 2.0 * d * d * cos_b**2
                + 2.0 * (1.0 - c) * cos_a**2
                - 4.0 * s * cos_a * cos_b * cos_c
                + 2.0 * (1.0 - a) * cos_c**2
            ),
            4.0 * (-d * (1.0 + d) * cos_b + 2.0 * a * cos_c**2 * cos_b - (1.0 - s) * cos_a * cos_c),
            (1.0 + d) ** 2 - 4.0 * a * cos_c**2,
        ]
    )


def _align(
    camera_points_m: FloatArray, points_m: FloatArray
) -> tuple[FloatArray, FloatArray] | None:
    """Return rotation and position that map camera points to world points, None if degenerate."""
    camera_axes = _triad(camera_points_m)
    world_axes = _triad(points_m)
    if camera_axes is None or world_axes is None:
        return None
    rotation: FloatArray = world_axes @ camera_axes.T
    position: FloatArray = points_m.mean(axis=0) - rotation @ camera_points_m.mean(axis=0)
    return rotation, position


def _triad(points_m: FloatArray) -> FloatArray | None:
    """Return right-handed axes (columns) fixed to a triangle, None for points on a line."""
    along = points_m[1] - points_m[0]
    normal = np.cross(along, points_m[2] - points_m[0])
    along_length, normal_length = np.linalg.norm(along), np.linalg.norm(normal)
    if along_length <= 0.0 or normal_length <= 1e-9 * along_length**2:
        return None
    along, normal = along / along_length, normal / normal_length
    return np.stack([along, np.cross(normal, along), normal], axis=1)
