"""Order and direction in which pieces of rows are flown: to and fro, row by row.

Pieces of neighbouring rows that face one another, one to one, make a chain that is flown as a
serpentine. Where a hole or a bay divides rows a chain ends and others begin; these are put in the
order of the shortest tour among those that always continue at the nearest end of a chain.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import dist

from recon.guidance.survey.lattice import AlongAcross, RowLattice
from recon.guidance.survey.rows import Piece


@dataclass(frozen=True, slots=True)
class RowLeg:
    """A piece and the direction it is flown in."""

    piece: Piece
    is_reversed: bool

    def ends_m(self, lattice: RowLattice, lead_m: float) -> tuple[AlongAcross, AlongAcross]:
        """Return where it begins and ends, in metres along and across, with its lead."""
        across_m = lattice.row_across_m(self.piece.row)
        low = (self.piece.start_m - lead_m, across_m)
        high = (self.piece.end_m + lead_m, across_m)
        return (high, low) if self.is_reversed else (low, high)


Route = tuple[RowLeg, ...]
Chain = tuple[Piece, ...]


def route_of(
    pieces: Sequence[Piece], lattice: RowLattice, start_m: AlongAcross | None, direction: int = 0
) -> Route:
    """Return the legs in the order they are flown, beginning near `start_m` (along, across).

    They lead to higher rows if `direction` is 1 and to lower ones if it is -1, where they can.
    """
    entries = [_entries(chain) for chain in chains(pieces)]
    tours = list(_tours(entries, lattice, start_m))
    if direction:
        tours = [tour for tour in tours if direction_of(tour) != -direction] or tours
    return min(tours, key=lambda tour: between_m(tour, lattice, start_m), default=())


def direction_of(route: Route) -> int:
    """Return 1 if a route leads to higher rows, -1 if to lower ones, 0 if to neither."""
    rows = route[-1].piece.row - route[0].piece.row if route else 0
    return (rows > 0) - (rows < 0)


def chains(pieces: Sequence[Piece]) -> list[Chain]:
    """Return the pieces in chains of rising rows."""
    by_row: dict[int, list[Piece]] = {}
    for piece in sorted(pieces, key=lambda piece: (piece.row, piece.start_m)):
        by_row.setdefault(piece.row, []).append(piece)
    ahead: dict[Piece, Piece] = {}
    for row, here in by_row.items():
        ahead |= _facing(here, by_row.get(row + 1, []))
    followers = set(ahead.values())
    firsts = [piece for here in by_row.values() for piece in here if piece not in followers]
    return [tuple(_followed(first, ahead)) for first in firsts]


def between_m(route: Sequence[RowLeg], lattice: RowLattice, start_m: AlongAcross | None) -> float:
    """Return how far it is from the start to the first piece, and from each to the next."""
    ends = [leg.ends_m(lattice, 0.0) for leg in route]
    first_m = dist(start_m, ends[0][0]) if ends and start_m is not None else 0.0
    return first_m + sum(dist(a[1], b[0]) for a, b in pairwise(ends))


def _facing(here: Sequence[Piece], there: Sequence[Piece]) -> dict[Piece, Piece]:
    """Return which pieces of two rows face one another and no other."""
    facing = {a: [b for b in there if _overlap(a, b)] for a in here}
    faced = {b: [a for a in here if _overlap(a, b)] for b in there}
    return {
        a: others[0]
        for a, others in facing.items()
        if len(others) == 1 and len(faced[others[0]]) == 1
    }


def _overlap(a: Piece, b: Piece) -> bool:
    return min(a.end_m, b.end_m) > max(a.start_m, b.start_m)


def _followed(first: Piece, ahead: dict[Piece, Piece]) -> Iterator[Piece]:
    piece: Piece | None = first
    while piece is not None:
        yield piece
        piece = ahead.get(piece)


def _entries(chain: Chain) -> tuple[Route, ...]:
    """The four serpentines of a chain: from either end of its first row, and of its last."""
    return tuple(
        tuple(RowLeg(piece, index % 2 == side) for index, piece in enumerate(ordered))
        for ordered in (chain, chain[::-1])
        for side in (0, 1)
    )


MOST_TOURS = 16


def _tours(
    entries: Sequence[tuple[Route, ...]], lattice: RowLattice, start_m: AlongAcross | None
) -> Iterator[Route]:
    """Yield tours over the nearest chains, begun at each of the entries nearest to the start."""
    firsts = [(index, first) for index, entry in enumerate(entries) for first in entry]
    firsts.sort(key=lambda first: between_m(first[1][:1], lattice, start_m))
    for index, first in firsts[:MOST_TOURS]:
        others = [entry for other, entry in enumerate(entries) if other != index]
        yield _nearest_on(first, others, lattice)


def _nearest_on(tour: Route, entries: list[tuple[Route, ...]], lattice: RowLattice) -> Route:
    while entries:
        here_m = tour[-1].ends_m(lattice, 0.0)[1]

        def far_m(route: Route, here_m: AlongAcross = here_m) -> float:
            return dist(here_m, route[0].ends_m(lattice, 0.0)[0])

        nearest = min(entries, key=lambda entry: min(far_m(route) for route in entry))
        entries.remove(nearest)
        tour += min(nearest, key=far_m)
    return tour


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


def _cut(leg: RowLeg, most_m: float, lattice: RowLattice, least_m: float) -> tuple[Route, Route]:
    """A leg in two at a mark, the first no longer than that; or whole, as the first or second."""
    piece = leg.piece
    if piece.length_m <= most_m:
        return (leg,), ()
    first_m = min(most_m, piece.length_m - least_m)
    mark_m = _mark_within(leg, first_m, lattice)
    if min(mark_m - piece.start_m, piece.end_m - mark_m) < least_m:
        return (), (leg,)
    low = RowLeg(Piece(piece.row, piece.start_m, mark_m), leg.is_reversed)
    high = RowLeg(Piece(piece.row, mark_m, piece.end_m), leg.is_reversed)
    return ((high,), (low,)) if leg.is_reversed else ((low,), (high,))


def _mark_within(leg: RowLeg, first_m: float, lattice: RowLattice) -> float:
    """Return the last mark within a distance of where a leg begins."""
    if leg.is_reversed:
        return lattice.mark_at_or_after_m(leg.piece.end_m - first_m)
    return lattice.mark_at_or_before_m(leg.piece.start_m + first_m)


def _length_m(route: Route, lattice: RowLattice, cost: Cost) -> float:
    """How long a route is with the paths between its legs and its stops."""
    rows_m = sum(leg.piece.length_m + cost.stop_m for leg in route)
    return rows_m + sum(_between_m(a, b, lattice) + cost.stop_m for a, b in pairwise(route))


def _between_m(a: RowLeg, b: RowLeg, lattice: RowLattice) -> float:
    """How far it is from the end of a leg to the beginning of the next."""
    (_, end_m), (start_m, _) = a.ends_m(lattice, 0.0), b.ends_m(lattice, 0.0)
    return dist(start_m, end_m)
