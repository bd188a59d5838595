"""A mission that rounds its corners, worked out at once: the simulator's path, and its times."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from recon.score.flight import Spot
from recon.sim.flight.kinematics import Limits
from recon.sim.flight.mission import LEAST_PATH_SPEED_MPS
from recon.sim.flight.path import Corner, FlightPath, rounded_path

FloatArray = npt.NDArray[np.float64]

STRAIGHT = 0.99999
"""Cosine between two pieces of the path that are one."""
PIECE_M = 0.05
"""Between two places at which the speed is looked up: it starts and ends at a crawl."""


@dataclass(frozen=True, slots=True)
class Timed:
    """Motion along a straight part of a path: `after_m` (N,) at `after_s` (N,)."""

    after_s: FloatArray
    after_m: FloatArray

    @property
    def way_m(self) -> float:
        """From its start to its end."""
        return float(self.after_m[-1])

    @property
    def duration_s(self) -> float:
        """From its start to its end."""
        return float(self.after_s[-1])

    @property
    def phases_s(self) -> Sequence[float]:
        """Its speed changes all the time."""
        return (self.duration_s,)

    def along_m(self, after_s: FloatArray) -> FloatArray:
        """Return how far along it is at times after its start, (N,)."""
        return np.interp(after_s, self.after_s, self.after_m)


def curved(corners: Sequence[Corner], limits: Limits) -> Iterator[tuple[Spot, Timed]]:
    """Yield the straight parts of the path past corners: where each ends, and how it is flown."""
    path = rounded_path(corners, limits)
    at_s = _times_s(path)
    ahead = np.diff(path.points_m, axis=0)
    ahead /= np.maximum(np.linalg.norm(ahead, axis=1), 1e-9)[:, np.newaxis]
    turns = np.flatnonzero((ahead[1:] * ahead[:-1]).sum(axis=1) < STRAIGHT) + 1
    ends = [0, *turns.tolist(), len(path.points_m) - 1]
    for first, last in pairwise(ends):
        part = slice(first, last + 1)
        north_m, east_m, up_m = path.points_m[last].tolist()
        after = at_s[part] - at_s[first], path.along_m[part] - path.along_m[first]
        yield (east_m, north_m, up_m), Timed(*after)


def _times_s(path: FlightPath) -> FloatArray:
    """Return when each sample of a path is passed, (N,)."""
    count = max(2, round(path.length_m / PIECE_M))
    along_m = np.linspace(0.0, path.length_m, count)
    speeds_mps = np.interp(along_m, path.along_m, path.speeds_mps)
    slowness = 1.0 / np.maximum(speeds_mps, LEAST_PATH_SPEED_MPS)
    steps_s = 0.5 * (slowness[1:] + slowness[:-1]) * np.diff(along_m)
    times_s: FloatArray = np.interp(
        path.along_m, along_m, np.concatenate([[0.0], np.cumsum(steps_s)])
    )
    return times_s
