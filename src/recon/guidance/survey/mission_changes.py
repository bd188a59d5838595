"""Missions replaced under way: what was decided when they began may be wrong by then.

Theory of operation. A mission that leads over ground that has been closed since, because a vehicle
there has lost its link, is replaced at once by one over other ground: else the station would hold
its vehicle when it comes near. One of a vehicle in the air whose first row is still ahead is
decided on anew each time that more becomes known: light, and how shadows move. Missions begin
without, as waiting for it on the ground gains nothing, and under a clear sky no motion is ever
seen. Others are looked at when their vehicle reaches the end of a row and has more:

1. If much of what is left is expected in shade, or its rows are short and far apart, the best
   flight from here is searched, over all that is free without this mission. It is flown instead if
   it brings so much more ground into sun in the same time that a new mission is worth it.
2. Else, if another vehicle has nothing to fly, or flies in shade, and little that is free is in
   sun, the farther half of what is left is handed on: the mission is replaced by one of the nearer
   half. The other vehicle finds the rest when it is asked, or at the end of its row.

Otherwise the mission is flown on; so it is if the gate refuses the new one (`life.refused`). An end
that no position has come near to, as without telemetry, ends this for the mission.
"""

from collections.abc import Mapping
from dataclasses import replace
from itertools import accumulate
from types import MappingProxyType

from recon.guidance.survey.closed_areas import closed_ground, is_open
from recon.guidance.survey.missions import Track, apart_m
from recon.guidance.survey.passing import Passing
from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.rounds import may_ask
from recon.guidance.survey.route import Place, Route
from recon.guidance.survey.search import Flight
from recon.guidance.survey.segments import Known
from recon.guidance.survey.state import (
    AssignedMission,
    Decision,
    Surveyor,
    SurveyState,
    flown_just_now,
)
from recon.guidance.survey.vehicle_choice import VehicleChoice, flown_text, named
from recon.model.survey import MissionAssignment
from recon.model.units import seconds_to_ns

Replaced = tuple[SurveyState, tuple[MissionAssignment, ...]]


def with_ends_passed(
    state: SurveyState, able: Mapping[str, Surveyor]
) -> tuple[SurveyState, tuple[str, ...]]:
    """Return the survey with the ends of rows that vehicles have reached, and the serials of those
    that have just flown a row and have others left."""
    at_end = []
    for serial, flight in state.flights.items():
        if serial not in able:
            continue
        passed = _ends_passed(flight, able[serial].place_m, state.plan)
        if passed == flight.ends_passed:
            continue
        flight = replace(flight, ends_passed=passed)
        state = state.with_flight(serial, flight)
        if passed % 2 == 0 and flight.rows_left:
            at_end.append(serial)
    return state, tuple(at_end)


def _ends_passed(flight: AssignedMission, place_m: Place, plan: SurveyPlan) -> int:
    passed = flight.ends_passed
    for end_m in _ends_left_m(flight, plan):
        if apart_m(end_m, place_m) > plan.settings.at_end_m:
            break
        passed += 1
    return passed


def _ends_left_m(flight: AssignedMission, plan: SurveyPlan) -> list[Place]:
    """East-north: the beginnings and ends of rows that the vehicle has not come to yet."""
    ends = [end for leg in flight.route for end in leg.ends_m(plan.lattice, plan.swath.lead_m)]
    left = ends[flight.ends_passed :]
    if not left:
        return []
    return [(east_m, north_m) for east_m, north_m in plan.lattice.east_north_m(left).tolist()]


def on_closed_ground(
    state: SurveyState, able: Mapping[str, Surveyor], now_ns: int
) -> tuple[str, ...]:
    """Return the serials of vehicles whose missions lead over closed ground."""
    least_s = state.plan.settings.closed_from_s
    closed = [each for each in state.closed if each.lost_s >= least_s]
    if not closed:
        return ()
    ground, lost = closed_ground(closed), {each.serial for each in state.closed}
    found = []
    for serial, flight in state.flights.items():
        decision = state.decisions.get(serial)
        is_lost = serial not in able or serial in lost
        if is_lost or decision is None or now_ns < decision.again_ns:
            continue
        way_m = tuple(_ends_left_m(flight, state.plan))
        is_out = is_open(ground, Track((able[serial].place_m,)))
        if way_m and is_out and not is_open(ground, Track(way_m)):
            found.append(serial)
    return tuple(found)


def off_closed_ground(choice: VehicleChoice) -> Replaced:
    """Fly rows over open ground instead of a mission that leads over closed ground."""
    state, serial, settings = choice.state, choice.surveyor.serial, choice.settings
    alone = _alone(choice)
    free = alone.free()
    rows: Route = ()
    if free.any():
        share = alone.share(free)
        if alone.expected.is_clear(share, settings.clear_from):
            rows = alone.rows(share)
        elif (best := alone.best(share)).legs and best.waits_s <= 0.0:
            rows = alone.long_enough(alone.committed(best))
    if rows:
        names = ", ".join(each.name for each in state.closed)
        text = f"keeps clear of {names}, without telemetry; flies {named(rows)}"
        replaced = _instead(choice, rows, text)
        if replaced is not None:
            return replaced
    again_ns = choice.now_ns + seconds_to_ns(settings.decided_again_s)
    return state.with_decision(serial, replace(state.decisions[serial], again_ns=again_ns)), ()


