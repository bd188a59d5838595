"""Where the imaging drone hovers, so that it sees today's sky over the field and what comes next.

What shades a cell in a minute lies now as far upwind of it as shadows move in a minute. Above the
middle of the field a lens sees as much downwind, where nothing comes from, as upwind. Farther
upwind it sees longer ahead, and less of the field itself; what has passed through the view is
followed, with a little less certainty. A camera tilted upwind sees both. So the places of a lattice
from which at least half of the field is in view are compared by one figure: how much of its shade
is seen or followed, now and in the next two minutes, the present counting as much as all the rest.
Pure.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import atan2, cos, degrees, hypot, radians, sin, sqrt

import numpy as np

from recon.model.arrays import BoolArray, FloatArray

LEAD_S = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0, 105.0, 120.0)
"""The present, a photo, a row, and the rows until the next decision."""
SAMPLE_M, MOST_SAMPLES = 20.0, 2_000
"""Distance between the points that represent the field, and the most of them: shares are right to
about two per cent. A field of more than 80 ha has them farther apart."""
STEP_M = 40.0
"""Distance between places: nearer ones differ by less than the wind turns."""
FOLLOWED_WORTH = 0.7
"""What shade that has left the view and is followed is worth, against shade that is seen."""
LEAST_NOW = 0.5
"""Share of the field that stays in view, of the most that any place shows: drones fly there now."""
FARTHEST_UPWIND_M, FARTHEST_ASIDE_M = 320.0, 80.0
LEAST_SPEED_MPS = 0.5
"""Least speed of shadows: slower ones have no direction, and the place above the field is best."""


@dataclass(frozen=True, slots=True)
class GroundView:
    """The level ground that a camera shows, around the point below it.

    `field_rad` is the angle from the lens's axis to its rim. The axis is tilted from straight down
    towards where the camera looks.
    """

    height_m: float
    field_rad: float
    tilt_rad: float = 0.0
    farthest_m: float = float("inf")
    """Line of sight. Beyond it a pixel shows too much ground."""

    def shows(self, ahead_m: FloatArray, aside_m: FloatArray) -> BoolArray:
        """Return which points of the ground are in view; both arrays are of one shape."""
        sight_m = np.sqrt(ahead_m**2 + aside_m**2 + self.height_m**2)
        along_axis_m = ahead_m * sin(self.tilt_rad) + self.height_m * cos(self.tilt_rad)
        in_field: BoolArray = along_axis_m >= sight_m * cos(self.field_rad)
        return in_field & (sight_m <= self.farthest_m)


@dataclass(frozen=True, slots=True)
class UpwindPlace:
    """A place, where the camera looks from it, and what it sees of the field's shade."""

    east_m: float
    north_m: float
    heading_deg: float
    """Clockwise from north: upwind."""
    predicted: tuple[float, ...]
    """Share of the field whose shade is in view now, for each of `LEAD_S`."""
    followed: tuple[float, ...]
    """Share whose shade is not in view now, but was a short time ago."""

    @property
    def worth(self) -> float:
        """The figure by which places are compared, in [0, 1]."""
        now, *later = (
            seen + FOLLOWED_WORTH * left
            for seen, left in zip(self.predicted, self.followed, strict=True)
        )
        return (now + float(np.mean(later))) / 2.0

    def predicted_at(self, lead_s: float) -> float:
        """Return the share of the field predicted at a lead, interpolated between leads."""
        return float(np.interp(lead_s, LEAD_S, self.predicted))


