"""A curved mission's path: straight legs joined by arcs, and how fast it may be flown.

The path is held as dense samples, because following, speed limits and braking are then three short
loops. Corners are rounded as the ICD says (3.2.3): `CornerRadius` is the radius of the arc.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import acos, ceil, cos, hypot, inf, sin, sqrt, tan

import numpy as np
import numpy.typing as npt

from recon.sim.kinematics import Limits

FloatArray = npt.NDArray[np.float64]

SPACING_M = 0.5
SHARPEST_FULL_TURN_RAD = 2.6
LEAST_SPEED_MPS = 0.5
"""Tight corners are crept through rather than stopped at."""


@dataclass(frozen=True, slots=True)
class Corner:
    """One waypoint in home metres; `speed_mps` holds from here to the next."""

    north_m: float
    east_m: float
    height_m: float
    radius_m: float
    speed_mps: float


@dataclass(frozen=True, slots=True)
class PathPlace:
    """A place on a path: its point, the unit direction onwards, how fast it is flown."""

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
        """From end to end."""
        return float(self.along_m[-1])

    def place_at(self, along_m: float) -> PathPlace:
        """Return the place at a distance along the path, within its ends."""
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
    points = [_point(corners[0])]
    speeds = [corners[0].speed_mps]
    for index in range(1, len(corners) - 1):
        before, corner, after = corners[index - 1 : index + 2]
        arc = _arc(before, corner, after, limits.acceleration_mps2)
        _extend(points, speeds, arc[0][0], before.speed_mps)
        for point, limit in arc:
            _extend(points, speeds, point, min(limit, before.speed_mps))
    _extend(points, speeds, _point(corners[-1]), corners[-2].speed_mps)
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


def _arc(
    before: Corner, corner: Corner, after: Corner, acceleration_mps2: float
) -> list[tuple[FloatArray, float]]:
    """Return points of the arc that rounds a corner, each with the speed it can be flown at."""
    incoming, length_in = _direction(before, corner)
    outgoing, length_out = _direction(corner, after)
    turn = acos(max(-1.0, min(1.0, float(incoming[:2] @ outgoing[:2]))))
    if turn < 1e-3 or min(length_in, length_out) < 1e-6:
        return [(_point(corner), inf)]
    # The arc may use half of each leg, and a near reversal would use far more than it is worth:
    # what does not fit gets a smaller radius.
    tangent_m = min(
        corner.radius_m * tan(min(turn, SHARPEST_FULL_TURN_RAD) / 2.0),
        length_in / 2.0,
        length_out / 2.0,
    )
    radius_m = tangent_m / tan(min(turn, 3.14) / 2.0)
    start, end = _point(corner) - incoming * tangent_m, _point(corner) + outgoing * tangent_m
    limit = max(LEAST_SPEED_MPS, sqrt(0.6 * acceleration_mps2 * radius_m))
    count = max(2, ceil(radius_m * turn / SPACING_M))
    shares = (k / count for k in range(count + 1))
    return [(_on_arc(start, end, incoming, outgoing, turn, share), limit) for share in shares]


def _on_arc(
    start: FloatArray,
    end: FloatArray,
    incoming: FloatArray,
    outgoing: FloatArray,
    turn: float,
    share: float,
) -> FloatArray:
    """Return the arc's point at `share` of its turn: tangent to both legs."""
    # Along the first tangent the arc advances r sin(a), across it r (1 - cos(a)).
    angle = share * turn
    chord = end[:2] - start[:2]
    radius = float(np.linalg.norm(chord)) / (2.0 * sin(turn / 2.0))
    across = outgoing[:2] - incoming[:2] * cos(turn)
    across = across / max(1e-12, float(np.linalg.norm(across)))
    plane = start[:2] + radius * (incoming[:2] * sin(angle) + across * (1.0 - cos(angle)))
    return np.array([plane[0], plane[1], start[2] + share * (end[2] - start[2])])


def _direction(a: Corner, b: Corner) -> tuple[FloatArray, float]:
    """Return the step per horizontal metre from a to b, and the horizontal distance."""
    length = hypot(b.north_m - a.north_m, b.east_m - a.east_m)
    return (_point(b) - _point(a)) / max(length, 1e-9), length


def _within_limits(points: FloatArray, wanted_mps: FloatArray, limits: Limits) -> FloatArray:
    """Return speeds that can be reached from rest, keep the vertical limits, and end at rest."""
    steps = np.diff(points, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    slopes = np.abs(steps[:, 2]) / np.maximum(lengths, 1e-9)
    steepest = 0.8 * min(limits.climb_mps, limits.descent_mps)
    speeds = wanted_mps.copy()
    speeds[:-1] = np.minimum(speeds[:-1], steepest / np.maximum(slopes, 1e-9))
    # Half of the acceleration is left for turning and for coming back to the path.
    speeds[0] = speeds[-1] = 0.0
    for i in range(len(speeds) - 2, -1, -1):
        braked = sqrt(speeds[i + 1] ** 2 + limits.acceleration_mps2 * lengths[i])
        speeds[i] = min(speeds[i], braked)
    for i in range(len(speeds) - 1):
        gained = sqrt(speeds[i] ** 2 + limits.acceleration_mps2 * lengths[i])
        speeds[i + 1] = min(speeds[i + 1], gained)
    return speeds
