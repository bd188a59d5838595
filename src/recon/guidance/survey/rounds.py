"""Rounds: what is missing is shared among all who can fly, and flown; then what is missing still.

Within a round a vehicle goes on with its share for as many missions as its battery makes of it.
When a vehicle drops out, what it has not imaged is missing, and so is part of the next round.
"""

from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from scipy.optimize import linear_sum_assignment

from recon.guidance.survey.missions import Track, flight_time_s, mission_of, track_of
from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.route import Place, Route, between_m, route_of
from recon.guidance.survey.rows import Piece
from recon.guidance.survey.share import Cost, shared
from recon.guidance.survey.state import NO_ROUTES, Flight, Surveyor, SurveyState
from recon.model.survey import CellState, MissionFor, SurveyPhase
from recon.model.units import ns_to_seconds, seconds_to_ns

Step = tuple[SurveyState, tuple[MissionFor, ...]]


def fly_rounds(
    state: SurveyState, positions: Sequence[Surveyor], now_ns: int, wanted: CellState
) -> Step:
    """Return the running survey a moment later, and the missions to give.

    Rounds are flown until every cell that rows reach is in the wanted state, or the budget ends.
    """
    able = {each.serial: each for each in positions if each.is_able}
    state = _without_ended(state, able, now_ns)
    if state.flights or state.waiting:
        state, missions = _given(state, able)
        if missions or state.flights:
            return state, missions
        state = replace(state, waiting=NO_ROUTES)
    if now_ns < state.quiet_since_ns + seconds_to_ns(state.plan.settings.settle_s):
        return state, ()
    end = _end(state, now_ns, wanted)
    if end is not None:
        return ended(state, *end, now_ns), ()
    return _next_round(state, able, wanted)


def ended(state: SurveyState, phase: SurveyPhase, reason: str, now_ns: int) -> SurveyState:
    """Return the survey in a phase in which nobody flies for it."""
    return replace(
        state,
        phase=phase,
        reason=reason,
        flights=MappingProxyType({}),
        waiting=NO_ROUTES,
        ended_at_ns=now_ns if phase.is_final else None,
        quiet_since_ns=now_ns,
    )


def is_enough(state: SurveyState, wanted: CellState) -> bool:
    """Return whether as many cells as are asked for are in the wanted state."""
    reached = state.plan.cells.is_reached
    share = float((state.progress.state[reached] >= wanted).mean())
    return share >= state.plan.settings.enough_share


def _without_ended(state: SurveyState, able: Mapping[str, Surveyor], now_ns: int) -> SurveyState:
    """Without the missions that have ended, and without what was left for who has dropped out."""
    flights = {
        serial: flight
        for serial, flight in state.flights.items()
        if serial in able and able[serial].ended_mission < flight.number
    }
    waiting = {serial: route for serial, route in state.waiting.items() if serial in able}
    quiet_ns = now_ns if state.flights and not flights else state.quiet_since_ns
    return replace(
        state,
        flights=MappingProxyType(flights),
        waiting=MappingProxyType(waiting),
        quiet_since_ns=quiet_ns,
    )


def _end(state: SurveyState, now_ns: int, wanted: CellState) -> tuple[SurveyPhase, str] | None:
    """The phase that ends the running survey between two rounds, and why; None: it goes on."""
    budget = state.plan.survey.budget
    if is_enough(state, wanted):
        sun = " in sun" if wanted == CellState.IN_SUN else ""
        return SurveyPhase.DONE, f"all that the rows reach is imaged{sun}"
    if state.round and not state.missions_in_round and state.refusals:
        serial, reason = next(iter(state.refusals.items()))
        return SurveyPhase.PAUSED, f"every mission was refused; {serial}: {reason}"
    if state.round >= budget.rounds:
        return SurveyPhase.DONE, f"the {budget.rounds} rounds allowed are flown; some is missing"
    flying_s = ns_to_seconds(now_ns - (state.started_at_ns or now_ns))
    if budget.time_s is not None and flying_s >= budget.time_s:
        return SurveyPhase.DONE, f"the {budget.time_s:g} s allowed are over; some is missing"
    if budget.flown_m is not None and state.flown_m >= budget.flown_m:
        return SurveyPhase.DONE, f"the {budget.flown_m:g} m allowed are flown; some is missing"
    return None


