"""A survey planned anew while it is flown: keep-out zones came or went.

Region, lattice and cells stay the same, so progress counts on. Rows that wait are cut to what may
be flown over now; those of a vehicle that was held on its mission wait for it again, as far as they
are not imaged yet. Rows that are free again belong to the next round.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from types import MappingProxyType

from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.rounds import ended
from recon.guidance.survey.route import Route, RowLeg
from recon.guidance.survey.rows import Piece
from recon.guidance.survey.state import SurveyState
from recon.model.command import Refusal
from recon.model.survey import SurveyPhase

LEAST_LEG_M = 1.0
"""Least length of a row's rest: less is rounding."""


def replanned(
    state: SurveyState, plan: SurveyPlan | Refusal, flying: frozenset[str], now_ns: int
) -> SurveyState:
    """Return the survey with another plan of the same survey; `flying` still fly their missions.

    Without any row left it pauses, if it runs: the round under way does not count.
    """
    if isinstance(plan, Refusal):
        if state.phase is not SurveyPhase.RUNNING:
            return state
        was_flying = bool(state.flights or state.waiting)
        paused = ended(state, SurveyPhase.PAUSED, plan.reason, now_ns)
        return replace(paused, round=state.round - was_flying)
    missing = plan.pieces_over(replace(state, plan=plan).missing())
    kept = {key: flight for key, flight in state.flights.items() if key in flying}
    waiting: dict[str, Route] = {}
    for serial in {**state.flights, **state.waiting}:
        held = () if serial in kept or serial not in state.flights else state.flights[serial].route
        legs = tuple(_cut((*held, *state.waiting.get(serial, ())), missing))
        if legs:
            waiting[serial] = legs
    quiet_ns = now_ns if state.flights and not kept else state.quiet_since_ns
    return replace(
        state,
        plan=plan,
        flights=MappingProxyType(kept),
        waiting=MappingProxyType(waiting),
        quiet_since_ns=quiet_ns,
    )


def _cut(route: Route, pieces: Sequence[Piece]) -> Iterator[RowLeg]:
    """The legs as far as they lie on these pieces, in the order they are flown."""
    for leg in route:
        flown = leg.piece
        of_row = [piece for piece in pieces if piece.row == flown.row]
        for piece in reversed(of_row) if leg.is_reversed else of_row:
            start_m = max(flown.start_m, piece.start_m)
            end_m = min(flown.end_m, piece.end_m)
            if end_m - start_m >= LEAST_LEG_M:
                yield RowLeg(Piece(flown.row, start_m, end_m), leg.is_reversed)
