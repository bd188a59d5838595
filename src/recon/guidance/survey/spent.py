"""Whose battery lasts for no row that is left: who should not wait in the air any longer."""

from collections.abc import Sequence

from recon.guidance.survey.missions import apart_m, track_of
from recon.guidance.survey.planners import WANTED
from recon.guidance.survey.rounds import lasts
from recon.guidance.survey.route import Route, route_of
from recon.guidance.survey.state import Surveyor, SurveyState
from recon.model.survey import SurveyPhase


def spent(state: SurveyState, positions: Sequence[Surveyor]) -> tuple[str, ...]:
    """Return the serials of those who could fly, fly nothing, and have no battery for a row.

    Whose battery's time nobody knows is never among them: the gate alone says what it is good for.
    """
    if state.phase is not SurveyPhase.RUNNING:
        return ()
    idle = [each for each in positions if each.is_able and each.serial not in state.flights]
    return tuple(
        each.serial
        for each in idle
        if each.serial in state.serials and each.time_left_s is not None
        if not _has_a_row(state, each)
    )


def _has_a_row(state: SurveyState, surveyor: Surveyor) -> bool:
    """Whether the battery lasts for the next row, or at least to wait for one and fly home then."""
    plan, own = state.plan, state.waiting.get(surveyor.serial)
    if own:
        return _lasts_for_any(state, own[:1], surveyor)
    # While others fly, what they leave to be flown is not known: it is waited for.
    legs = () if state.flights else _left(state, surveyor)
    if legs:
        return _lasts_for_any(state, legs, surveyor)
    assert surveyor.time_left_s is not None  # or it is not asked
    way_m = apart_m(surveyor.place_m, surveyor.home_m or surveyor.place_m)
    needed_s = way_m / plan.survey.speed_mps + plan.settings.way_home_waits_s
    return needed_s <= surveyor.time_left_s * plan.settings.flight_time_share


def _left(state: SurveyState, surveyor: Surveyor) -> Route:
    """What waits to be flown by anybody; between two rounds what the next one would fly."""
    waiting = tuple(leg for route in state.waiting.values() for leg in route)
    if waiting:
        return waiting
    plan = state.plan
    pieces = plan.pieces_over(state.progress.state < WANTED[plan.survey.planner])
    ((along_m, across_m),) = plan.lattice.along_across_m([surveyor.place_m]).tolist()
    return route_of(pieces, plan.lattice, (along_m, across_m)) if pieces else ()


def _lasts_for_any(state: SurveyState, legs: Route, surveyor: Surveyor) -> bool:
    plan = state.plan
    tracks = (track_of((leg,), plan.lattice, plan.swath.lead_m, plan.ways) for leg in legs)
    return any(lasts(plan, track, surveyor) for track in tracks)
