"""Planners in rounds: share the missing rows among able vehicles, fly them, and repeat.

These planners are pure: the running survey, its vehicles and the time in; the survey and the
missions to give out. They are asked about once a second.

Theory of operation. One call of `fly_rounds` does the first of these that applies:

1. Missions of vehicles that ended or dropped out are removed. Rows they did not image are missing.
2. Each able vehicle without a mission gets the longest start of its share that its battery allows
   (`longest_mission`, flight time times `flight_time_share`).
3. While any vehicle flies, wait: its rows may still be imaged.
4. Budget spent: DONE.
5. No vehicle can fly: wait, or pause when all missions were refused.
6. Shares are left over (battery change, refusal): share them again among the able vehicles.
7. Wait `settle_s`, so that late shade maps count. Then DONE when enough cells have the wanted state
   or the rounds are used up; else begin a round over the pieces that still miss cells.

Sharing: one route over all pieces is cut into equal runs, so that vehicles sweep the field in the
same direction and meet only at the ends of runs. The runs are assigned to vehicles by the least
sum of distances to their starts (linear assignment; Kuhn 1955, as in `scipy.optimize`).
"""

from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from recon.guidance.survey.lattice import AlongAcross
from recon.guidance.survey.missions import Track, approach_of, flight_time_s, mission_of
from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.route import Cost, Route, between_m, route_of, shared
from recon.guidance.survey.rows import Piece
from recon.guidance.survey.segments import NewestForecast
from recon.guidance.survey.state import (
    NO_ROUTES,
    AssignedMission,
    Surveyor,
    SurveyState,
    end_between_rounds,
    has_settled,
    spent_budget,
)
from recon.model.arrays import FloatArray
from recon.model.survey import CellState, MissionAssignment, SurveyPhase, planner_goal

Step = tuple[SurveyState, tuple[MissionAssignment, ...]]


def fly_rounds(
    state: SurveyState, vehicles: Sequence[Surveyor], now_ns: int, wanted: CellState
) -> Step:
    """Return the next state and the missions to give, for cells up to the `wanted` state."""
    able = {each.serial: each for each in vehicles if each.is_available}
    state = without_ended_missions(state, able, now_ns)
    spent = spent_budget(state, wanted, now_ns)
    if spent is None:
        state, missions = _give_missions(state, able, now_ns)
        if missions:
            return replace(state, reason=f"round {state.round}"), missions
    if state.flights:
        return state, ()
    if spent is not None:
        is_over = has_settled(state, now_ns)
        return (ended(state, SurveyPhase.DONE, spent, now_ns) if is_over else state), ()
    free = {serial: each for serial, each in able.items() if serial not in state.barred}
    if not free:
        return wait_or_pause(state, able, now_ns), ()
    if state.waiting:
        return _share_again(state, free, now_ns)
    if not has_settled(state, now_ns):
        return state, ()
    end = end_between_rounds(state, wanted)
    if end is not None:
        return ended(state, SurveyPhase.DONE, end, now_ns), ()
    pieces = state.plan.pieces_over(state.missing(wanted))
    return _begin_round(state, pieces, free, now_ns)


def ended(state: SurveyState, phase: SurveyPhase, reason: str, now_ns: int) -> SurveyState:
    """Return the survey in a phase in which no vehicle flies for it."""
    return replace(
        state,
        phase=phase,
        reason=reason,
        flights=MappingProxyType({}),
        waiting=NO_ROUTES,
        decisions=MappingProxyType({}),
        ended_at_ns=now_ns if phase.is_final else None,
        quiet_since_ns=now_ns,
    )


def without_ended_missions(
    state: SurveyState, able: Mapping[str, Surveyor], now_ns: int
) -> SurveyState:
    """Return the survey without missions that have ended or whose vehicle has dropped out."""
    flights = {
        serial: flight
        for serial, flight in state.flights.items()
        if serial in able and able[serial].ended_mission < flight.number
    }
    quiet_ns = now_ns if state.flights and not flights else state.quiet_since_ns
    return replace(state, flights=MappingProxyType(flights), quiet_since_ns=quiet_ns)


