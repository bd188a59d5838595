"""Missions replaced under way: what was decided when they began may be wrong by then.

Theory of operation. A mission that leads over ground that has been closed since, because a vehicle
there has lost its link, is replaced at once by one over other ground: else the station would hold
its vehicle when it comes near. When a vehicle reaches the end of a row and its mission has more,
and once when light becomes known, if its mission was given without and its first row is ahead:

1. If much of what is left is expected in shade, or is what was left beside ground that was closed
   then and is open now, the best flight from here is searched, over all that is free without this
   mission. It is flown instead if it brings so much more ground into sun in the same time that a
   new mission is worth it.
2. If most of it is in sun, another vehicle has nothing to fly or flies in shade, and little that is
   free is in sun, the farther half of what is left is handed on: the mission is replaced by one of
   the nearer half. The other vehicle finds the rest when it is asked, or at the end of its row.

Otherwise the mission is flown on; so it is if the gate refuses the new one (`life.refused`). An end
that no position has come near to, as without telemetry, ends this for the mission. None is replaced
during takeoff: an aircraft may ignore the new one then.
"""

from collections.abc import Mapping
from dataclasses import replace
from itertools import accumulate
from math import dist
from types import MappingProxyType

from recon.guidance.survey.closed_areas import closed_ground, is_open
from recon.guidance.survey.lattice import EastNorth
from recon.guidance.survey.missions import Track
from recon.guidance.survey.passing import Passing
from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.rounds import Step, may_ask
from recon.guidance.survey.route import Route
from recon.guidance.survey.state import (
    AssignedMission,
    Decision,
    Surveyor,
    SurveyState,
    flown_just_now,
)
from recon.guidance.survey.vehicle_choice import VehicleChoice, named
from recon.model.units import seconds_to_ns


def with_ends_passed(
    state: SurveyState, able: Mapping[str, Surveyor]
) -> tuple[SurveyState, tuple[str, ...]]:
    """Return the survey with the ends of rows that vehicles have reached, and the serials of those
    that have just flown a row and have others left."""
    at_end = []
    for serial, flight in state.flights.items():
        if serial not in able or _is_taking_off(flight, able[serial], state.plan):
            continue
        passed = _ends_passed(flight, able[serial].place_m, state.plan)
        if passed == flight.ends_passed:
            continue
        flight = replace(flight, ends_passed=passed)
        state = state.with_flight(serial, flight)
        if passed % 2 == 0 and flight.rows_left:
            at_end.append(serial)
    return state, tuple(at_end)


def _ends_passed(flight: AssignedMission, place_m: EastNorth, plan: SurveyPlan) -> int:
    passed = flight.ends_passed
    for end_m in _ends_left_m(flight, plan):
        if dist(end_m, place_m) > plan.settings.at_end_m:
            break
        passed += 1
    return passed


def _ends_left_m(flight: AssignedMission, plan: SurveyPlan) -> list[EastNorth]:
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
        if _is_taking_off(flight, able[serial], state.plan):
            continue
        path_m = tuple(_ends_left_m(flight, state.plan))
        is_out = is_open(ground, Track((able[serial].place_m,)))
        if path_m and is_out and not is_open(ground, Track(path_m)):
            found.append(serial)
    return tuple(found)


def leave_closed_ground(choice: VehicleChoice) -> Step:
    """Fly rows over open ground instead of a mission that leads over closed ground."""
    state, serial, settings = choice.state, choice.surveyor.serial, choice.settings
    alone = _without_mission(choice)
    free = alone.free()
    rows: Route = ()
    if free.any():
        share = alone.share(free)
        is_clear = alone.expected.is_clear(share, settings.clear_sky_probability)
        rows = (
            alone.clear_rows(share) if is_clear else alone.long_enough(alone.begun_at_once(share))
        )
    if rows:
        names = ", ".join(each.name for each in state.closed)
        replaced = _replace_mission(choice, rows, f"keeps clear of {names}, without telemetry; ")
        if replaced is not None:
            return replaced
    again_ns = choice.now_ns + seconds_to_ns(settings.decided_again_s)
    return state.with_decision(serial, replace(state.decisions[serial], again_ns=again_ns)), ()


def decide_at_row_end(choice: VehicleChoice, able: Mapping[str, Surveyor]) -> Step:
    """Replace the mission of a vehicle at the end of a row, if that is worth it."""
    rows = choice.state.flights[choice.surveyor.serial].rows_left
    left = choice.passing(rows, 0.0)
    lit_m2 = left.lit_m2(choice.expected)
    is_in_sun = lit_m2 >= choice.settings.mission_kept_sun_share * left.missing_m2
    replaced = None
    if not is_in_sun or _has_opened(choice):
        replaced = _fly_in_more_sun(choice, left)
    if replaced is None and is_in_sun:
        replaced = _hand_on_half(choice, able, _nearer_half(rows, choice.plan), lit_m2)
    return (choice.state, ()) if replaced is None else replaced


def _has_opened(choice: VehicleChoice) -> bool:
    state = choice.state
    return state.flights[choice.surveyor.serial].is_beside_closed and not state.closed


