"""One route shared among vehicles: a run of neighbouring rows for each, about as long for all.

The route over everything is worked out first and cut then, so that no vehicle flies more between
rows than one alone would.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot

from recon.guidance.survey.lattice import RowLattice
from recon.guidance.survey.route import Leg, Route
from recon.guidance.survey.rows import Piece


@dataclass(frozen=True, slots=True)
class Cost:
    """How long legs are to fly, in metres: each stop counts as `stop_m`.

    No row is cut nearer than `least_cut_m` to its end.
    """

    stop_m: float
    least_cut_m: float


def shared(route: Route, count: int, lattice: RowLattice, cost: Cost) -> tuple[Route, ...]:
    """Return the route in `count` runs; some are empty when it is too short to be shared.

    Rows are cut at marks where a share ends: shares differ by a mark or `least_cut_m` at most.
    """
    left = list(route)
    runs: list[Route] = []
    for remaining in range(count, 1, -1):
        share_m = _length_m(left, lattice, cost) / remaining
        run, left = _taken(left, share_m, lattice, cost)
        runs.append(run)
    return (*runs, tuple(left))


def _taken(
    legs: list[Leg], share_m: float, lattice: RowLattice, cost: Cost
) -> tuple[Route, list[Leg]]:
    """As many legs from the front as make a share, the last one cut; and the rest."""
    taken: list[Leg] = []
    for index, leg in enumerate(legs):
        left_m = share_m - _length_m([*taken, leg], lattice, cost) + leg.piece.length_m
        if leg.piece.length_m <= left_m:
            taken.append(leg)
            continue
        first, second = _cut(leg, left_m, lattice, cost.least_cut_m)
        return (*taken, *first), [*second, *legs[index + 1 :]]
    return tuple(taken), []


def _cut(leg: Leg, first_m: float, lattice: RowLattice, least_m: float) -> tuple[Route, Route]:
    """A leg in two, the first about that long; whole on one side where a cut is not worth it."""
    piece, first_m = leg.piece, max(first_m, 0.0)
    at_m = piece.end_m - first_m if leg.is_reversed else piece.start_m + first_m
    mark_m = lattice.nearest_mark_m(at_m)
    if min(mark_m - piece.start_m, piece.end_m - mark_m) < least_m:
        return ((leg,), ()) if first_m > piece.length_m / 2.0 else ((), (leg,))
    low = Leg(Piece(piece.row, piece.start_m, mark_m), leg.is_reversed)
    high = Leg(Piece(piece.row, mark_m, piece.end_m), leg.is_reversed)
    return ((high,), (low,)) if leg.is_reversed else ((low,), (high,))


def _length_m(legs: Sequence[Leg], lattice: RowLattice, cost: Cost) -> float:
    """How long legs are with the ways between them and their stops."""
    total_m = 0.0
    end_m: tuple[float, float] | None = None
    for leg in legs:
        start_m, next_end_m = leg.ends_m(lattice, 0.0)
        total_m += leg.piece.length_m + cost.stop_m
        if end_m is not None:
            total_m += hypot(start_m[0] - end_m[0], start_m[1] - end_m[1]) + cost.stop_m
        end_m = next_end_m
    return total_m
