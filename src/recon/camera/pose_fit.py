"""A camera pose fitted to pixels and points: P3P over all triples, then least squares.

Each triple's P3P solutions are scored on all points; the best one starts a least-squares fit of the
reprojection error, in pixels of the camera model. The covariance assumes independent marking errors
with the scatter of the residuals.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, islice
from math import comb

import numpy as np

from recon.camera.errors import PoseError
from recon.camera.omnidirectional import OmnidirectionalCamera
from recon.camera.p3p import solve_p3p
from recon.model.arrays import FloatArray

MOST_TRIPLES = 1_500
"""All triples of 21 points; of more points an even selection, to bound the time of loading."""
LEAST_SPREAD_RATIO = 0.02
"""Points nearer to one line than this share of its length do not fix the rotation about it."""
LEAST_SEPARATION_RATIO = 0.01
"""Share of the points' extent: two points nearer than this count as one place marked twice."""
FEWEST_PLACES = 4


@dataclass(frozen=True, slots=True, eq=False)
class PoseFit:
    """A fitted pose: rotation camera to ENU (3, 3), position (3,), covariance (6, 6)."""

    rotation: FloatArray
    position: FloatArray
    covariance: FloatArray


def fit_pose(camera: OmnidirectionalCamera, pixels: FloatArray, points_enu: FloatArray) -> PoseFit:
    """Return the pose with the least reprojection error of `points_enu` (N, 3) at `pixels` (N, 2).

    N is at least 4. Raises `PoseError` for points on one line, or that do not determine a pose.
    """
    _refuse_degenerate(points_enu)
    return _refine(camera, pixels, points_enu, _best_start(camera, pixels, points_enu))


def _refuse_degenerate(points_enu: FloatArray) -> None:
    spread = np.linalg.svd(points_enu - points_enu.mean(axis=0), compute_uv=False)
    if not spread[1] > LEAST_SPREAD_RATIO * spread[0]:
        raise PoseError(
            "expected control points spread over an area, got points on one line (or one place): "
            "the camera could be turned about that line; mark a point well off it"
        )
    places = _count_places(points_enu, LEAST_SEPARATION_RATIO * float(spread[0]))
    if places < FEWEST_PLACES:
        raise PoseError(
            f"expected control points at {FEWEST_PLACES} places or more, got {len(points_enu)} at "
            f"{places}: three places allow up to four poses; mark another place"
        )


def _count_places(points_enu: FloatArray, least_separation_m: float) -> int:
    places: list[FloatArray] = []
    for point in points_enu:
        if all(np.linalg.norm(point - place) >= least_separation_m for place in places):
            places.append(point)
    return len(places)


def _triples(count: int) -> Iterator[tuple[int, int, int]]:
    # Every n-th triple in lexicographic order covers all points evenly, without random numbers.
    stride = -(-comb(count, 3) // MOST_TRIPLES)
    return islice(combinations(range(count), 3), 0, None, stride)


def _best_start(
    camera: OmnidirectionalCamera, pixels: FloatArray, points_enu: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the P3P pose (rotation, position) with the least squared error over all points."""
    best: tuple[float, tuple[FloatArray, FloatArray]] | None = None
    ground_m = points_enu[:, 2].mean()
    rays = camera.unproject(pixels)
    for triple in _triples(len(points_enu)):
        chosen = list(triple)
        for rotation, position in solve_p3p(rays[chosen], points_enu[chosen]):
            # P3P has mirrored solutions below the ground.
            if position[2] <= ground_m:
                continue
            cost = float(np.sum(residuals_px(camera, pixels, points_enu, rotation, position) ** 2))
            if best is None or cost < best[0]:
                best = (cost, (rotation, position))
    if best is None:
        raise PoseError(
            "expected control points that fit a camera above the ground, got none: no three "
            "of them agree with any pose; check that columns, rows and coordinates are not mixed up"
        )
    return best[1]


def residuals_px(
    camera: OmnidirectionalCamera,
    pixels: FloatArray,
    points_enu: FloatArray,
    rotation: FloatArray,
    position: FloatArray,
) -> FloatArray:
    """Return observed minus predicted pixels, (N, 2)."""
    rays = (points_enu - position) @ rotation
    return pixels - camera.project_beyond_range(rays)


def _refine(
    camera: OmnidirectionalCamera,
    pixels: FloatArray,
    points_enu: FloatArray,
    start: tuple[FloatArray, FloatArray],
) -> PoseFit:
    rotation, position = start
    # Scale of the step: one radian moves the image about as much as this many metres.
    lever_m = float(position[2] - points_enu[:, 2].mean())
    step_sizes = np.array([1.0, 1.0, 1.0, lever_m, lever_m, lever_m])
    # Twice, so that the Jacobian of the second fit is taken about the solution itself.
    for _ in range(2):
        step, jacobian, sum_of_squares = _fit_step(
            camera, pixels, points_enu, rotation, position, step_sizes
        )
        rotation, position = _moved(rotation, position, step)
    return PoseFit(rotation, position, _covariance(jacobian, sum_of_squares, step_sizes))


def _moved(
    rotation: FloatArray, position: FloatArray, step: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Turn by the step's rotation vector (rad, ENU) and shift by its last three (m, ENU)."""
    from scipy.spatial.transform import Rotation

    turn: FloatArray = Rotation.from_rotvec(step[:3]).as_matrix()
    return turn @ rotation, position + step[3:]


def _fit_step(
    camera: OmnidirectionalCamera,
    pixels: FloatArray,
    points_enu: FloatArray,
    rotation: FloatArray,
    position: FloatArray,
    step_sizes: FloatArray,
) -> tuple[FloatArray, FloatArray, float]:
    """Return the step (6,) to the least squares, the Jacobian (2N, 6), the sum of squares."""

    from scipy.optimize import least_squares

    def cost(step: FloatArray) -> FloatArray:
        moved = _moved(rotation, position, step)
        return residuals_px(camera, pixels, points_enu, *moved).ravel()

    found = least_squares(
        cost, np.zeros(6), jac="3-point", x_scale=step_sizes, method="lm", xtol=1e-12, ftol=1e-12
    )
    return found.x, np.asarray(found.jac, dtype=np.float64), float(2.0 * found.cost)


def _covariance(jacobian: FloatArray, sum_of_squares: float, step_sizes: FloatArray) -> FloatArray:
    """Return the step's covariance (6, 6); raises `PoseError` when it is not determined."""
    scaled = jacobian * step_sizes
    singular = np.linalg.svd(scaled, compute_uv=False)
    if not singular[-1] > 1e-6 * singular[0]:
        raise PoseError(
            "expected control points that fix the camera's position and direction, got points that "
            "leave a motion undetermined; mark points that are spread out further"
        )
    # 2 N residuals less 6 parameters; at least 2 for 4 points.
    freedom = jacobian.shape[0] - jacobian.shape[1]
    information = np.linalg.inv(scaled.T @ scaled)
    covariance: FloatArray = (
        np.outer(step_sizes, step_sizes) * information * (sum_of_squares / freedom)
    )
    return covariance
