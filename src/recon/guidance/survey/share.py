"""One route shared among vehicles: a run of neighbouring rows for each, about as long for all.

The route over everything is worked out first and cut then, so that no vehicle flies more between
rows than one alone would.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import hypot

from recon.guidance.survey.lattice import RowLattice
from recon.guidance.survey.route import Leg, Route
from recon.guidance.survey.rows import Piece

CLOSE_M = 1.0
"""Shares are found to this: far less than what a cut at a mark makes them differ by."""


@dataclass(frozen=True, slots=True)
class Cost:
    """How long legs are to fly, in metres: each stop counts as `stop_m`.

    No row is cut nearer than `least_cut_m` to its end.
    """

    stop_m: float
    least_cut_m: float


def shared(route: Route, count: int, lattice: RowLattice, cost: Cost) -> tuple[Route, ...]:
    """Return the route in `count` runs, or fewer when it is too short for that, none empty.

    The longest run is as short as cutting at marks allows; so all but the last are about as long.
    """
    best: tuple[Route, ...] = (route,) if route else ()
    least_m, most_m = 0.0, _length_m(route, lattice, cost)
    longest_m = most_m
    while most_m - least_m > CLOSE_M:
        share_m = (least_m + most_m) / 2.0
        runs = _cut_up(route, share_m, lattice, cost)
        of_them_m = max(_length_m(run, lattice, cost) for run in runs)
        # Shares shorter than rows can be cut make few runs again, but long ones.
        if len(runs) <= count and of_them_m <= longest_m:
            best, longest_m, most_m = runs, of_them_m, share_m
        else:
            least_m = share_m
    return best


def _cut_up(route: Route, share_m: float, lattice: RowLattice, cost: Cost) -> tuple[Route, ...]:
    """The route in runs as long as can be but no longer than a share, unless it is one leg."""
    left = list(reversed(route))
    runs: list[Route] = []
    run: Route = ()
    run_m = 0.0
    while left:
        leg = left.pop()
        to_it_m = _between_m(run[-1], leg, lattice) + cost.stop_m if run else 0.0
        room_m = share_m - run_m - to_it_m - cost.stop_m
        first, second = _cut(leg, room_m, lattice, cost.least_cut_m)
        if not run and not first:
            first, second = second, ()
        run += first
        run_m += to_it_m + cost.stop_m + sum(each.piece.length_m for each in first)
        if second or not first:
            left += second
            runs.append(run)
            run, run_m = (), 0.0
    return (*runs, run) if run else tuple(runs)


def _cut(leg: Leg, most_m: float, lattice: RowLattice, least_m: float) -> tuple[Route, Route]:
    """A leg in two at a mark, the first no longer than that; or whole, as the first or second."""
    piece = leg.piece
    if piece.length_m <= most_m:
        return (leg,), ()
    first_m = min(most_m, piece.length_m - least_m)
    mark_m = _mark_within(leg, first_m, lattice)
    if min(mark_m - piece.start_m, piece.end_m - mark_m) < least_m:
        return (), (leg,)
    low = Leg(Piece(piece.row, piece.start_m, mark_m), leg.is_reversed)
    high = Leg(Piece(piece.row, mark_m, piece.end_m), leg.is_reversed)
    return ((high,), (low,)) if leg.is_reversed else ((low,), (high,))


def _mark_within(leg: Leg, first_m: float, lattice: RowLattice) -> float:
    """The last mark that is at most so far from where a leg begins."""
    if leg.is_reversed:
        return lattice.mark_at_or_after_m(leg.piece.end_m - first_m)
    return lattice.mark_at_or_before_m(leg.piece.start_m + first_m)


def _length_m(route: Route, lattice: RowLattice, cost: Cost) -> float:
    """How long a route is with the ways between its legs and its stops."""
    rows_m = sum(leg.piece.length_m + cost.stop_m for leg in route)
    return rows_m + sum(_between_m(a, b, lattice) + cost.stop_m for a, b in pairwise(route))


def _between_m(a: Leg, b: Leg, lattice: RowLattice) -> float:
    """How far it is from the end of a leg to the beginning of the next."""
    (_, end_m), (start_m, _) = a.ends_m(lattice, 0.0), b.ends_m(lattice, 0.0)
    return hypot(start_m[0] - end_m[0], start_m[1] - end_m[1])
