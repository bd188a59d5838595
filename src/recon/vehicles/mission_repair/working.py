"""A mission under repair: its waypoints with the numbers they came with."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import hypot, inf
from typing import Any

from recon.geo.distance import horizontal_distance_m
from recon.model.geo import LatLon
from recon.model.mission import Waypoint


@dataclass(frozen=True, slots=True)
class Numbered:
    """A waypoint and its number in the mission as it was ordered; an inserted one has the number
    of the waypoint before it, and is told to be new."""

    waypoint: Waypoint
    number: int
    is_new: bool = False

    def with_(self, **changes: Any) -> "Numbered":
        """Return it with its waypoint changed."""
        return replace(self, waypoint=replace(self.waypoint, **changes))

    def distance_m(self, other: "Numbered") -> float:
        """Return the 3D distance, measured from this one."""
        return distance_m(self.waypoint, other.waypoint)


def distance_m(a: Waypoint, b: Waypoint) -> float:
    """Return the 3D distance between two waypoints, in metres, measured from `a`."""
    across_m = horizontal_distance_m(
        LatLon(a.latitude_deg, a.longitude_deg), LatLon(b.latitude_deg, b.longitude_deg)
    )
    return hypot(across_m, b.height_above_takeoff_m - a.height_above_takeoff_m)


def as_sent(value: float) -> float:
    """Return the number that a 32-bit float of the wire makes of it: what is tiny becomes 0."""
    try:
        return float(struct.unpack(">f", struct.pack(">f", value))[0])
    except OverflowError:
        return inf


def listed(numbers: Iterator[int] | list[int]) -> str:
    """Return waypoint numbers as people read them: `3`, `3 and 4`, `3 to 7, 9`."""
    runs: list[list[int]] = []
    for number in sorted(set(numbers)):
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    words = [_run(run) for run in runs]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def _run(run: list[int]) -> str:
    if len(run) <= 2:
        return " and ".join(str(number) for number in run)
    return f"{run[0]} to {run[-1]}"


def waypoints(numbers: list[int]) -> str:
    """Return `waypoint 3` or `waypoints 3 to 7`."""
    word = "waypoint" if len(set(numbers)) == 1 else "waypoints"
    return f"{word} {listed(numbers)}"