def _next_round(state: SurveyState, able: Mapping[str, Surveyor], wanted: CellState) -> Step:
    if not able:
        return replace(state, reason="waits: none of its vehicles can fly now"), ()
    pieces = state.plan.pieces_over(state.progress.state < wanted)
    begun = replace(
        state,
        waiting=MappingProxyType(_shares(state.plan, pieces, list(able.values()))),
        round=state.round + 1,
        missions_in_round=0,
        refusals=MappingProxyType({}),
        reason=f"round {state.round + 1}",
    )
    given, missions = _given(begun, able)
    if missions:
        return given, missions
    reason = "waits: no battery lasts for the next row, the way there and the way home"
    return replace(state, reason=reason), ()


def _shares(
    plan: SurveyPlan, pieces: Sequence[Piece], surveyors: Sequence[Surveyor]
) -> dict[str, Route]:
    """Each vehicle's share of the pieces: the way of sweeping, and who gets what, by the shortest
    ways to where the shares begin."""
    survey, settings = plan.survey, plan.settings
    cost = Cost(survey.speed_mps**2 / settings.turning_mps2, settings.least_cut_m)
    lying = plan.lattice.along_across_m([each.place_m for each in surveyors]).tolist()
    places: list[Place] = [(along, across) for along, across in lying]
    best: tuple[float, dict[str, Route]] | None = None
    for is_rising in (True, False):
        start_m = places[0] if len(places) == 1 else None
        route = route_of(pieces, plan.lattice, start_m, is_rising)
        runs = [run for run in shared(route, len(places), plan.lattice, cost) if run]
        far_m = np.array([[between_m(run[:1], plan.lattice, at) for run in runs] for at in places])
        who, which = linear_sum_assignment(far_m)
        total_m = float(far_m[who, which].sum()) + between_m(route, plan.lattice, None)
        if best is None or total_m < best[0]:
            given = {
                surveyors[int(i)].serial: runs[int(j)] for i, j in zip(who, which, strict=True)
            }
            best = (total_m, given)
    return {} if best is None else best[1]


def _given(state: SurveyState, able: Mapping[str, Surveyor]) -> Step:
    """Give each vehicle that flies no mission as much of what waits for it as it can fly."""
    missions: list[MissionFor] = []
    for serial, route in state.waiting.items():
        if serial in state.flights:
            continue
        track, count = _sortie(state.plan, route, able[serial])
        if track is None:
            continue
        number = state.missions + 1
        state, mission = _flying(
            state,
            serial,
            Flight(number, route[:count], track.corners_m, track.length_m),
            route[count:],
        )
        missions.append(mission)
    return state, tuple(missions)


def _flying(
    state: SurveyState, serial: str, flight: Flight, rest: Route
) -> tuple[SurveyState, MissionFor]:
    survey = state.plan.survey
    purpose = f"survey {survey.name}: round {state.round}"
    track = Track(flight.corners_m)
    mission = mission_of(track, survey, state.plan.frame, purpose)
    waiting = {**state.waiting, serial: rest}
    if not rest:
        del waiting[serial]
    state = replace(
        state,
        flights=MappingProxyType({**state.flights, serial: flight}),
        waiting=MappingProxyType(waiting),
        missions=flight.number,
        missions_in_round=state.missions_in_round + 1,
        flown_m=state.flown_m + flight.length_m,
    )
    return state, MissionFor(serial, flight.number, mission, flight.length_m)


def _sortie(plan: SurveyPlan, route: Route, surveyor: Surveyor) -> tuple[Track | None, int]:
    """The longest beginning of a route that the battery lasts for, and how many legs it has."""

    def track(count: int) -> Track:
        return track_of(route[:count], plan.lattice, plan.swath.lead_m, plan.ways)

    if surveyor.time_left_s is None:
        return track(len(route)), len(route)
    too_long = range(1, len(route) + 1)
    count = bisect_left(too_long, True, key=lambda n: not _lasts(plan, track(n), surveyor))
    return (track(count) if count else None), count


def _lasts(plan: SurveyPlan, track: Track, surveyor: Surveyor) -> bool:
    home_m = surveyor.home_m or surveyor.place_m
    speed_mps = plan.survey.speed_mps
    needed_s = flight_time_s(track, speed_mps, surveyor.place_m, home_m, plan.settings)
    return needed_s <= (surveyor.time_left_s or 0.0) * plan.settings.flight_time_share
