"""The way right ahead of every vehicle: as far as it may still go when it is stopped, and more."""

from dataclasses import dataclass
from math import hypot

import numpy as np
import numpy.typing as npt

from recon.geo import Footprints
from recon.model.geo import LatLon, LocalFrame
from recon.safety.datum import places_m
from recon.safety.prediction.course import FloatArray
from recon.safety.prediction.flyer import last_place
from recon.safety.watchdogs.picture import Picture

BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.int64]

NEAR_HOME_M = 15.0
"""Takeoffs and landings are low by nature: a vehicle this near to its home is on one."""


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """For N vehicles: where they are and will be, (N, 2) in the site's frame, and the heights
    between, (N,) up metres. `ahead` are the hulls of the ways, from (N, 3, 2) `triangles_m`."""

    here_m: FloatArray
    there_m: FloatArray
    triangles_m: FloatArray
    ahead: Footprints
    low_m: FloatArray
    high_m: FloatArray
    is_near_home: BoolArray


def way_ahead(picture: Picture, frame: LocalFrame) -> Way:
    """Return the ways of a picture's flying vehicles, of which there must be one.

    Each is flown in `fence_factor` times the time in which its speed covers its stopping distance.
    """
    flyers = [watched.flyer for watched in picture.flying]
    speeds = np.array([0.0 if flyer is None else flyer.speed_mps for flyer in flyers])
    prediction, times_s = picture.prediction, picture.ahead.times_s
    stop_s = prediction.reaction_s + speeds / (2.0 * prediction.braking_mps2)
    last = np.searchsorted(times_s, np.minimum(picture.settings.fence_factor * stop_s, times_s[-1]))
    here_m = places_m(frame, [_place(picture, number) for number in range(len(flyers))])
    last_known_m = np.array([(f.east_m, f.north_m) if f else (0.0, 0.0) for f in flyers])
    at_m = _at_m(picture, np.stack([np.zeros_like(last), (last + 1) // 2, last], axis=1))
    # Exact where the vehicles were heard, and from there on in the plane, which is exact enough.
    triangles_m = here_m[:, np.newaxis] + at_m - last_known_m[:, np.newaxis]
    flies, rows = picture.ahead.as_it_flies, np.arange(len(flyers))
    return Way(
        here_m=triangles_m[:, 0],
        there_m=triangles_m[:, 2],
        triangles_m=triangles_m,
        ahead=Footprints(triangles_m),
        low_m=np.minimum(flies.low_m[rows, 0], flies.low_m[rows, last]),
        high_m=np.maximum(flies.high_m[rows, 0], flies.high_m[rows, last]),
        is_near_home=_is_near_home(picture),
    )


def _place(picture: Picture, number: int) -> LatLon:
    place, _at_ns = last_place(picture.flying[number].state)
    assert place is not None, "a vehicle that is heard flying has told where it is"
    return place


def _at_m(picture: Picture, index: IntArray) -> FloatArray:
    """Where each vehicle is at M of the moments (N, M): (N, M, 2) in the plane."""
    flies, rows = picture.ahead.as_it_flies, np.arange(len(index))[:, np.newaxis]
    return np.stack([flies.east_m[rows, index], flies.north_m[rows, index]], axis=2)


def _is_near_home(picture: Picture) -> BoolArray:
    near = []
    for watched in picture.flying:
        flyer = watched.flyer
        home_m = None if flyer is None else flyer.home_m
        if flyer is None or home_m is None:
            near.append(False)
            continue
        far_m = hypot(flyer.east_m - home_m[0], flyer.north_m - home_m[1])
        near.append(far_m <= NEAR_HOME_M)
    return np.array(near, dtype=np.bool_)
