"""The life cycle of a survey.

Theory of operation. Phases and transitions (`model.survey.SurveyPhase`):

    CREATED  --start-->  RUNNING  --all cells imaged, or budget spent-->  DONE
                         RUNNING  --pause, or every mission refused---->  PAUSED
                         PAUSED   --start (also with other vehicles)--->  RUNNING
    CREATED, RUNNING, PAUSED  --abort--------------------------------->   ABORTED

DONE and ABORTED are final. While RUNNING, `step` is called about once a second with the positions
of the vehicles that can fly; the survey's planner then gives missions (`rounds`). Positions and
shade maps settle for `settle_s` before they count, as frames arrive and are read later; they count
while PAUSED too, since a vehicle may still be flying its row.

- Timeouts: a refused mission is requested again after `retry_s` if other vehicles fly. If none
  flies, the vehicle is barred until the next start, as nothing will change without a command. When
  all are barred the survey pauses. A refusal that may end without a command bars none, and is
  requested again after `retry_soon_s`; for how long, the caller decides. One for another vehicle in
  the way bars none either where the planner decides vehicle by vehicle: that vehicle, or the
  decision, changes.
- A vehicle drops out by not being able in `step`; its unimaged rows belong to the next round.
- A pause discards the round under way, since its shares fit the vehicles of that moment only.

Pausing and aborting do not command vehicles: the caller also sends hover to those in `flights`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import dist
from types import MappingProxyType

from recon.guidance.survey.closed_areas import ClosedArea
from recon.guidance.survey.photo_progress import count_settled_photos, with_photos
from recon.guidance.survey.plan import RULE, SurveyPlan
from recon.guidance.survey.planners import PLANNERS
from recon.guidance.survey.progress import (
    PhotoSample,
    PositionSample,
    count_settled,
    first_progress,
    with_positions,
    with_shade,
)
from recon.guidance.survey.rounds import Step, battery_lasts, ended
from recon.guidance.survey.route import Route, route_of
from recon.guidance.survey.segments import NewestForecast
from recon.guidance.survey.state import (
    AssignedMission,
    Decision,
    Refused,
    Surveyor,
    SurveyState,
    is_enough,
)
from recon.guidance.survey.vehicle_choice import named
from recon.model.command import Refusal
from recon.model.shade import ShadeMap
from recon.model.survey import SurveyPhase, planner_goal
from recon.model.units import seconds_to_ns

NOTHING_LEFT = (
    "nothing is left to fly: all reachable ground has been imaged since then; choose a later day, "
    "or fly all of it again"
)

PAUSED_BY_COMMAND = "paused"
"""The reason of a pause that was commanded; any other is why a survey has paused automatically."""


def create(plan: SurveyPlan) -> SurveyState | Refusal:
    """Return a survey ready to start, or a refusal."""
    name = plan.survey.planner
    if name not in PLANNERS:
        known = " or ".join(PLANNERS.names)
        return Refusal(RULE, f"Unknown planner {name}: choose {known}")
    state = SurveyState(plan, first_progress(plan))
    if plan.survey.flown is not None and is_enough(state, planner_goal(name)):
        return Refusal(RULE, NOTHING_LEFT)
    return state


def start(state: SurveyState, serials: Sequence[str], now_ns: int) -> SurveyState | Refusal:
    """Return the survey running with these vehicles; after a pause they may be others."""
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
    """Return the survey paused; the round under way does not count and is planned again."""
    if state.phase is not SurveyPhase.RUNNING:
        return _wrong_phase(state, "paused")
    was_flying = bool(state.flights or state.waiting)
    unflown_m = sum(flight.unflown_m for flight in state.flights.values())
    state = replace(state, flown_m=max(0.0, state.flown_m - unflown_m))
    paused = ended(state, SurveyPhase.PAUSED, PAUSED_BY_COMMAND, now_ns)
    return replace(paused, round=state.round - was_flying, refusals=MappingProxyType({}))


def abort(state: SurveyState, now_ns: int) -> SurveyState | Refusal:
    """Return the survey aborted for good; coverage is kept."""
    if state.phase.is_final:
        return _wrong_phase(state, "aborted")
    return ended(state, SurveyPhase.ABORTED, "aborted", now_ns)


def refused(
    state: SurveyState,
    serial: str,
    number: int,
    reason: str,
    now_ns: int,
    *,
    may_end: bool = False,
    in_the_way: bool = False,
    waits_for: str = "",
) -> SurveyState:
    """Return the survey after the gate refused a mission; its rows stay with the vehicle.

    `may_end`: the reason may end without a command. `in_the_way`: another vehicle is in its way, of
    the name `waits_for` where that is known.

    - A mission that was to replace another one: the other one is flown on.
    - `may_end`: the next one is requested after `retry_soon_s`.
    - `in_the_way`, and chosen for this vehicle alone: half of its rows are requested at once.
    - Otherwise, while others fly, the next one is requested after `retry_s`, or `retry_soon_s` if
      it was chosen for this vehicle alone. If none flies, the vehicle is barred and its rows go to
      others; with all barred the survey pauses.
    """
    flight = state.flights.get(serial)
    if flight is None or flight.number != number:
        return state
    if flight.replaces is not None:
        return _fly_on(state, serial, flight, flight.replaces, now_ns)
    state = state.without_flight(serial)
    finds_others = in_the_way and flight.is_chosen
    is_barred = not (state.flights or may_end or finds_others)
    route = (*flight.route, *state.waiting.get(serial, ()))
    refusal = _refusal(state, flight, reason, now_ns, may_end=may_end, finds_others=finds_others)
    refusal = replace(refusal, waits_for=waits_for)
    decisions = {key: each for key, each in state.decisions.items() if key != serial}
    others = {key: each for key, each in state.waiting.items() if key != serial}
    waiting = {**others, serial: route} if route else others
    return replace(
        state,
        waiting=MappingProxyType(waiting),
        refusals=MappingProxyType({**state.refusals, serial: refusal}),
        barred=state.barred | {serial} if is_barred else state.barred,
        decisions=MappingProxyType(decisions),
        flown_m=max(0.0, state.flown_m - flight.length_m),
    )


def _refusal(
    state: SurveyState,
    flight: AssignedMission,
    reason: str,
    now_ns: int,
    *,
    may_end: bool,
    finds_others: bool,
) -> Refused:
    """The refusal of a mission: when the next one may be requested, and of how many rows."""
    settings, half = state.plan.settings, len(flight.route) // 2
    if finds_others and half:
        return Refused(reason, now_ns, half)
    wait_s = settings.retry_soon_s if may_end or flight.is_chosen else settings.retry_s
    return Refused(reason, now_ns + seconds_to_ns(wait_s))


def _fly_on(
    state: SurveyState, serial: str, refused: AssignedMission, kept: AssignedMission, now_ns: int
) -> SurveyState:
    """The survey with the mission that a refused one was to replace."""
    text = f"flies on with {named(kept.rows_left, state.plan)}: other rows were refused"
    again_ns = now_ns + seconds_to_ns(state.plan.settings.retry_soon_s)
    # What was asked once, when light became known, is not asked again.
    kept = replace(kept, is_in_any_light=False)
    state = state.with_flight(serial, kept).with_decision(serial, Decision(text, again_ns))
    return replace(state, flown_m=state.flown_m - refused.length_m + kept.unflown_m)


def observe(
    state: SurveyState, serial: str, seen: Sequence[PositionSample | PhotoSample]
) -> SurveyState:
    """Return the survey after positions or photos of a vehicle; other vehicles change nothing.

    They count while running and paused, not before the start or after the end.
    """
    if serial not in state.serials or state.phase.is_final:
        return state
    places = [each for each in seen if isinstance(each, PositionSample)]
    photos = [each for each in seen if isinstance(each, PhotoSample)]
    progress = with_positions(state.progress, serial, places, state.plan) if places else None
    return replace(state, progress=with_photos(progress or state.progress, photos))


def observe_shade(state: SurveyState, shade: ShadeMap) -> SurveyState:
    """Return the survey after a shade map."""
    if state.phase.is_final:
        return state
    return replace(state, progress=with_shade(state.progress, shade, state.plan))


def step(
    state: SurveyState,
    vehicles: Sequence[Surveyor],
    now_ns: int,
    sun: NewestForecast = lambda: None,
    closed: Sequence[ClosedArea] = (),
) -> Step:
    """Return the next state and the missions to give; called about once a second.

    Vehicles of other surveys are ignored; vehicles without a position count as dropped out.
    `closed` is where vehicles without telemetry may be now.
    """
    if state.phase not in (SurveyPhase.RUNNING, SurveyPhase.PAUSED):
        return state, ()
    progress = count_settled(state.progress, state.plan, now_ns)
    progress = count_settled_photos(progress, state.plan, now_ns)
    state = replace(state, progress=progress, closed=tuple(closed))
    if state.phase is SurveyPhase.PAUSED:
        return state, ()
    own = [_as_available(each, state.plan) for each in vehicles if each.serial in state.serials]
    return PLANNERS[state.plan.survey.planner](state, own, sun, now_ns)


def _as_available(surveyor: Surveyor, plan: SurveyPlan) -> Surveyor:
    """A vehicle whose takeoff height is not known cannot fly above ground."""
    is_lost = plan.terrain is not None and surveyor.takeoff_up_m is None
    return replace(surveyor, is_available=False) if is_lost else surveyor


def _wrong_phase(state: SurveyState, asked: str) -> Refusal:
    return Refusal(
        RULE, f"the survey {state.plan.survey.name} is {state.phase.value} and cannot be {asked}"
    )


NO_BATTERY = "its battery is too low for any row that is left"


def returning(state: SurveyState, vehicles: Sequence[Surveyor]) -> Mapping[str, str]:
    """Return the serials of idle, able vehicles that should fly home, each with the reason.

    Those that their planner decided to change the battery of, and those whose battery does not last
    for any row left. Vehicles with unknown flight time are never among the latter: then only the
    gate checks the battery.
    """
    if state.phase is not SurveyPhase.RUNNING:
        return {}
    reasons: dict[str, str] = {}
    for each in vehicles:
        if (
            not each.is_available
            or each.serial in state.flights
            or each.serial not in state.serials
        ):
            continue
        decision = state.decisions.get(each.serial)
        if decision is not None and decision.returns:
            reasons[each.serial] = decision.text
        elif each.time_left_s is not None and not _can_fly_a_row(state, each):
            reasons[each.serial] = NO_BATTERY
    return reasons


def _can_fly_a_row(state: SurveyState, surveyor: Surveyor) -> bool:
    """Whether the battery lasts for the next row, or to wait for one and then return."""
    plan, own = state.plan, state.waiting.get(surveyor.serial)
    if own:
        return _lasts_for_any(state, own[:1], surveyor)
    # While others fly, the rows they will leave are unknown: wait for them.
    legs = () if state.flights else _rows_left(state, surveyor)
    if legs:
        return _lasts_for_any(state, legs, surveyor)
    assert surveyor.time_left_s is not None  # asked only with a known flight time
    path_m = dist(surveyor.place_m, surveyor.home_m or surveyor.place_m)
    needed_s = path_m / plan.survey.speed_mps + plan.settings.route_home_waits_s
    return needed_s <= surveyor.time_left_s * plan.settings.flight_time_share


def _rows_left(state: SurveyState, surveyor: Surveyor) -> Route:
    """Return the rows left for any vehicle; between rounds those of the next one."""
    waiting = tuple(leg for route in state.waiting.values() for leg in route)
    if waiting:
        return waiting
    plan = state.plan
    pieces = plan.pieces_over(state.missing())
    start_m = plan.lattice.along_across_of(surveyor.place_m)
    return route_of(pieces, plan.lattice, start_m) if pieces else ()


def _lasts_for_any(state: SurveyState, legs: Route, surveyor: Surveyor) -> bool:
    plan = state.plan
    tracks = (plan.track((leg,)) for leg in legs)
    return any(battery_lasts(plan, track, surveyor) for track in tracks)
