"""Missions replaced under way: what was decided when they began may be wrong by then.

Theory of operation. A mission that leads over ground that has been closed since, because a vehicle
there has lost its link, is replaced at once by one over other ground: else the station would hold
its vehicle when it comes near. When a vehicle reaches the end of a row and its mission has more:

1. If much of what is left is expected in shade, the best flight from here is searched, over all
   that is free without this mission. It is flown instead if it brings so much more ground into sun
   in the same time that a new mission is worth it.
2. Else, if another vehicle has nothing to fly, or flies in shade, and little that is free is in
   sun, the farther half of what is left is handed on: the mission is replaced by one of the nearer
   half. The other vehicle finds the rest when it is asked, or at the end of its row.

Otherwise the mission is flown on; so it is if the gate refuses the new one (`life.refused`). An end
that no position has come near to, as without telemetry, ends this for the mission.
"""

from collections.abc import Mapping
from dataclasses import replace
from itertools import accumulate
from math import hypot
from types import MappingProxyType

from recon.guidance.survey.cells import BoolArray
from recon.guidance.survey.closed_areas import closed_ground, is_open
from recon.guidance.survey.missions import Track
from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.rounds import may_ask
from recon.guidance.survey.route import Place, Route
from recon.guidance.survey.search import PlannedLeg
from recon.guidance.survey.state import AssignedMission, JustFlown, Surveyor, SurveyState
from recon.guidance.survey.vehicle_choice import VehicleChoice, flown_text, named
from recon.model.survey import MissionAssignment
from recon.model.units import seconds_to_ns

Replaced = tuple[SurveyState, tuple[MissionAssignment, ...]]


def with_ends_passed(
    state: SurveyState, able: Mapping[str, Surveyor]
) -> tuple[SurveyState, tuple[str, ...]]:
    """Return the survey with the ends of rows that vehicles have reached, and the serials of those
    that have just flown a row and have others left."""
    flights, at_end = dict(state.flights), []
    for serial, flight in state.flights.items():
        if serial not in able:
            continue
        passed = _ends_passed(flight, able[serial].place_m, state.plan)
        if passed == flight.ends_passed:
            continue
        flights[serial] = replace(flight, ends_passed=passed)
        if passed % 2 == 0 and flights[serial].rows_left:
            at_end.append(serial)
    return replace(state, flights=MappingProxyType(flights)), tuple(at_end)


def _ends_passed(flight: AssignedMission, place_m: Place, plan: SurveyPlan) -> int:
    ((along_m, across_m),) = plan.lattice.along_across_m([place_m]).tolist()
    ends = [end for leg in flight.route for end in leg.ends_m(plan.lattice, plan.swath.lead_m)]
    passed = flight.ends_passed
    while passed < len(ends):
        end_along_m, end_across_m = ends[passed]
        if hypot(end_along_m - along_m, end_across_m - across_m) > plan.settings.at_end_m:
            break
        passed += 1
    return passed


def on_closed_ground(
    state: SurveyState, able: Mapping[str, Surveyor], now_ns: int
) -> tuple[str, ...]:
    """Return the serials of vehicles whose missions lead over closed ground."""
    least_s = state.plan.settings.closed_from_s
    closed = [each for each in state.closed if each.lost_s >= least_s]
    if not closed:
        return ()
    ground, lead_m = closed_ground(closed), state.plan.swath.lead_m
    lost, found = {each.serial for each in state.closed}, []
    for serial, flight in state.flights.items():
        decision = state.decisions.get(serial)
        is_lost = serial not in able or serial in lost
        if is_lost or decision is None or now_ns < decision.again_ns:
            continue
        ends = [end for leg in flight.route for end in leg.ends_m(state.plan.lattice, lead_m)]
        left = ends[flight.ends_passed :]
        way_m = state.plan.lattice.east_north_m(left).tolist() if left else []
        is_out = is_open(ground, Track((able[serial].place_m,)))
        if way_m and is_out and not is_open(ground, Track(tuple((e, n) for e, n in way_m))):
            found.append(serial)
    return tuple(found)


def off_closed_ground(choice: VehicleChoice) -> Replaced:
    """Fly rows over open ground instead of a mission that leads over closed ground."""
    state, serial, now_ns = choice.state, choice.surveyor.serial, choice.now_ns
    flight, names = state.flights[serial], ", ".join(each.name for each in state.closed)
    alone = replace(choice, state=_without(state, serial, flight, now_ns))
    free = alone.free()
    rows: Route = ()
    if free.any():
        share = alone.share(free)
        is_clear = alone.expected.is_clear(share, alone.settings.clear_from)
        rows = alone.rows(share) if is_clear else alone.long_enough(_begun_at_once(alone, share))
    if rows:
        text = f"keeps clear of {names}, without telemetry; flies {named(rows)}"
        replaced_by = _instead(alone, flight, rows, text)
        if replaced_by[1]:
            return replaced_by
    again_ns = now_ns + seconds_to_ns(choice.settings.decided_again_s)
    decision = replace(state.decisions[serial], again_ns=again_ns)
    decisions = MappingProxyType({**state.decisions, serial: decision})
    return replace(state, decisions=decisions), ()


