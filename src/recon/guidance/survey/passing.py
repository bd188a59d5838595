"""Time at which a vehicle passes a route's missing ground, and how much is in sun by then."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import dist, exp, inf
from typing import NamedTuple

import numpy as np

from recon.guidance.survey.lattice import AlongAcross, RowLattice
from recon.guidance.survey.route import Route
from recon.guidance.survey.search import Pace
from recon.guidance.survey.segments import ExpectedSun, Segments


class Pass(NamedTuple):
    """A part of a segment that is flown over: its missing ground, and when its middle is passed."""

    segment: int
    missing_m2: float
    at_s: float


@dataclass(frozen=True, slots=True)
class Passing:
    """What a route passes, in its order, and when it ends; seconds from now."""

    passes: Sequence[Pass]
    ends_s: float

    @property
    def missing_m2(self) -> float:
        """The missing ground that is passed."""
        return sum(each.missing_m2 for each in self.passes)

    def until(self, until_s: float) -> "Passing":
        """Return what of it is passed by then, and its first part always."""
        later = (each for each in self.passes[1:] if each.at_s <= until_s)
        return replace(self, passes=(*self.passes[:1], *later))

    def lit_m2(self, expected: ExpectedSun, patience_s: float = inf) -> float:
        """Return the ground expected in sun when it is passed.

        With a patience, ground passed after that long counts for a third, as in a search.
        """
        return sum(
            each.missing_m2 * expected.at(each.segment, each.at_s) * exp(-each.at_s / patience_s)
            for each in self.passes
        )


def passing(
    route: Route,
    segments: Segments,
    expected: ExpectedSun,
    lattice: RowLattice,
    pace: Pace,
    start_m: AlongAcross,
    starts_s: float,
) -> Passing:
    """Return what a vehicle passes that leaves a place (along, across) then."""
    passes: list[Pass] = []
    at_s, place_m = starts_s, start_m
    for leg in route:
        begins_m, ends_m = leg.ends_m(lattice, 0.0)
        path_m = dist(begins_m, place_m)
        at_s += path_m / pace.speed_mps + pace.stop_s
        for number in np.flatnonzero(segments.under([leg])).tolist():
            part = segments.parts[number]
            low_m, high_m = max(leg.piece.start_m, part.start_m), min(leg.piece.end_m, part.end_m)
            on_m = abs((low_m + high_m) / 2.0 - begins_m[0])
            share = (high_m - low_m) / part.length_m
            missing_m2 = float(expected.missing_m2[number]) * share
            passes.append(Pass(number, missing_m2, at_s + on_m / pace.speed_mps))
        at_s += leg.piece.length_m / pace.speed_mps + pace.stop_s
        place_m = ends_m
    return Passing(tuple(passes), at_s)
