"""A planner that flies what is in sun, and what will be, before what is in shade.

Theory of operation. No vehicle waits for another: one whose mission has ended is decided on at
once. One call of `sunlit_first`:

1. Missions of vehicles that ended or dropped out are removed; their rows count as flown until their
   photos have counted.
2. Without known light it is `lawnmower_once`: rows are flown in whatever light, until it is known.
   A vehicle that is still on its way to its first row by then is decided on as at the end of a row.
3. In the first seconds no forecast knows how the shadows move, and what lies in sun now seems to
   stay there. Where some ground lies in sun, a round of the lawnmower begins at once, so that the
   climb loses no time; a vehicle before its first row is decided on when the motion is known, as
   at the end of a row. Elsewhere the vehicles wait on the ground until then.
4. The survey is done when enough is imaged in sun, or its budget is spent, and all have ended.
5. For each vehicle without a mission: its **share** of the missing ground is what it would fly if
   all finished at the same time, in rows side by side, so that vehicles keep apart. Over its share
   the best flight is searched (`search`): which parts of rows, in which order and direction, when.
6. If that begins at once, the vehicle gets its rows up to `committed_s` as a mission. If it begins
   later, the vehicle goes to its first row and stands by in its layer; one on the ground stays
   there until it is time to take off, and until sun is probable on what it flies first. If nothing
   is expected in sun, it waits where it is.
7. One that would wait lands at home instead where that costs little sun: with a good battery to
   wait on the ground, with a low one if a change of battery costs less sun now than later.
   One that waits at the rows' height climbs or sinks to its layer first, out of others' rows.
8. Rows where a vehicle without telemetry may be are excluded, and its own rows: the gate would
   refuse them. They are flown once it is in contact again, or dismissed by an operator.
9. Missions may be replaced under way, mostly at the end of a row (`mission_changes`).
10. If no vehicle is busy and a round of the lawnmower would image most of what is missing in
   sun, by the forecast at the moments at which it would pass, that round is flown, also where more
   would be in sun after some seconds: choosing takes longer.

Each decision leaves a sentence. What a forecast does not know is its prior, so flights over ground
whose light is unknown are worth something, and rows in shade are flown when nothing else is left:
under broken cloud it costs battery alone, and sometimes sun comes.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from recon.guidance.survey.closed_areas import closed_ground, closed_segments
from recon.guidance.survey.mission_changes import (
    before_first_row_in_any_light,
    decide_at_row_end,
    decide_in_known_light,
    leave_closed_ground,
    on_closed_ground,
    with_ends_passed,
)
from recon.guidance.survey.passing import Passing
from recon.guidance.survey.rounds import (
    Step,
    ended,
    fly_rounds,
    may_ask,
    shares,
    wait_or_pause,
    without_ended_missions,
)
from recon.guidance.survey.segments import (
    ExpectedSun,
    NewestForecast,
    Segments,
    expected_sun,
    segments_of,
)
from recon.guidance.survey.state import (
    NO_ROUTES,
    Decision,
    Routes,
    Surveyor,
    SurveyState,
    end_between_rounds,
    flown_just_now,
    has_settled,
    is_enough,
    spent_budget,
)
from recon.guidance.survey.vehicle_choice import (
    WANTED,
    VehicleChoice,
    just_flown_legs,
    missing_pieces,
    named,
)
from recon.model.shade import SURE, SunForecast
from recon.model.survey import CellState, MissionAssignment, SurveyPhase
from recon.model.units import seconds_to_ns


@dataclass(frozen=True, slots=True, eq=False)
class PlanningMoment:
    """What all decisions of one call share; `able` are the vehicles that can fly, by serial."""

    segments: Segments
    expected: ExpectedSun
    able: Mapping[str, Surveyor]
    sun: SunForecast | None
    now_ns: int

    @classmethod
    def of(
        cls,
        state: SurveyState,
        able: Mapping[str, Surveyor],
        sun: SunForecast | None,
        now_ns: int,
    ) -> "PlanningMoment | None":
        """Return what is expected now, nothing on closed ground; None if light is unknown."""
        segments = segments_of(state.plan)
        expected = expected_sun(segments, state.plan, state.progress, sun, now_ns)
        if expected is None:
            return None
        if state.closed:
            is_closed = closed_segments(closed_ground(state.closed), segments, state.plan)
            expected = replace(expected, missing_m2=np.where(is_closed, 0.0, expected.missing_m2))
        return cls(segments, expected, able, sun, now_ns)

    def choice(self, state: SurveyState, serial: str) -> VehicleChoice:
        """Return what one vehicle may do."""
        able = tuple(self.able.values())
        return VehicleChoice(
            state, self.segments, self.expected, able, self.able[serial], self.now_ns
        )

    def idle(self, state: SurveyState) -> list[str]:
        """Return the vehicles that are to be decided on."""
        return [each for each in self.able if _may_decide(state, each, self.able, self.now_ns)]


Begun = Callable[[SurveyState, PlanningMoment], Step]
"""Gives missions to idle vehicles."""


def sunlit_first(
    state: SurveyState, vehicles: Sequence[Surveyor], sun: NewestForecast, now_ns: int
) -> Step:
    """Fly what is in sun first, wait for the rest near where it will come, until all is in sun."""
    return vehicle_by_vehicle(state, vehicles, sun, now_ns, _decide_idle)


def vehicle_by_vehicle(
    state: SurveyState,
    vehicles: Sequence[Surveyor],
    sun: NewestForecast,
    now_ns: int,
    begun: Begun,
) -> Step:
    """Fly until all is in sun, without waiting for one another; `begun` gives the missions."""
    able = {each.serial: each for each in vehicles if each.is_available}
    state = _with_just_flown(state, without_ended_missions(state, able, now_ns), now_ns)
    # One that could not fly meanwhile is decided on anew.
    decided = {key: each for key, each in state.decisions.items() if key in able}
    state = replace(state, decisions=MappingProxyType(decided))
    is_done, spent = is_enough(state, WANTED), spent_budget(state, WANTED, now_ns)
    end = end_between_rounds(state, WANTED) if is_done else spent
    if end is not None:
        is_over = not state.flights and (is_done or has_settled(state, now_ns))
        return (ended(state, SurveyPhase.DONE, end, now_ns) if is_over else state), ()
    if not state.flights and able.keys() <= state.barred:
        return wait_or_pause(state, able, now_ns), ()
    state, at_end = with_ends_passed(state, able)
    closed = on_closed_ground(state, able, now_ns)
    in_any_light = before_first_row_in_any_light(state, able)
    is_asked = any(_may_decide(state, serial, able, now_ns) for serial in able)
    if not (is_asked or at_end or closed or in_any_light):
        return state, ()
    moment = PlanningMoment.of(state, able, sun(), now_ns)
    if moment is None:
        return _fly_in_any_light(state, vehicles, now_ns)
    state = replace(state, waiting=NO_ROUTES, round=max(1, state.round), reason="under way")
    state, instead = _replace_missions(state, moment, closed, at_end, in_any_light)
    state, missions = begun(state, moment)
    return state, (*instead, *missions)


def _replace_missions(
    state: SurveyState,
    moment: PlanningMoment,
    closed: Sequence[str],
    at_end: Sequence[str],
    in_any_light: Sequence[str],
) -> Step:
    """Replace missions under way, where that is worth it."""
    missions: tuple[MissionAssignment, ...] = ()
    if _lacks_motion(state, moment.sun, moment.now_ns):
        in_any_light = ()
    for serial in dict.fromkeys((*closed, *at_end, *in_any_light)):
        choice = moment.choice(state, serial)
        if serial in closed:
            state, new = leave_closed_ground(choice)
        elif serial in at_end:
            state, new = decide_at_row_end(choice, moment.able)
        else:
            state, new = decide_in_known_light(choice, moment.able)
        missions += new
    return state, missions


def _decide_idle(state: SurveyState, moment: PlanningMoment) -> Step:
    """Begin a round that is worth it, or what is best for each vehicle alone."""
    choices = [moment.choice(state, serial) for serial in moment.idle(state)]
    if not choices:
        return state, ()
    whole = _round(choices) if len(choices) == len(moment.able) else None
    rows = whole.rows if whole is not None and whole.is_worth else NO_ROUTES
    is_unsure = not state.missions and _lacks_motion(state, moment.sun, moment.now_ns)
    if is_unsure:
        if whole is None or not whole.begins_in_sun:
            return replace(state, reason="waiting: how shadows move is not known yet"), ()
        rows = whole.rows
    missions: tuple[MissionAssignment, ...] = ()
    for each in choices:
        choice = replace(each, state=state)
        own = rows.get(choice.surveyor.serial)
        state, mission = choice.decide() if own is None else choice.fly_all(own)
        missions += mission
    return _decided_again(state) if is_unsure else state, missions


def _decided_again(state: SurveyState) -> SurveyState:
    """Have all missions with rows decided on once more before their first rows."""
    for serial, flight in state.flights.items():
        state = state.with_flight(serial, replace(flight, is_in_any_light=bool(flight.route)))
    return state


@dataclass(frozen=True, slots=True)
class _Round:
    """A round of the lawnmower over all that is missing, with each vehicle's rows."""

    rows: Routes
    begins_in_sun: bool
    """What is flown first has enough sun to take off for."""
    is_worth: bool
    """It begins in sun, and most of it is in sun when they pass. That more would be after some
    seconds is no reason not to fly it: then each vehicle chooses by itself, which takes longer."""


