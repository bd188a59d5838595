"""Flight lines of one camera's photos, and neighbours in them that show enough common ground."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import radians, tan

import numpy as np

from recon.model.arrays import IntArray
from recon.product.registration.match import Places
from recon.product.timing import TimedPhoto

STEP_SHARE = 0.3
"""Of the ground along the shorter side, between two photos that are compared: a nearer one tells
less about direction, a farther one shows less common ground."""
LEAST_COMMON = 0.25
"""Share of the shorter side that two photos must both show."""
TURN_DEG = 30.0
"""Within a flight line the course changes less from photo to photo."""
RUN = 4
"""Photos of a run: three links, along a photo's length."""


@dataclass(frozen=True, slots=True, eq=False)
class FlightLine:
    """Photos of one line: all of them, and those that are a step apart, by index."""

    photos: IntArray
    steps: IntArray

    def runs(self) -> list[IntArray]:
        """Return the line in runs of neighbours; a run begins where the one before ends."""
        count = max(1, round((len(self.steps) - 1) / (RUN - 1)))
        ends = np.rint(np.linspace(0, len(self.steps) - 1, count + 1)).astype(np.int64)
        return [self.steps[a : b + 1] for a, b in pairwise(ends.tolist())]

    def middle(self, most: int) -> IntArray:
        """Return neighbours in the middle of the line."""
        first = max(0, (len(self.steps) - most) // 2)
        return self.steps[first : first + most]


def places_of(photos: Sequence[TimedPhoto]) -> Places:
    """Return the photos' places (N,), east + i north in metres, as they state them."""
    return np.array([complex(p.view.aim.east_m, p.view.aim.north_m) for p in photos])


def short_side_m(timed: TimedPhoto) -> float:
    """Return the ground along a photo's shorter side, as if taken straight down."""
    view = timed.view
    across_m = 2.0 * abs(view.aim.height_m) * tan(radians(view.across_deg / 2.0))
    return across_m * min(view.cols, view.rows) / max(view.cols, view.rows)


def flight_lines(photos: Sequence[TimedPhoto]) -> list[FlightLine]:
    """Return the flight lines of one camera on one vehicle, its photos in the order of time."""
    if not photos:
        return []
    places = places_of(photos)
    steps = _steps(photos, places)
    starts, course = [0], 0j
    for number, (before, now) in enumerate(pairwise(steps), start=1):
        moved = places[now] - places[before]
        is_far = abs(moved) > (1.0 - LEAST_COMMON) * short_side_m(photos[now])
        if is_far or (course != 0 and abs(np.angle(moved / course, deg=True)) > TURN_DEG):
            starts.append(number)
            course = 0j
        else:
            course = moved
    return [
        FlightLine(np.arange(steps[a] if a else 0, steps[b] if b < len(steps) else len(photos)),
                   np.array(steps[a:b]))
        for a, b in pairwise([*starts, len(steps)])
    ]  # fmt: skip


def _steps(photos: Sequence[TimedPhoto], places: Places) -> list[int]:
    """Return photos that are a step apart, as nearly as they were taken."""
    steps = [0]
    for number in range(1, len(photos)):
        if abs(places[number] - places[steps[-1]]) >= STEP_SHARE * short_side_m(photos[number]):
            steps.append(number)
    return steps
