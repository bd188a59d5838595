"""A survey's life: created, started, paused, aborted, done. Every step of it is pure.

Pausing and aborting only end what the survey asks for; who does it also orders its vehicles
(`flights` says which) to hover.
"""

from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

from recon.guidance.survey.missions import apart_m, track_of
from recon.guidance.survey.plan import RULE, SurveyPlan
from recon.guidance.survey.planners import PLANNERS, WANTED
from recon.guidance.survey.progress import (
    PositionSample,
    no_progress,
    settled,
    with_seen,
    with_shade,
)
from recon.guidance.survey.rounds import Step, ended, lasts
from recon.guidance.survey.route import Route, route_of
from recon.guidance.survey.state import Refused, Surveyor, SurveyState
from recon.model.command import Refusal
from recon.model.shade import ShadeMap
from recon.model.survey import SurveyPhase


def create(plan: SurveyPlan) -> SurveyState | Refusal:
    """Return a survey that waits to be started, or why there is none."""
    name = plan.survey.planner
    if name not in PLANNERS:
        known = " or ".join(PLANNERS)
        return Refusal(RULE, f"there is no planner {name}: choose {known}")
    return SurveyState(plan, no_progress(plan.cells))


def start(state: SurveyState, serials: Sequence[str], now_ns: int) -> SurveyState | Refusal:
    """Return the survey running, with these vehicles; also after a pause, with others if wanted."""
    if state.phase not in (SurveyPhase.CREATED, SurveyPhase.PAUSED):
        return _wrong_phase(state, "started")
    if not serials:
        return Refusal(RULE, f"the survey {state.plan.survey.name} needs at least one vehicle")
    return replace(
        state,
        serials=tuple(dict.fromkeys(serials)),
        phase=SurveyPhase.RUNNING,
        reason="started",
        started_at_ns=now_ns if state.started_at_ns is None else state.started_at_ns,
        refusals=MappingProxyType({}),
        barred=frozenset(),
    )


def pause(state: SurveyState, now_ns: int) -> SurveyState | Refusal:
    """Return the survey paused; a round that was under way does not count, and is planned anew."""
    if state.phase is not SurveyPhase.RUNNING:
        return _wrong_phase(state, "paused")
    was_flying = bool(state.flights or state.waiting)
    paused = ended(state, SurveyPhase.PAUSED, "paused", now_ns)
    return replace(paused, round=state.round - was_flying)


def abort(state: SurveyState, now_ns: int) -> SurveyState | Refusal:
    """Return the survey aborted, for good; what was imaged stays known."""
    if state.phase.is_final:
        return _wrong_phase(state, "aborted")
    return ended(state, SurveyPhase.ABORTED, "aborted", now_ns)


def refused(state: SurveyState, serial: str, number: int, reason: str, now_ns: int) -> SurveyState:
    """Return the survey after the gate refused a mission; its rows wait.

    If others fly, it is asked for again a little later; if nobody does, that vehicle is barred and
    its rows go to others. With nobody left to fly the survey pauses.
    """
    flight = state.flights.get(serial)
    if flight is None or flight.number != number:
        return state
    flights = {key: each for key, each in state.flights.items() if key != serial}
    route = (*flight.route, *state.waiting.get(serial, ()))
    return replace(
        state,
        flights=MappingProxyType(flights),
        waiting=MappingProxyType({**state.waiting, serial: route}),
        refusals=MappingProxyType({**state.refusals, serial: Refused(reason, now_ns)}),
        barred=state.barred if flights else state.barred | {serial},
        flown_m=state.flown_m - flight.length_m,
    )


def observe(state: SurveyState, serial: str, seen: Sequence[PositionSample]) -> SurveyState:
    """Return the survey after positions of a vehicle; nothing changes for one that is not of it.

    What is flown while it is paused counts as well; before the start and after the end nothing.
    """
    if serial not in state.serials or state.phase.is_final:
        return state
    return replace(state, progress=with_seen(state.progress, serial, seen, state.plan))


def observe_shade(state: SurveyState, shade: ShadeMap) -> SurveyState:
    """Return the survey after a shade map."""
    if state.phase.is_final:
        return state
    return replace(state, progress=with_shade(state.progress, shade, state.plan))


def step(state: SurveyState, positions: Sequence[Surveyor], now_ns: int) -> Step:
    """Return the survey a moment later, and the missions to give; about once a second.

    Positions of vehicles that are not of the survey are left out; vehicles without a position
    count as dropped out.
    """
    if state.phase not in (SurveyPhase.RUNNING, SurveyPhase.PAUSED):
        return state, ()
    state = replace(state, progress=settled(state.progress, state.plan, now_ns))
    if state.phase is SurveyPhase.PAUSED:
        return state, ()
    own = [each for each in positions if each.serial in state.serials]
    return PLANNERS[state.plan.survey.planner](state, own, now_ns)


def _wrong_phase(state: SurveyState, asked: str) -> Refusal:
    return Refusal(
        RULE, f"the survey {state.plan.survey.name} is {state.phase.value} and cannot be {asked}"
    )


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
