"""A course: where a vehicle will be and when, as rows of straight motion.

Each row is a straight piece of the way with a constant acceleration along it, a band of heights at
its start and end, and a disc's radius that grows evenly in time:

    share(t) = (1 / T - curve T) t + curve t^2,  T the row's duration

is how far along the row the vehicle is t seconds after its start.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

FOREVER_S = 1.0e6
"""Longer than any battery; times never go beyond, so that sums stay finite."""

ALL_HEIGHTS_M = 1.0e5
"""Above and below every aircraft: the band of one whose height nobody knows."""

(START_S, END_S, EAST_0, NORTH_0, EAST_1, NORTH_1, LOW_0, HIGH_0, LOW_1, HIGH_1) = range(10)
(RADIUS_0, RADIUS_1, CURVE, PART) = range(10, 14)
COLUMNS = 14

Row = tuple[float, ...]
"""One row's `COLUMNS`."""


class Part(IntEnum):
    """What a vehicle does on a row that is no leg; legs are numbered from 0 up."""

    HOVERING = -1
    LANDING = -2
    CLIMBING_HOME = -3
    GOING_HOME = -4
    STOPPING = -5
    STEERED = -6
    GOING_TO = -7
    FREE = -8
    UNSEEN = -9


_WORDS = {
    Part.HOVERING: "while it hovers",
    Part.LANDING: "while it lands",
    Part.CLIMBING_HOME: "while it climbs to go home",
    Part.GOING_HOME: "on its way home",
    Part.STOPPING: "while it stops",
    Part.STEERED: "under the sticks",
    Part.GOING_TO: "on its way to its target",
    Part.FREE: "wherever it is flown by hand",
    Part.UNSEEN: "anywhere about the place it was last heard from",
}


def part_words(part: int) -> str:
    """Return where on its way a vehicle is, in words; leg 0 leads to the first waypoint."""
    if part > 0:
        return f"between waypoints {part} and {part + 1}"
    return "on its way to the first waypoint" if part == 0 else _WORDS[Part(part)]


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """A vehicle's course. `rows` is (N, 14), in order of time and without gaps, times in seconds
    from now, east and north in the plane, heights as up metres of the site's frame. All of it may
    be flown later by `delay_s`: a mission that has not begun. `here_m` are the two heights between
    which it was last heard; on its first row it may be higher or lower by then."""

    name: str
    serial: str | None
    rows: FloatArray
    here_m: tuple[float, float]
    delay_s: float = 0.0


class CourseWriter:
    """Writes a course row after row from where a vehicle is."""

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
        """From here on be anywhere between these heights and the present ones."""
        self.low_m, self.high_m = min(self.low_m, low_m), max(self.high_m, high_m)

    def stays(self, part: int) -> None:
        """Stay for ever."""
        self.waits(FOREVER_S, part)

    def course(self, name: str, serial: str | None) -> Course:
        """Return what has been written."""
        rows = np.array(self.rows, dtype=np.float64).reshape(-1, COLUMNS)
        return Course(name, serial, rows, self.here_m)