def _round(choices: Sequence[VehicleChoice]) -> _Round | None:
    """Return a round that all vehicles would begin now; None if nothing is free."""
    state, segments, expected = choices[0].state, choices[0].segments, choices[0].expected
    is_free = (expected.missing_m2 > 0.0) & ~segments.under(just_flown_legs(state))
    if not is_free.any():
        return None
    settings, surveyors = state.plan.settings, [each.surveyor for each in choices]
    rows = shares(state.plan, missing_pieces(state, segments, is_free), surveyors)
    passed = [each.passing(rows.get(each.surveyor.serial, ())) for each in choices]
    first = [each.until(settings.committed_s) for each in passed]
    lit_share, lit_first = _lit_share(passed, expected), _lit_share(first, expected)
    begins_in_sun = lit_first >= settings.takeoff_probability
    return _Round(rows, begins_in_sun, begins_in_sun and lit_share >= settings.round_sun_share)


def _lit_share(passed: Sequence[Passing], expected: ExpectedSun) -> float:
    """Return the share of the ground passed that is expected in sun by then."""
    passed_m2 = sum(each.missing_m2 for each in passed)
    return sum(each.lit_m2(expected) for each in passed) / max(passed_m2, 1.0)


def _lacks_motion(state: SurveyState, sun: SunForecast | None, now_ns: int) -> bool:
    """Whether the shadows' motion is not known yet and may be in some seconds."""
    if sun is None or sun.velocity_mps is not None:
        return False
    settings = state.plan.settings
    in_view = np.isfinite(sun.horizon_s)
    is_lit = in_view & (sun.sun_probability[0] > SURE / 2)
    if is_lit.sum() >= settings.clear_view * in_view.sum():
        return False
    began_ns = state.started_at_ns if state.started_at_ns is not None else now_ns
    return now_ns < began_ns + seconds_to_ns(settings.motion_within_s)


