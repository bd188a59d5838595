"""Paths: legs between waypoints, with corners cut by a quadratic curve, as polylines.

A corner of radius r leaves its leg r before the waypoint and joins the next leg r after it, along
the quadratic Bezier curve whose middle control point is the waypoint. So the path stays inside the
triangle of these three points: a clear triangle means a clear path.
"""

from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np
import numpy.typing as npt

from recon.geo.polygon import FARTHEST_M
from recon.model.arrays import FloatArray, IntArray

DEFAULT_CHORD_ERROR_M = 0.05
"""Far below GNSS accuracy, and a 1 km corner still takes only about a hundred points."""


@dataclass(frozen=True, slots=True, eq=False)
class Path:
    """A polyline: `points_m` (M, D) in the waypoints' own axes, M >= 1.

    `leg` (M - 1,) is the index of the waypoint at which each segment's leg starts; the first half
    of a corner belongs to the leg before, the second to the leg after. The exact path is nowhere
    farther than `chord_error_m` from the polyline.
    """

    points_m: FloatArray
    leg: IntArray
    chord_error_m: float

    @property
    def starts_m(self) -> FloatArray:
        """Where the segments start, (M - 1, D)."""
        return self.points_m[:-1]

    @property
    def ends_m(self) -> FloatArray:
        """Where the segments end, (M - 1, D)."""
        return self.points_m[1:]

    @property
    def length_m(self) -> float:
        """The polyline's length."""
        return float(np.linalg.norm(np.diff(self.points_m, axis=0), axis=1).sum())


def straight_path(waypoints_m: npt.ArrayLike) -> Path:
    """Return the legs between (N, D) waypoints, N >= 1, with no corner cut."""
    points = _waypoints(waypoints_m)
    return Path(points, np.arange(len(points) - 1), 0.0)


def rounded_path(
    waypoints_m: npt.ArrayLike,
    corner_radii_m: npt.ArrayLike,
    chord_error_m: float = DEFAULT_CHORD_ERROR_M,
) -> Path:
    """Return the path past (N, D) waypoints with corners cut by (N,) radii; both ends stay whole.

    Two corners that do not fit their leg share it in proportion to their radii: aircraft reject
    such a mission, but its drawing must still be connected. Points that are not finite or not on
    earth are not rounded and stay in the path, so that a fence rule refuses it.
    Raises `ValueError` for a chord error that is not positive, or when there is not one radius for
    each waypoint.
    """
    points = _waypoints(waypoints_m)
    radii = np.asarray(corner_radii_m, dtype=np.float64)
    if not chord_error_m > 0.0:
        raise ValueError(f"expected a chord error above 0 m, got {chord_error_m}")
    if radii.shape != (len(points),):
        raise ValueError(f"expected {len(points)} corner radii, got an array of {radii.shape}")
    # NaN compares as false, so that it is caught here as well.
    if not (np.abs(points).max() <= FARTHEST_M and np.abs(radii).max() <= FARTHEST_M):
        return straight_path(points)
    return _rounded(points, corner_reaches_m(points, radii), chord_error_m)


def corner_reaches_m(waypoints_m: FloatArray, corner_radii_m: FloatArray) -> FloatArray:
    """Return how far from its waypoint each corner starts and ends, (N,); 0 at both ends."""
    radii = np.maximum(corner_radii_m, 0.0)
    if len(radii) > 0:
        radii[[0, -1]] = 0.0
    lengths = np.linalg.norm(np.diff(waypoints_m, axis=0), axis=1)
    wanted = radii[:-1] + radii[1:]
    # Where two corners overlap, both shrink by the same factor.
    share = np.divide(lengths, wanted, out=np.ones_like(lengths), where=wanted > lengths)
    reaches = radii.copy()
    reaches[:-1] = np.minimum(reaches[:-1], radii[:-1] * share)
    reaches[1:] = np.minimum(reaches[1:], radii[1:] * share)
    return reaches


