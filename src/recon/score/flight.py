"""A vehicle's way in time: hops one after the other, each worked out when it was begun."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil
from typing import Protocol

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

Spot = tuple[float, float, float]
"""East, north of the site, height above takeoff, in metres."""


class Motion(Protocol):
    """How far along a straight hop a vehicle is."""

    @property
    def way_m(self) -> float:
        """From its start to its end."""
        ...

    @property
    def phases_s(self) -> Sequence[float]:
        """How long it moves in each way: evenly, or speeding up, or slowing down."""
        ...

    def along_m(self, after_s: FloatArray) -> FloatArray:
        """Return how far along it is at times after its start, (N,)."""
        ...


@dataclass(frozen=True, slots=True)
class Steady:
    """Even motion."""

    way_m: float
    duration_s: float

    @property
    def phases_s(self) -> Sequence[float]:
        """There is one."""
        return (self.duration_s,)

    def along_m(self, after_s: FloatArray) -> FloatArray:
        """Return how far along it is at times after its start, (N,)."""
        share: FloatArray = np.minimum(np.maximum(after_s / self.duration_s, 0.0), 1.0)
        return self.way_m * share


@dataclass(frozen=True, slots=True)
class Hop:
    """A straight way in time, or a wait; one cut short by an earlier `end_s` stays where it was."""

    start_s: float
    end_s: float
    start_m: Spot
    end_m: Spot
    motion: Motion | None
    """None: it stays where it is."""
    load: float
    """Of the battery, in hovering."""
    waypoint: int | None = None
    """The one of its mission whose stop is over when this has ended."""
    is_row: bool = False
    """Between two waypoints that images are taken between."""
    lands: bool = False
    """On the ground from its end on."""

    def places_m(self, at_s: FloatArray) -> FloatArray:
        """Return where the vehicle is at times, (N, 3) east, north, up; outside: at the ends."""
        start, end = np.array(self.start_m), np.array(self.end_m)
        if self.motion is None or self.motion.way_m <= 0.0:
            return np.repeat(start[np.newaxis], len(at_s), axis=0)
        along_m = self.motion.along_m(np.minimum(at_s, self.end_s) - self.start_s)
        places: FloatArray = start + (along_m / self.motion.way_m)[:, np.newaxis] * (end - start)
        return places

    def samples_s(self, every_s: float) -> FloatArray:
        """Return times from start to end, at most so far apart, one wherever the motion changes."""
        if self.motion is None:
            return np.array([self.start_s, self.end_s])
        parts = [np.array([self.start_s])]
        begin_s = self.start_s
        for lasts_s in self.motion.phases_s:
            end_s = min(begin_s + lasts_s, self.end_s)
            count = ceil((end_s - begin_s) / every_s)
            if count == 0:
                continue
            part = begin_s + (end_s - begin_s) / count * np.arange(1, count + 1)
            part[-1] = begin_s = end_s
            parts.append(part)
        return np.concatenate(parts)


def whereabouts(hops: Sequence[Hop], at_s: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return where a vehicle is at rising times, (N, 3), and whether it is in the air, (N,).

    NaN before its first hop.
    """
    places = np.full((len(at_s), 3), np.nan)
    in_air = np.zeros(len(at_s), dtype=np.bool_)
    starts_s = np.array([hop.start_s for hop in hops])
    which = np.searchsorted(starts_s, at_s, side="right") - 1
    firsts = np.flatnonzero(np.diff(which, prepend=-2)).tolist()
    for first, after in pairwise([*firsts, len(at_s)]):
        if which[first] < 0:
            continue
        hop, now_s = hops[int(which[first])], at_s[first:after]
        places[first:after] = hop.places_m(now_s)
        in_air[first:after] = ~(hop.lands & (now_s >= hop.end_s))
    return places, in_air
