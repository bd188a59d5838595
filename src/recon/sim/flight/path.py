"""A curved mission's path: straight legs joined by quadratic curves, with the speed along it.

The path is densely sampled: following, speed limits and braking are then three short loops.
`CornerRadius` (ICD 3.2.3) is the distance before its waypoint at which the path leaves the leg, and
after it at which it joins the next, as in `geo.path`. This reading fits the SDK's rule that the
radii of two neighbours must add to less than their distance, at any angle.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, inf, sqrt

import numpy as np

from recon.geo.path import corner_reaches_m
from recon.model.arrays import FloatArray
from recon.sim.flight.kinematics import Limits

SPACING_M = 0.5
SIDEWAYS_SHARE = 0.6
"""Share of the acceleration used in curves; the rest is for speed changes and steering."""
SHARPEST = 0.1
"""Tangent length, relative, under which a curve doubles back on itself: flown at least speed."""
LEAST_SPEED_MPS = 0.5
"""Tight corners are flown slowly rather than stopped at."""


@dataclass(frozen=True, slots=True)
class Corner:
    """One waypoint in home metres; `speed_mps` applies from here to the next."""

    north_m: float
    east_m: float
    height_m: float
    radius_m: float
    speed_mps: float


@dataclass(frozen=True, slots=True)
class PathPlace:
    """A point on a path, the unit direction along it, and the speed there."""

    point_m: tuple[float, float, float]
    direction: tuple[float, float, float]
    speed_mps: float


@dataclass(frozen=True, slots=True, eq=False)
class FlightPath:
    """Samples of a path: `points_m` (N, 3) north, east, height; `speeds_mps` (N,), 0 at both ends.

    `along_m` (N,) is each sample's distance along the path.
    """

    points_m: FloatArray
    speeds_mps: FloatArray
    along_m: FloatArray

    @property
    def length_m(self) -> float:
        """Total length."""
        return float(self.along_m[-1])

    def place_at(self, along_m: float) -> PathPlace:
        """Return the place at a distance along the path, clamped to its ends."""
        after = int(np.searchsorted(self.along_m, along_m, side="right"))
        after = max(1, min(after, len(self.along_m) - 1))
        start, end = self.points_m[after - 1], self.points_m[after]
        length = max(1e-9, float(self.along_m[after] - self.along_m[after - 1]))
        share = max(0.0, min(1.0, (along_m - float(self.along_m[after - 1])) / length))
        north, east, height = (float(v) for v in start + share * (end - start))
        to_north, to_east, to_up = (float(v) / length for v in end - start)
        slower, faster = self.speeds_mps[after - 1], self.speeds_mps[after]
        speed = float(slower + share * (faster - slower))
        return PathPlace((north, east, height), (to_north, to_east, to_up), speed)


def rounded_path(corners: Sequence[Corner], limits: Limits) -> FlightPath:
    """Return the path past at least two corners, flown within the airframe's limits."""
    waypoints = np.array([_point(corner) for corner in corners])
    reaches = corner_reaches_m(waypoints, np.array([corner.radius_m for corner in corners]))
    points = [waypoints[0]]
    speeds = [corners[0].speed_mps]
    for index in range(1, len(corners) - 1):
        speed_mps = corners[index - 1].speed_mps
        curve = _curve(waypoints[index - 1 : index + 2], float(reaches[index]), limits)
        _extend(points, speeds, curve[0][0], speed_mps)
        for point, limit in curve:
            points.append(point)
            speeds.append(min(limit, speed_mps))
    _extend(points, speeds, waypoints[-1], corners[-2].speed_mps)
    samples = np.array(points)
    steps = np.linalg.norm(np.diff(samples, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    return FlightPath(samples, _within_limits(samples, np.array(speeds), limits), along)


def _point(corner: Corner) -> FloatArray:
    return np.array([corner.north_m, corner.east_m, corner.height_m])


def _extend(
    points: list[FloatArray], speeds: list[float], target: FloatArray, speed_mps: float
) -> None:
    """Append samples from the last point to `target`."""
    start = points[-1]
    count = max(1, ceil(float(np.linalg.norm(target - start)) / SPACING_M))
    for k in range(1, count + 1):
        points.append(start + (target - start) * (k / count))
        speeds.append(speed_mps)


def _curve(waypoints: FloatArray, reach_m: float, limits: Limits) -> list[tuple[FloatArray, float]]:
    """Return points of the curve that cuts a corner, each with its speed limit."""
    corner = waypoints[1]
    back, ahead = _unit(waypoints[0] - corner), _unit(waypoints[2] - corner)
    # A sharp corner: one point, with the least speed the turn allows.
    if reach_m < 1e-6:
        return [(corner, _speed_round(back, ahead, 0.5, 1e-6, limits))]
    start, end = corner + reach_m * back, corner + reach_m * ahead
    count = max(2, ceil(2.0 * reach_m / SPACING_M))
    curve = []
    for k in range(count + 1):
        t = k / count
        point = (1.0 - t) ** 2 * start + 2.0 * t * (1.0 - t) * corner + t**2 * end
        curve.append((point, _speed_round(back, ahead, t, reach_m, limits)))
    return curve


def _speed_round(
    back: FloatArray, ahead: FloatArray, t: float, reach_m: float, limits: Limits
) -> float:
    """Return the speed at which the curve at `t` uses its share of the acceleration."""
    # The derivative at t is 2 reach (t ahead - (1 - t) back); its length and the constant cross
    # product with the second derivative give the curvature.
    tangent = t * ahead - (1.0 - t) * back
    length = float(np.linalg.norm(tangent))
    if length < SHARPEST:
        return LEAST_SPEED_MPS
    bend = float(np.linalg.norm(np.cross(back, ahead)))
    curvature = bend / (2.0 * reach_m * length**3)
    if curvature < 1e-9:
        return inf
    return max(LEAST_SPEED_MPS, sqrt(SIDEWAYS_SHARE * limits.acceleration_mps2 / curvature))


def _unit(offset: FloatArray) -> FloatArray:
    unit: FloatArray = offset / max(1e-9, float(np.linalg.norm(offset)))
    return unit


def _within_limits(points: FloatArray, wanted_mps: FloatArray, limits: Limits) -> FloatArray:
    """Return speeds (N,) from rest to rest that keep the vertical and acceleration limits."""
    steps = np.diff(points, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    slopes = np.abs(steps[:, 2]) / np.maximum(lengths, 1e-9)
    steepest = 0.8 * min(limits.climb_mps, limits.descent_mps)
    speeds = wanted_mps.copy()
    speeds[:-1] = np.minimum(speeds[:-1], steepest / np.maximum(slopes, 1e-9))
    # v^2 = v0^2 + 2 a s with half the acceleration: the rest is for turning and path correction.
    speeds[0] = speeds[-1] = 0.0
    # Backward pass: never faster than braking allows. Forward pass: the same for acceleration.
    for i in range(len(speeds) - 2, -1, -1):
        braked = sqrt(speeds[i + 1] ** 2 + limits.acceleration_mps2 * lengths[i])
        speeds[i] = min(speeds[i], braked)
    for i in range(len(speeds) - 1):
        gained = sqrt(speeds[i] ** 2 + limits.acceleration_mps2 * lengths[i])
        speeds[i + 1] = min(speeds[i + 1], gained)
    return speeds
