"""A trajectory: where a vehicle will be and when, as rows of straight motion.

Each row is a straight piece of the way with a constant acceleration along it, a band of heights at
its start and end, and a disc's radius that grows evenly in time:

    share(t) = (1 / T - curve T) t + curve t^2,  T the row's duration

is how far along the row the vehicle is t seconds after its start.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from recon.model.arrays import FloatArray

FOREVER_S = 1.0e6
"""Time longer than any battery; times never go beyond, so that sums stay finite."""

ALL_HEIGHTS_M = 1.0e5
"""Band of a vehicle whose height is unknown: above and below every aircraft."""

(START_S, END_S, EAST_0, NORTH_0, EAST_1, NORTH_1, LOW_0, HIGH_0, LOW_1, HIGH_1) = range(10)
(RADIUS_0, RADIUS_1, CURVE, PART) = range(10, 14)
COLUMNS = 14

Row = tuple[float, ...]
"""One row's `COLUMNS`."""


class FlightPart(IntEnum):
    """What a vehicle does on a row that is no leg; legs are numbered from 0 up."""

    HOVERING = -1
    LANDING = -2
    CLIMBING_HOME = -3
    GOING_HOME = -4
    STOPPING = -5
    STEERED = -6
    GOING_TO = -7
    FREE = -8
    HAZARD = -9


_WORDS = {
    FlightPart.HOVERING: "while it hovers",
    FlightPart.LANDING: "while it lands",
    FlightPart.CLIMBING_HOME: "while it climbs to go home",
    FlightPart.GOING_HOME: "returning home",
    FlightPart.STOPPING: "while it stops",
    FlightPart.STEERED: "under the sticks",
    FlightPart.GOING_TO: "on its way to its target",
    FlightPart.FREE: "under manual control",
    FlightPart.HAZARD: "in its hazard area",
}


def part_text(part: int) -> str:
    """Return where on its way a vehicle is, in words; leg 0 leads to the first waypoint."""
    if part > 0:
        return f"between waypoints {part} and {part + 1}"
    return "on its way to the first waypoint" if part == 0 else _WORDS[FlightPart(part)]


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """A vehicle's trajectory. `rows` is (N, 14), in order of time and without gaps, times in
    seconds
    from now, east and north in the plane, heights as up metres of the site's frame. All of it may
    be flown later by `delay_s`: a mission that has not begun. `here_m` are the two heights between
    of its last telemetry; on its first row it may be higher or lower by then."""

    name: str
    rows: FloatArray
    here_m: tuple[float, float]
    delay_s: float = 0.0


class TrajectoryWriter:
    """Writes a trajectory row after row from where a vehicle is."""

    def __init__(self, east_m: float, north_m: float, low_m: float, high_m: float) -> None:
        self.east_m, self.north_m = east_m, north_m
        self.low_m, self.high_m = self.here_m = low_m, high_m
        self.time_s = 0.0
        self.radius_m = 0.0
        self.rows: list[Row] = []

    def moves(
        self,
        east_m: float,
        north_m: float,
        seconds: float,
        part: int,
        *,
        curve: float = 0.0,
        band_m: tuple[float, float] | None = None,
        radius_m: float | None = None,
    ) -> None:
        """Go straight to a place within this time; the heights and the radius are its end's."""
        low_m, high_m = band_m or (self.low_m, self.high_m)
        end_s = min(self.time_s + seconds, FOREVER_S)
        radius_1_m = self.radius_m if radius_m is None else radius_m
        start = self.time_s, end_s, self.east_m, self.north_m, east_m, north_m
        bands = self.low_m, self.high_m, low_m, high_m
        self.rows.append((*start, *bands, self.radius_m, radius_1_m, curve, part))
        self.east_m, self.north_m, self.low_m, self.high_m = east_m, north_m, low_m, high_m
        self.time_s, self.radius_m = end_s, radius_1_m

    def waits(self, seconds: float, part: int) -> None:
        """Stay for a while."""
        self.moves(self.east_m, self.north_m, seconds, part)

    def grows(self, radius_m: float, seconds: float, part: int) -> None:
        """Stay, anywhere within a disc that grows to this radius."""
        self.moves(self.east_m, self.north_m, seconds, part, radius_m=radius_m)

    def widens(self, low_m: float, high_m: float) -> None:
        """Allow any height between these and the present ones from here on."""
        self.low_m, self.high_m = min(self.low_m, low_m), max(self.high_m, high_m)

    def stays(self, part: int) -> None:
        """Stay indefinitely."""
        self.waits(FOREVER_S, part)

    def trajectory(self, name: str, drift_m: float = 0.0) -> Trajectory:
        """Return what has been written, at least one row, its heights uncertain by a drift."""
        rows = np.array(self.rows)
        rows[:, [LOW_0, LOW_1]] -= drift_m
        rows[:, [HIGH_0, HIGH_1]] += drift_m
        return Trajectory(name, rows, (self.here_m[0] - drift_m, self.here_m[1] + drift_m))


_APART_S = 4.0 * FOREVER_S
"""Vehicles' times are placed one behind the other on one axis, this far apart."""


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """V vehicles at K moments: each array is (V, K), metres in the plane and up."""

    east_m: FloatArray
    north_m: FloatArray
    low_m: FloatArray
    high_m: FloatArray
    radius_m: FloatArray


def sample(trajectories: Sequence[Sequence[Row] | FloatArray], times_s: npt.ArrayLike) -> Samples:
    """Return where each trajectory's vehicle is at (K,) moments; before and after it, at its ends.

    No trajectory may be without a row.
    """
    times = np.asarray(times_s)
    rows = np.array([row for trajectory in trajectories for row in trajectory])
    counts = np.array([len(trajectory) for trajectory in trajectories])
    vehicle = np.repeat(np.arange(len(trajectories)), counts)
    axis = rows[:, START_S] + vehicle * _APART_S
    asked = times[np.newaxis, :] + np.arange(len(trajectories))[:, np.newaxis] * _APART_S
    first = np.cumsum(counts) - counts
    index = np.searchsorted(axis, asked, side="right") - 1
    found = rows[np.maximum(index, first[:, np.newaxis])]
    return _at(found, times)


def _at(found: FloatArray, times: FloatArray) -> Samples:
    lasts_s = np.maximum(found[..., END_S] - found[..., START_S], 1e-9)
    gone_s = np.clip(times - found[..., START_S], 0.0, lasts_s)
    in_time = gone_s / lasts_s
    curve = found[..., CURVE]
    share = (1.0 / lasts_s - curve * lasts_s) * gone_s + curve * gone_s**2

    def between(start: int, end: int, at: FloatArray) -> FloatArray:
        value: FloatArray = found[..., start] + at * (found[..., end] - found[..., start])
        return value

    return Samples(
        east_m=between(EAST_0, EAST_1, share),
        north_m=between(NORTH_0, NORTH_1, share),
        low_m=between(LOW_0, LOW_1, share),
        high_m=between(HIGH_0, HIGH_1, share),
        radius_m=between(RADIUS_0, RADIUS_1, in_time),
    )