def wait_or_pause(state: SurveyState, able: Mapping[str, Surveyor], now_ns: int) -> SurveyState:
    """Wait for an able vehicle, or pause when the missions of all were refused."""
    if not able:
        return replace(state, reason="waiting: no vehicle can fly now")
    serial = next(iter(able))
    reason = f"every mission was refused; {serial}: {state.refusals[serial].reason}"
    return ended(state, SurveyPhase.PAUSED, reason, now_ns)


def _share_again(state: SurveyState, free: Mapping[str, Surveyor], now_ns: int) -> Step:
    """Share left-over rows among able vehicles; wait while one is to be requested again."""
    if any(serial in free and now_ns < each.again_ns for serial, each in state.refusals.items()):
        return state, ()
    pieces = [leg.piece for route in state.waiting.values() for leg in route]
    return _hand_out(state, pieces, free, now_ns)


def _begin_round(
    state: SurveyState, pieces: Sequence[Piece], free: Mapping[str, Surveyor], now_ns: int
) -> Step:
    """Begin the next round over these pieces; without any mission it does not count as begun."""
    begun = replace(state, round=state.round + 1, reason=f"round {state.round + 1}")
    after, missions = _hand_out(begun, pieces, free, now_ns)
    if missions:
        return after, missions
    return replace(state, reason=after.reason), ()


def _hand_out(
    state: SurveyState, pieces: Sequence[Piece], free: Mapping[str, Surveyor], now_ns: int
) -> Step:
    """Share pieces and give the first missions; without any, change the reason only.

    If no battery lasts for a share, each vehicle alone is tried, the longest lasting first: the
    nearest of several may be the one that cannot fly a row.
    """
    by_battery = sorted(free.values(), key=lambda each: -(each.time_left_s or 0.0))
    for vehicles in (list(free.values()), *([each] for each in by_battery)):
        shared_out = MappingProxyType(shares(state.plan, pieces, vehicles))
        given, missions = _give_missions(replace(state, waiting=shared_out), free, now_ns)
        if missions:
            return replace(given, reason=f"round {state.round}"), missions
    reason = "waiting: no battery lasts for the next row, the path there and the return"
    return replace(state, reason=reason), ()


def shares(
    plan: SurveyPlan, pieces: Sequence[Piece], surveyors: Sequence[Surveyor]
) -> dict[str, Route]:
    """Return each vehicle's share of the pieces: runs of one route, by the nearest starts."""
    survey, settings = plan.survey, plan.settings
    cost = Cost(survey.speed_mps**2 / settings.turning_mps2, settings.least_cut_m)
    lying = plan.lattice.along_across_m([each.place_m for each in surveyors])
    middle_along_m, middle_across_m = lying.mean(axis=0).tolist()
    route = route_of(pieces, plan.lattice, (middle_along_m, middle_across_m))
    runs = shared(route, len(surveyors), plan.lattice, cost)
    places: list[AlongAcross] = [(along_m, across_m) for along_m, across_m in lying.tolist()]
    far_m = np.array([[between_m(run[:1], plan.lattice, at) for run in runs] for at in places])
    return {surveyors[vehicle].serial: runs[run] for vehicle, run in _nearest(far_m)}


def _nearest(far_m: FloatArray) -> list[tuple[int, int]]:
    """Return pairs (vehicle, run) with the least sum of the (vehicles, runs) distances."""
    if (far_m == far_m[0]).all():
        # From one place, as in plans, any pairs do: scipy takes half a second to import.
        return [(index, index) for index in range(min(far_m.shape))]
    from scipy.optimize import linear_sum_assignment

    vehicles, runs = linear_sum_assignment(far_m)
    return list(zip(vehicles.tolist(), runs.tolist(), strict=True))