def at_row_end(choice: VehicleChoice, able: Mapping[str, Surveyor]) -> Replaced:
    """Replace the mission of a vehicle at the end of a row, if that is worth it."""
    rows, settings = choice.state.flights[choice.surveyor.serial].rows_left, choice.settings
    left = choice.passing(rows, 0.0)
    lit_m2, missing_m2 = left.lit_m2(choice.expected), left.missing_m2
    is_slow = missing_m2 < settings.kept_from * choice.flown_m2ps * left.ends_s
    replaced = None
    if is_slow or lit_m2 < settings.kept_from * missing_m2:
        replaced = _in_more_sun(choice, left)
    if replaced is None:
        replaced = _handed_on(choice, able, _nearer_half(rows, choice.plan), lit_m2)
    return (choice.state, ()) if replaced is None else replaced


def on_the_way(state: SurveyState, able: Mapping[str, Surveyor]) -> tuple[str, ...]:
    """Return the vehicles before their first row, on missions given while something was not known
    yet; not those that take off: an aircraft may ignore a mission then."""
    taken_off_m = state.plan.settings.taken_off_m
    found = []
    for serial, flight in state.flights.items():
        if flight.known == Known.MOTION or flight.ends_passed > 0 or serial not in able:
            continue
        height_m = able[serial].height_above_takeoff_m
        if height_m is not None and height_m > taken_off_m:
            found.append(serial)
    return tuple(found)


def when_more_is_known(choice: VehicleChoice, of_round: Route | None) -> Replaced:
    """Decide anew, as if it had none, on a mission whose first row is ahead.

    `of_round` is the rows of a round that is worth it. One that lies in sun and is as long is kept.
    """
    serial, alone = choice.surveyor.serial, _alone(choice)
    flight = choice.state.flights[serial]
    left = choice.passing(flight.route)
    sun = left.lit_m2(choice.expected) / max(left.missing_m2, 1.0)
    is_longer = of_round is not None and len(of_round) > len(flight.route)
    if is_longer or sun < choice.settings.clear_from:
        state, missions = alone.made() if of_round is None else alone.flies_all(of_round)
        if missions and state.flights[serial].route != flight.route:
            return _replacing(choice, state, missions)
    state = choice.state.with_flight(serial, replace(flight, known=choice.expected.known))
    if not flight.route:
        return state, ()
    text = f"flies on with {named(flight.route)}: probability of sun {sun:.1f}"
    return state.with_decision(serial, Decision(text)), ()


def _handed_on(
    choice: VehicleChoice, able: Mapping[str, Surveyor], kept: Route, lit_m2: float
) -> Replaced | None:
    """Keep these rows alone, if there are vehicles for the others."""
    others = _in_want_of_sun(choice, able, lit_m2) if kept else set()
    if not others:
        return None
    state = choice.state
    for serial in others & state.decisions.keys():
        state = state.with_decision(serial, replace(state.decisions[serial], again_ns=0))
    text = f"hands on half of its rows; flies {named(kept)}"
    return _instead(replace(choice, state=state), kept, text)


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


def _nearer_half(rows: Route, plan: SurveyPlan) -> Route:
    """The rows to keep of several; none if handing on takes longer than it saves."""
    long_m = list(accumulate(leg.piece.length_m for leg in rows))
    saved_s = long_m[-1] / 2.0 / plan.survey.speed_mps
    if len(rows) < 2 or saved_s < plan.settings.handed_on_s:
        return ()
    kept = 1 + sum(each < long_m[-1] / 2.0 for each in long_m)
    return rows[: min(kept, len(rows) - 1)]


def _in_more_sun(choice: VehicleChoice, left: Passing) -> Replaced | None:
    """Fly what is in sun instead of what is left, if that is worth a new mission."""
    alone, expected = _alone(choice), choice.expected
    free = alone.free()
    best = alone.best(alone.share(free)) if free.any() else Flight((), 0.0)
    if not best.legs or best.waits_s > 0.0:
        return None
    legs = alone.committed(best)
    until_s = legs[-1].until_s
    gained_m2 = sum(
        leg.probability * float(expected.missing_m2[list(leg.segments)].sum()) for leg in legs
    ) - sum(
        each.missing_m2 * expected.at(each.segment, each.at_s)
        for each in left.passes
        if each.at_s <= until_s
    )
    if gained_m2 < choice.settings.replaced_from * choice.flown_m2ps * until_s:
        return None
    return _instead(choice, alone.long_enough(legs), f"leaves its rows; {flown_text(legs)}")


def _instead(choice: VehicleChoice, rows: Route, text: str) -> Replaced | None:
    """Fly these rows instead of the mission's; None if the battery lasts for none of them."""
    state, missions = _alone(choice).flies(rows, text)
    new = state.flights.get(choice.surveyor.serial)
    return _replacing(choice, state, missions) if new is not None and new.route else None


def _replacing(
    choice: VehicleChoice, state: SurveyState, missions: tuple[MissionAssignment, ...]
) -> Replaced:
    """The survey with a new mission that replaces the vehicle's."""
    serial = choice.surveyor.serial
    old, new = choice.state.flights[serial], state.flights[serial]
    state = state.with_flight(serial, replace(new, replaces=replace(old, replaces=None)))
    return replace(state, flown_m=state.flown_m - old.unflown_m), missions


def _alone(choice: VehicleChoice) -> VehicleChoice:
    """The choice of a vehicle without its mission; what it has flown counts as just flown."""
    state, serial = choice.state, choice.surveyor.serial
    flight = state.flights[serial]
    route = flight.route[: flight.ends_passed // 2]
    flown = flown_just_now(route, choice.settings, choice.now_ns)
    just_flown = MappingProxyType({**state.just_flown, serial: flown})
    return replace(choice, state=replace(state.without_flight(serial), just_flown=just_flown))