def corner_hulls(waypoints_m: FloatArray, corner_radii_m: FloatArray) -> FloatArray:
    """Return the triangles (N - 2, 3, D) that hold the corners at the inner of N waypoints.

    Apps interpret a corner radius in two ways: as the distance from the waypoint at which the
    corner starts, or as the radius of an arc tangent to both legs (which starts radius x tan(half
    the turn) before). The larger one is used, up to the whole of each leg. Each triangle is the
    start of the corner, its waypoint, and its end.
    """
    before, corner, after = waypoints_m[:-2], waypoints_m[1:-1], waypoints_m[2:]
    back, back_m = _units(before - corner)
    ahead, ahead_m = _units(after - corner)
    cosine = -(back * ahead).sum(axis=1)
    half_turn = np.sqrt(np.maximum(1.0 - cosine, 0.0) / np.maximum(1.0 + cosine, _REVERSAL))
    reach_m = corner_radii_m[1:-1] * np.maximum(1.0, half_turn)
    starts = corner + np.minimum(reach_m, back_m)[:, np.newaxis] * back
    ends = corner + np.minimum(reach_m, ahead_m)[:, np.newaxis] * ahead
    return np.stack([starts, corner, ends], axis=1)


_REVERSAL = 1e-12
"""Lower bound of 1 + the cosine of the turn: at a reversal the arc would be infinite."""


def _units(offsets: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return unit vectors (N, D), 0 for zero offsets, and lengths (N,)."""
    lengths = np.linalg.norm(offsets, axis=1)
    return offsets / np.where(lengths > 0.0, lengths, 1.0)[:, np.newaxis], lengths


def _rounded(points: FloatArray, reaches: FloatArray, chord_error_m: float) -> Path:
    pieces = [points[:1]]
    legs: list[IntArray] = []
    for index in range(1, len(points) - 1):
        corner = _corner(points[index - 1 : index + 2], float(reaches[index]), chord_error_m)
        pieces.append(corner)
        # The segments after the middle of the corner belong to the next leg.
        of_corner = np.arange(len(corner) - 1) >= (len(corner) - 1) / 2
        legs.append(np.concatenate([[index - 1], index - 1 + of_corner]))
    if len(points) > 1:
        pieces.append(points[-1:])
        legs.append(np.array([len(points) - 2]))
    leg = np.concatenate(legs).astype(np.int64) if legs else np.zeros(0, np.int64)
    return Path(np.concatenate(pieces), leg, chord_error_m)


def _corner(waypoints_m: FloatArray, reach_m: float, chord_error_m: float) -> FloatArray:
    """Return an odd number of points along the curve at the middle of three waypoints."""
    before, corner, after = waypoints_m[0], waypoints_m[1], waypoints_m[2]
    if reach_m <= 0.0:
        return waypoints_m[1:2]
    start = corner + reach_m * _unit(before - corner)
    end = corner + reach_m * _unit(after - corner)
    # n equal steps of the parameter leave a quadratic curve |start - 2 corner + end| / (4 n^2).
    bend_m = float(np.linalg.norm(start - 2.0 * corner + end))
    steps = max(1, ceil(sqrt(bend_m / (4.0 * chord_error_m))))
    share = np.linspace(0.0, 1.0, steps + steps % 2 + 1)[:, np.newaxis]
    curve: FloatArray = (
        (1.0 - share) ** 2 * start + 2.0 * share * (1.0 - share) * corner + share**2 * end
    )
    return curve


def _unit(offset: FloatArray) -> FloatArray:
    unit: FloatArray = offset / np.linalg.norm(offset)
    return unit


def _waypoints(waypoints_m: npt.ArrayLike) -> FloatArray:
    points = np.asarray(waypoints_m, dtype=np.float64)
    if points.ndim != 2 or len(points) == 0:
        raise ValueError(f"expected (N, 2) or (N, 3) waypoints, got an array of {points.shape}")
    return points