def seen_from(
    field_m: FloatArray,
    place_m: tuple[float, float],
    heading_deg: float,
    velocity_mps: tuple[float, float],
    view: GroundView,
    followed_for_s: float,
) -> UpwindPlace:
    """Return what a place sees of a field, given as points (N, 2) east and north in metres.

    The shadows' velocity is east and north. Shade that has left the view is followed for a while.
    """
    ahead = np.array([sin(radians(heading_deg)), cos(radians(heading_deg))])
    axes = np.column_stack([ahead, (ahead[1], -ahead[0])])
    moved = np.array(velocity_mps) @ axes
    start = (field_m - np.array(place_m)) @ axes
    every_s = LEAD_S[1]
    followed_steps = round(followed_for_s / every_s)
    steps = len(LEAD_S) + followed_steps
    # What will be over a cell later lies farther upwind now; it was in view before it is here.
    in_view = np.array([view.shows(*(start - every_s * step * moved).T) for step in range(steps)])
    predicted, followed = [], []
    for step in range(len(LEAD_S)):
        was_seen = in_view[step + 1 : step + 1 + followed_steps].any(axis=0)
        predicted.append(float(in_view[step].mean()))
        followed.append(float((was_seen & ~in_view[step]).mean()))
    return UpwindPlace(*place_m, heading_deg, tuple(predicted), tuple(followed))


def best_place(
    field_m: FloatArray,
    velocity_mps: tuple[float, float],
    view: GroundView,
    followed_for_s: float,
    is_allowed: Callable[[FloatArray], BoolArray],
) -> UpwindPlace | None:
    """Return the place from which most of a field is predicted; None where none is allowed.

    `is_allowed` states of places (N, 2) where the drone may hover. Equal places: the nearest to the
    middle of the field.
    """
    places_m = _places_m(field_m, velocity_mps)
    places_m = places_m[is_allowed(places_m)]
    heading_deg = upwind_deg(velocity_mps)
    found = [
        seen_from(field_m, (east_m, north_m), heading_deg, velocity_mps, view, followed_for_s)
        for east_m, north_m in places_m.tolist()
    ]
    least_now = LEAST_NOW * max((each.predicted[0] for each in found), default=0.0)
    showing = [each for each in found if each.predicted[0] >= least_now]
    return max(showing, key=lambda each: each.worth, default=None)


def upwind_deg(velocity_mps: tuple[float, float]) -> float:
    """Return the direction from which shadows come, clockwise from north."""
    east_mps, north_mps = velocity_mps
    return degrees(atan2(-east_mps, -north_mps)) % 360.0


def field_points_m(
    outline_m: FloatArray, contains: Callable[[FloatArray], BoolArray]
) -> FloatArray:
    """Return points (N, 2) that stand for a region with this outline; its corners if it is tiny."""
    (west, south), (east, north) = outline_m.min(axis=0), outline_m.max(axis=0)
    apart_m = max(SAMPLE_M, sqrt((east - west) * (north - south) / MOST_SAMPLES))
    easts = np.arange(west + apart_m / 2.0, east, apart_m)
    norths = np.arange(south + apart_m / 2.0, north, apart_m)
    points_m = np.stack([each.ravel() for each in np.meshgrid(easts, norths)], axis=1)
    inside: FloatArray = points_m[contains(points_m)]
    return inside if len(inside) > 0 else outline_m


def _places_m(field_m: FloatArray, velocity_mps: tuple[float, float]) -> FloatArray:
    """The lattice of places (N, 2), upwind of the field's middle, the nearest ones first."""
    middle_m: FloatArray = (field_m.min(axis=0) + field_m.max(axis=0)) / 2.0
    speed_mps = hypot(*velocity_mps)
    if speed_mps < LEAST_SPEED_MPS:
        return middle_m[np.newaxis]
    upwind = -np.array(velocity_mps) / speed_mps
    aside = np.array([upwind[1], -upwind[0]])
    far_m = np.arange(0.0, FARTHEST_UPWIND_M + STEP_M, STEP_M)
    wide_m = np.arange(-FARTHEST_ASIDE_M, FARTHEST_ASIDE_M + STEP_M, STEP_M)
    offsets_m = np.array([far * upwind + wide * aside for far in far_m for wide in wide_m])
    nearest_first = np.argsort(np.hypot(*offsets_m.T), kind="stable")
    places_m: FloatArray = middle_m + offsets_m[nearest_first]
    return places_m