def at_row_end(choice: VehicleChoice, able: Mapping[str, Surveyor]) -> Replaced:
    """Replace the mission of a vehicle at the end of a row, if that is worth it."""
    state, serial, now_ns = choice.state, choice.surveyor.serial, choice.now_ns
    flight = state.flights[serial]
    left = choice.passing(flight.rows_left, 0.0)
    if left.lit_m2(choice.expected) < choice.settings.kept_from * left.missing_m2:
        alone = replace(choice, state=_without(state, serial, flight, now_ns))
        return _in_more_sun(alone, choice, flight)
    kept = _nearer_half(flight.rows_left, state)
    others = _in_want_of_sun(choice, able, left.lit_m2(choice.expected)) if kept else set()
    if not others:
        return state, ()
    text = f"hands on half of its rows; flies {named(kept)}"
    return _instead(replace(choice, state=_asked_now(state, others)), flight, kept, text)


def _in_want_of_sun(choice: VehicleChoice, able: Mapping[str, Surveyor], lit_m2: float) -> set[str]:
    """The vehicles without a mission, or with one in shade, while little that is free is in sun."""
    state, expected, settings = choice.state, choice.expected, choice.settings
    free = choice.free()
    soon = expected.moments_s <= settings.way_s
    sun = expected.probability[free][:, soon].mean(axis=1)
    if float(expected.missing_m2[free] @ sun) > settings.little_free * lit_m2:
        return set()
    found = {serial for serial in able if may_ask(state, serial, able, choice.now_ns)}
    found -= {serial for serial, each in state.decisions.items() if each.returns}
    for serial, flight in state.flights.items():
        if serial in able and serial != choice.surveyor.serial:
            left = replace(choice, surveyor=able[serial]).passing(flight.rows_left, 0.0)
            if left.lit_m2(expected) < settings.in_want_below * left.missing_m2:
                found.add(serial)
    return found


def _asked_now(state: SurveyState, serials: set[str]) -> SurveyState:
    decisions = {
        serial: replace(each, again_ns=0) if serial in serials else each
        for serial, each in state.decisions.items()
    }
    return replace(state, decisions=MappingProxyType(decisions))


def _nearer_half(rows: Route, state: SurveyState) -> Route:
    """The rows to keep of several; none if handing on takes longer than it saves."""
    long_m = list(accumulate(leg.piece.length_m for leg in rows))
    saved_s = long_m[-1] / 2.0 / state.plan.survey.speed_mps
    if len(rows) < 2 or saved_s < state.plan.settings.handed_on_s:
        return ()
    kept = 1 + sum(each < long_m[-1] / 2.0 for each in long_m)
    return rows[: min(kept, len(rows) - 1)]


def _in_more_sun(alone: VehicleChoice, choice: VehicleChoice, flight: AssignedMission) -> Replaced:
    """Fly what is in sun instead of what is left, if that is worth a new mission."""
    settings, expected = alone.settings, alone.expected
    left, free = alone.passing(flight.rows_left, 0.0), alone.free()
    if not free.any():
        return choice.state, ()
    legs = _begun_at_once(alone, alone.share(free))
    if not legs:
        return choice.state, ()
    until_s = legs[-1].until_s
    gained_m2 = sum(
        leg.probability * float(expected.missing_m2[list(leg.segments)].sum()) for leg in legs
    ) - sum(
        each.missing_m2 * expected.at(each.segment, each.at_s)
        for each in left.passes
        if each.at_s <= until_s
    )
    plan = choice.plan
    flown_m2 = plan.survey.speed_mps * plan.lattice.spacing_m * until_s
    if gained_m2 < settings.replaced_from * flown_m2:
        return choice.state, ()
    return _instead(alone, flight, alone.long_enough(legs), f"leaves its rows; {flown_text(legs)}")


def _begun_at_once(alone: VehicleChoice, share: BoolArray) -> tuple[PlannedLeg, ...]:
    """The legs of the best flight over a share; none if that would wait."""
    best = alone.best(share)
    return alone.committed(best) if best.legs and best.waits_s <= 0.0 else ()


def _instead(choice: VehicleChoice, flight: AssignedMission, rows: Route, text: str) -> Replaced:
    """Fly these rows instead of the mission's."""
    serial = choice.surveyor.serial
    own = _without(choice.state, serial, flight, choice.now_ns)
    state, missions = replace(choice, state=own).flies(rows, text)
    if not missions or serial not in state.flights:
        flights = MappingProxyType({**choice.state.flights, serial: flight})
        return replace(choice.state, flights=flights), ()
    new = replace(state.flights[serial], replaces=replace(flight, replaces=None))
    flights = MappingProxyType({**state.flights, serial: new})
    return replace(state, flights=flights, flown_m=state.flown_m - flight.unflown_m), missions


def _without(state: SurveyState, serial: str, flight: AssignedMission, now_ns: int) -> SurveyState:
    """The survey without the mission; what it has flown counts as just flown."""
    until_ns = now_ns + seconds_to_ns(state.plan.settings.settle_s + 2.0)
    flown = JustFlown(flight.route[: flight.ends_passed // 2], until_ns)
    flights = {key: each for key, each in state.flights.items() if key != serial}
    return replace(
        state,
        flights=MappingProxyType(flights),
        just_flown=MappingProxyType({**state.just_flown, serial: flown}),
    )
