"""A vehicle's way in time, worked out leg by leg when it gets an order."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, hypot

import numpy as np
import numpy.typing as npt

from recon.score.legs import Leg, leg
from recon.score.scenario import Place
from recon.score.settings import FlightSettings

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Hop:
    """One leg in time; a hover and a climb are legs from a place to the same."""

    start_s: float
    end_s: float
    start_m: Place
    end_m: Place
    motion: Leg | None
    """None: it stays where it is."""
    load: float
    """Of the battery, in hovering."""
    is_level: bool = True
    """At the survey's height."""
    ends_level: bool = True
    """And so from its end until the next one; False after a landing."""
    is_row: bool = False
    """A leg of a mission after its first waypoint, on which the camera's timer counts."""

    def places_m(self, at_s: FloatArray) -> FloatArray:
        """Return where the vehicle is at times, (N, 2) east-north; outside: at the ends.

        `end_m` is where it was to go; one cut short by an earlier `end_s` stays where it was then.
        """
        start, end = np.array(self.start_m), np.array(self.end_m)
        if self.motion is None or self.motion.length_m == 0.0:
            return np.repeat(start[np.newaxis], len(at_s), axis=0)
        along_m = self.motion.along_m(np.minimum(at_s, self.end_s) - self.start_s)
        places: FloatArray = start + (along_m / self.motion.length_m)[:, np.newaxis] * (end - start)
        return places

    def samples_s(self, every_s: float) -> FloatArray:
        """Return evenly spaced times from start to end, at most so far apart."""
        count = max(1, ceil((self.end_s - self.start_s) / every_s))
        return np.linspace(self.start_s, self.end_s, count + 1)


def fly(
    start_s: float,
    places_m: list[Place],
    speed_mps: float,
    load: float,
    settings: FlightSettings,
    rows_from: int | None = None,
) -> list[Hop]:
    """Return the hops over places, stopping at each; from the `rows_from`th on they are rows."""
    hops: list[Hop] = []
    for index in range(len(places_m) - 1):
        a, b = places_m[index], places_m[index + 1]
        length_m = hypot(b[0] - a[0], b[1] - a[1])
        motion = leg(length_m, speed_mps, settings)
        is_row = rows_from is not None and index >= rows_from
        end_s = start_s + motion.duration_s
        hops.append(Hop(start_s, end_s, a, b, motion, load, is_row=is_row))
        start_s = hops[-1].end_s
    return hops


def climb(start_s: float, seconds: float, at_m: Place, load: float) -> Hop:
    """Return a takeoff and climb to the survey's height."""
    return Hop(start_s, start_s + seconds, at_m, at_m, None, load, is_level=False)


def land(start_s: float, seconds: float, at_m: Place) -> Hop:
    """Return a descent and landing."""
    end_s = start_s + seconds
    return Hop(start_s, end_s, at_m, at_m, None, 1.0, is_level=False, ends_level=False)


def whereabouts(hops: Sequence[Hop], at_s: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return where a vehicle is at rising times, (N, 2), and whether it is at the height, (N,).

    NaN before its first hop.
    """
    places = np.full((len(at_s), 2), np.nan)
    is_level = np.zeros(len(at_s), dtype=np.bool_)
    starts_s = np.array([hop.start_s for hop in hops])
    which = np.searchsorted(starts_s, at_s, side="right") - 1
    for index in np.unique(which[which >= 0]):
        hop, now = hops[int(index)], which == index
        places[now] = hop.places_m(at_s[now])
        is_level[now] = np.where(at_s[now] < hop.end_s, hop.is_level, hop.ends_level)
    return places, is_level