def before_first_row_in_any_light(
    state: SurveyState, able: Mapping[str, Surveyor]
) -> tuple[str, ...]:
    """Return the vehicles on the leg to the first row of a mission given in unknown light."""
    return tuple(
        serial
        for serial, flight in state.flights.items()
        if serial in able
        and flight.is_in_any_light
        and flight.ends_passed == 0
        and not _is_taking_off(flight, able[serial], state.plan)
    )


def _is_taking_off(flight: AssignedMission, surveyor: Surveyor, plan: SurveyPlan) -> bool:
    """Whether a vehicle is on the ground, or before its first row not higher than it takes off to.

    Rows over low ground may be far below the takeoff point: there it is not taking off.
    """
    if not surveyor.is_flying:
        return True
    height_m = surveyor.height_above_takeoff_m
    is_low = height_m is not None and abs(height_m) <= plan.settings.taken_off_m
    return is_low and flight.ends_passed == 0


def decide_in_known_light(choice: VehicleChoice, able: Mapping[str, Surveyor]) -> Step:
    """Decide once on a mission given in unknown light, as at the end of a row."""
    state, missions = decide_at_row_end(choice, able)
    if missions:
        return state, missions
    serial = choice.surveyor.serial
    flight = state.flights[serial]
    left = choice.passing(flight.rows_left, 0.0)
    sun = left.lit_m2(choice.expected) / max(left.missing_m2, 1.0)
    text = f"flies on with {named(flight.rows_left, state.plan)}: probability of sun {sun:.1f}"
    state = state.with_flight(serial, replace(flight, is_in_any_light=False))
    return state.with_decision(serial, Decision(text)), ()


def _hand_on_half(
    choice: VehicleChoice, able: Mapping[str, Surveyor], kept: Route, lit_m2: float
) -> Step | None:
    """Keep these rows alone, if there are vehicles for the others."""
    others = _in_want_of_sun(choice, able, lit_m2) if kept else set()
    if not others:
        return None
    state = choice.state
    for serial in others & state.decisions.keys():
        state = state.with_decision(serial, replace(state.decisions[serial], again_ns=0))
    return _replace_mission(replace(choice, state=state), kept, "hands on half of its rows; ")


def _in_want_of_sun(choice: VehicleChoice, able: Mapping[str, Surveyor], lit_m2: float) -> set[str]:
    """The vehicles without a mission, or with one in shade, while little that is free is in sun."""
    state, expected, settings = choice.state, choice.expected, choice.settings
    free = choice.free()
    soon = expected.moments_s <= settings.transit_s
    sun = expected.probability[free][:, soon].mean(axis=1)
    if float(expected.missing_m2[free] @ sun) > settings.hand_on_free_share * lit_m2:
        return set()
    found = {serial for serial in able if may_ask(state, serial, able, choice.now_ns)}
    found -= {serial for serial, each in state.decisions.items() if each.returns}
    for serial, flight in state.flights.items():
        if serial in able and serial != choice.surveyor.serial:
            left = replace(choice, surveyor=able[serial]).passing(flight.rows_left, 0.0)
            if left.lit_m2(expected) < settings.in_shade_below_sun_share * left.missing_m2:
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


def _fly_in_more_sun(choice: VehicleChoice, left: Passing) -> Step | None:
    """Fly sunlit ground instead of the mission's rest, if that is worth a new mission."""
    alone, expected, plan = _without_mission(choice), choice.expected, choice.plan
    free = alone.free()
    legs = alone.begun_at_once(alone.share(free)) if free.any() else ()
    if not legs:
        return None
    until_s = legs[-1].until_s
    gained_m2 = sum(
        leg.probability * float(expected.missing_m2[list(leg.segments)].sum()) for leg in legs
    ) - sum(
        each.missing_m2 * expected.at(each.segment, each.at_s)
        for each in left.passes
        if each.at_s <= until_s
    )
    flown_m2 = plan.survey.speed_mps * plan.lattice.spacing_m * until_s
    if gained_m2 < plan.settings.replacement_gain_share * flown_m2:
        return None
    return _replace_mission(choice, alone.long_enough(legs), "leaves its rows; ")


def _replace_mission(choice: VehicleChoice, rows: Route, why: str) -> Step | None:
    """Fly these rows instead of the mission's; None if the battery lasts for none of them."""
    serial = choice.surveyor.serial
    flight = choice.state.flights[serial]
    state, missions = _without_mission(choice).fly(rows, why)
    new = state.flights.get(serial)
    if new is None or not new.route:
        return None
    state = state.with_flight(serial, replace(new, replaces=replace(flight, replaces=None)))
    return replace(state, flown_m=state.flown_m - flight.unflown_m), missions


def _without_mission(choice: VehicleChoice) -> VehicleChoice:
    """The choice of a vehicle without its mission; what it has flown counts as just flown."""
    state, serial = choice.state, choice.surveyor.serial
    flight = state.flights[serial]
    route = flight.route[: flight.ends_passed // 2]
    state = state.without_flight(serial)
    if route:
        flown = flown_just_now(route, choice.settings, choice.now_ns)
        just_flown = MappingProxyType({**state.just_flown, serial: flown})
        state = replace(state, just_flown=just_flown)
    return replace(choice, state=state)