def _fly_in_any_light(state: SurveyState, vehicles: Sequence[Surveyor], now_ns: int) -> Step:
    """Fly what is not imaged yet; then wait for light to become known, if it ever was."""
    kept = {key: each for key, each in state.decisions.items() if key in state.flights}
    state = replace(state, decisions=MappingProxyType(kept))
    # This planner has no rounds: however often light is lost, none is used up.
    uncounted = replace(state, round=int(bool(state.flights or state.waiting)))
    if not is_enough(state, CellState.IN_SHADE):
        state, missions = fly_rounds(uncounted, vehicles, now_ns, CellState.IN_SHADE)
        for serial in dict.fromkeys(mission.serial for mission in missions):
            flight = replace(state.flights[serial], is_in_any_light=True)
            # It is shown for minutes, and stays true when light is known meanwhile.
            text = f"flies {named(flight.route, state.plan)}; light not known yet"
            state = state.with_flight(serial, flight).with_decision(serial, Decision(text))
        return replace(state, reason="under way") if missions else state, missions
    if state.flights:
        return state, ()
    end = end_between_rounds(uncounted, WANTED)
    if end is not None:
        return ended(state, SurveyPhase.DONE, end, now_ns), ()
    return replace(state, reason="waiting: the light over the field is not known now"), ()


def _with_just_flown(before: SurveyState, state: SurveyState, now_ns: int) -> SurveyState:
    """Keep the rows of missions that have just ended until their photos have counted."""
    settings = state.plan.settings
    kept = {key: each for key, each in state.just_flown.items() if now_ns < each.until_ns}
    # One without telemetry may still fly them.
    lost = {each.serial for each in state.closed}
    kept |= {key: each for key, each in state.just_flown.items() if key in lost}
    for serial, flight in before.flights.items():
        if serial not in state.flights and flight.route:
            kept[serial] = flown_just_now(flight.route, settings, now_ns)
    return replace(state, just_flown=MappingProxyType(kept))


def _may_decide(state: SurveyState, serial: str, able: Mapping[str, Surveyor], now_ns: int) -> bool:
    decision = state.decisions.get(serial)
    return may_ask(state, serial, able, now_ns) and (
        decision is None or now_ns >= decision.again_ns
    )