def _give_missions(state: SurveyState, able: Mapping[str, Surveyor], now_ns: int) -> Step:
    """Give each idle vehicle as much of its share as its battery allows."""
    missions: list[MissionAssignment] = []
    for serial, route in state.waiting.items():
        if not may_ask(state, serial, able, now_ns):
            continue
        track, count = longest_mission(state.plan, route, able[serial])
        if track is None:
            continue
        number = state.missions + 1
        flight = AssignedMission(
            number, route[:count], track.corners_m, track.length_m, up_m=track.up_m
        )
        state, mission = assign(state, able[serial], flight, route[count:])
        missions.append(mission)
    return state, tuple(missions)


def may_ask(state: SurveyState, serial: str, able: Mapping[str, Surveyor], now_ns: int) -> bool:
    """Return whether a mission for a vehicle may be requested now."""
    if serial not in able or serial in state.flights or serial in state.barred:
        return False
    refused = state.refusals.get(serial)
    return refused is None or now_ns >= refused.again_ns


def assign(
    state: SurveyState, surveyor: Surveyor, flight: AssignedMission, rest: Route
) -> tuple[SurveyState, MissionAssignment]:
    """Return the survey with a vehicle on a mission, and that mission; `rest` waits for it."""
    survey, serial, frame = state.plan.survey, surveyor.serial, state.plan.frame
    purpose = f"survey {survey.name}: round {state.round}"
    track = Track(flight.corners_m, flight.up_m)
    mission = mission_of(track, survey, frame, purpose, surveyor.takeoff_up_m)
    approach = approach_of(track, surveyor.place_m, state.plan.paths, frame)
    waiting = {**state.waiting, serial: rest}
    if not rest:
        del waiting[serial]
    state = replace(
        state.with_flight(serial, flight),
        waiting=MappingProxyType(waiting),
        missions=flight.number,
        flown_m=state.flown_m + flight.length_m,
    )
    return state, MissionAssignment(serial, flight.number, mission, flight.length_m, approach)


def longest_mission(
    plan: SurveyPlan,
    route: Route,
    surveyor: Surveyor,
    may_fly: Callable[[Track], bool] | None = None,
) -> tuple[Track | None, int]:
    """Return the longest beginning of a route that the battery lasts for, and how many legs it has.

    It ends where there is no path on to the next row: what comes then is a mission of its own, and
    the gate judges the path there. It also ends before what `may_fly` rules out.
    """

    def track(count: int) -> Track | None:
        return plan.track(route[:count])

    too_many = range(1, len(route) + 1)

    def is_too_many(count: int) -> bool:
        found = track(count)
        is_flown = found is not None and (may_fly is None or may_fly(found))
        return not (is_flown and battery_lasts(plan, found, surveyor))

    count = bisect_left(too_many, True, key=is_too_many)
    return (track(count) if count else None), count


def battery_lasts(plan: SurveyPlan, track: Track | None, surveyor: Surveyor) -> bool:
    """Return whether there is a track and the battery lasts for it, and the paths there and
    home."""
    if track is None or surveyor.time_left_s is None:
        return track is not None
    home_m = surveyor.home_m or surveyor.place_m
    speed_mps = plan.survey.speed_mps
    needed_s = flight_time_s(track, speed_mps, surveyor.place_m, home_m, plan.settings)
    needed_s += surveyor.extra_corner_s * len(track.corners_m)
    return needed_s <= surveyor.time_left_s * plan.settings.flight_time_share


def lawnmower_once(
    state: SurveyState, vehicles: Sequence[Surveyor], _sun: NewestForecast, now_ns: int
) -> Step:
    """Fly all rows once, in whatever light; again only what was not imaged, as by a dropout."""
    return fly_rounds(state, vehicles, now_ns, planner_goal("lawnmower_once"))


def lawnmower_again(
    state: SurveyState, vehicles: Sequence[Surveyor], _sun: NewestForecast, now_ns: int
) -> Step:
    """Fly all rows, and again what was imaged in shade, until all is imaged in sun.

    It does not wait for sun: the survey's budget ends it under a closed sky.
    """
    return fly_rounds(state, vehicles, now_ns, planner_goal("lawnmower_again"))
