"""Missions replaced under way: at the end of a row, and off ground that has been closed."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
import shapely
from tests.guidance.survey.decisions import SURVEY, decided, flown_rows, forecast
from tests.guidance.survey.flyers import BoolArray, Flights, FloatArray, Flyer, begun, fleet

from recon.guidance.survey import ClosedArea, Surveyor, SurveyState, refused
from recon.guidance.survey.closed_areas import closed_ground
from recon.guidance.survey.mission_changes import with_ends_passed
from recon.guidance.survey.segments import segments_of
from recon.model.shade import SunForecast
from recon.model.survey import MissionAssignment, SurveyBudget, SurveyPhase
from recon.model.units import seconds_to_ns

HERE = Surveyor("S-1", (0.0, 0.0))
OTHER = Surveyor("S-2", (360.0, 240.0))


def lit(now_s: float = 0.0) -> SunForecast:
    return forecast(lambda _east, _north, _lead: True, now_s)


def ends_m(state: SurveyState, serial: str) -> list[tuple[float, float]]:
    """East-north: where each row of a mission begins and ends."""
    route, lattice = state.flights[serial].route, state.plan.lattice
    ends = [end for leg in route for end in leg.ends_m(lattice, state.plan.swath.lead_m)]
    return [(east_m, north_m) for east_m, north_m in lattice.east_north_m(ends).tolist()]


def flown_to(
    state: SurveyState, passed: int, *others: Surveyor, sun: object = None, from_s: float = 1.0
) -> tuple[SurveyState, tuple[MissionAssignment, ...]]:
    """Let S-1 come to so many ends of its rows, a second each."""
    missions: tuple[MissionAssignment, ...] = ()
    for number, end_m in enumerate(ends_m(state, "S-1")[:passed]):
        now_s = from_s + number
        forecast_then = lit(now_s) if sun is None else forecast(sun, now_s)
        vehicles = replace(HERE, place_m=end_m), *others
        state, missions = decided(forecast_then, *vehicles, state=state, now_s=now_s)
    return state, missions


class TestEnds:
    def test_rows_are_counted_as_their_ends_are_reached_in_order(self) -> None:
        state, _given = decided(lit(), HERE)
        rows = state.flights["S-1"].route
        ends = ends_m(state, "S-1")
        late, _given = decided(lit(1.0), replace(HERE, place_m=ends[5]), state=state, now_s=1.0)
        assert late.flights["S-1"].ends_passed == 0
        after, missions = flown_to(state, 3)
        flight = after.flights["S-1"]
        assert missions == ()
        assert (flight.ends_passed, flight.rows_left, flight.rows_taken) == (3, rows[1:], rows)
        flight = flown_to(state, 4)[0].flights["S-1"]
        assert (flight.rows_left, flight.rows_taken) == (rows[2:], rows[1:])
        assert flight.unflown_m < 0.8 * flight.length_m

    def test_none_is_passed_during_takeoff(self) -> None:
        """Its pad lies beside a first row so short that both ends are near."""
        state, _given = decided(lit(), HERE)
        flight, lattice = state.flights["S-1"], state.plan.lattice
        first = flight.route[0]
        middle_m = first.piece.start_m + 8.0
        short = replace(first, piece=replace(first.piece, end_m=first.piece.start_m + 16.0))
        ((east_m, north_m),) = lattice.east_north_m(
            [(middle_m, lattice.row_across_m(first.piece.row))]
        ).tolist()
        state = state.with_flight("S-1", replace(flight, route=(short, *flight.route[1:])))
        pad = replace(HERE, place_m=(east_m, north_m), height_above_takeoff_m=0.0, is_flying=False)
        assert with_ends_passed(state, {"S-1": pad}) == (state, ())
        climbing = replace(pad, height_above_takeoff_m=1.0, is_flying=True)
        assert with_ends_passed(state, {"S-1": climbing}) == (state, ())
        up = replace(climbing, height_above_takeoff_m=60.0)
        assert with_ends_passed(state, {"S-1": up})[1] == ("S-1",)


class TestHandingOn:
    def test_a_vehicle_without_rows_gets_the_farther_half(self) -> None:
        state, _given = decided(lit(), HERE, replace(OTHER, is_available=False))
        rows = flown_rows(state, "S-1")
        assert len(rows) > 4
        state, missions = flown_to(state, 1, OTHER)
        assert missions == ()  # not within a row
        state, missions = flown_to(state, 2, OTHER, from_s=5.0)
        assert {mission.serial for mission in missions} == {"S-1", "S-2"}
        own, others = flown_rows(state, "S-1"), flown_rows(state, "S-2")
        assert own == rows[1 : 1 + len(own)]
        assert sorted(own + others) == sorted(rows[1:])
        assert abs(len(own) - len(others)) <= 1
        what = f"rows {min(own) + 1} to {max(own) + 1}: probability of sun 1.0"
        text = f"hands on half of its rows; flies {what}"
        assert state.decisions["S-1"].text == text
        assert state.flown_m == pytest.approx(sum(m.length_m for m in missions), rel=0.4)

    def test_it_is_sooner_done_than_one_flying_on_alone(self) -> None:
        took_s = []
        for comes_s in (60.0, 2000.0):
            flyers = fleet(2)
            flyers[1].is_available = False
            survey = replace(SURVEY, budget=SurveyBudget(rounds=20))
            flights = Flights(begun(survey, flyers), flyers, foresees=True)
            flights.run(comes_s)
            flyers[1].is_available = True
            segments = segments_of(flights.plan)

            def check(now: Flights, segments: object = segments) -> None:
                flown = [segments.under(each.rows_left) for each in now.state.flights.values()]  # type: ignore[attr-defined]
                assert not any((a & b).any() for a, b in combinations(flown, 2))

            assert flights.run(each_second=check).phase is SurveyPhase.DONE
            took_s.append(flights.time_s)
        assert took_s[0] < 0.7 * took_s[1]

    def test_a_vehicle_whose_battery_lasts_for_no_other_mission_flies_on(self) -> None:
        """Else it would leave rows that the gate has approved, and step aside."""
        low = replace(HERE, time_left_s=20.0, height_above_takeoff_m=60.0)
        state, _given = decided(lit(), HERE, replace(OTHER, is_available=False))
        for now_s, end_m in enumerate(ends_m(state, "S-1")[:2], 1):
            at_end = replace(low, place_m=end_m)
            state, missions = decided(lit(now_s), at_end, OTHER, state=state, now_s=now_s)
            assert "S-1" not in {mission.serial for mission in missions}
        assert (state.flights["S-1"].number, state.flights["S-1"].ends_passed) == (1, 2)

    def test_little_is_not_handed_on(self) -> None:
        state, _given = decided(lit(), HERE, replace(OTHER, is_available=False))
        all_but_two = 2 * (len(flown_rows(state, "S-1")) - 1)
        alone = replace(OTHER, is_available=False)
        state, _none = flown_to(state, all_but_two - 1, alone)
        flight = state.flights["S-1"]
        place_m = ends_m(state, "S-1")[all_but_two - 1]
        state, missions = decided(
            lit(90.0), replace(HERE, place_m=place_m), OTHER, state=state, now_s=90.0
        )
        assert "S-1" not in {mission.serial for mission in missions}
        assert state.flights["S-1"].number == flight.number


def north_is_shaded(_east_m: FloatArray, north_m: FloatArray, _lead_s: float) -> BoolArray:
    """A forecast that knows better than the one at the start."""
    return np.asarray((north_m < 30.0) | (north_m > 170.0))


class TestShade:
    def test_rows_that_have_come_into_shade_are_left_for_those_in_sun(self) -> None:
        state, _given = decided(lit(), HERE)
        rows = flown_rows(state, "S-1")
        before = state.flights["S-1"]
        state, (mission,) = flown_to(state, 2, sun=north_is_shaded)
        assert mission.serial == "S-1"
        assert state.decisions["S-1"].text.startswith("leaves its rows; flies row")
        flight = state.flights["S-1"]
        assert flight.replaces == replace(before, ends_passed=2)
        norths = [north_m for _east_m, north_m in ends_m(state, "S-1")]
        assert min(norths) > 150.0
        assert rows[0] not in flown_rows(state, "S-1")

    def test_where_nothing_else_is_in_sun_it_flies_on(self) -> None:
        state, _given = decided(lit(), HERE)
        after, missions = flown_to(state, 2, sun=lambda _east, north, _lead: north < 30.0)
        assert missions == ()
        assert after.flights["S-1"] == replace(state.flights["S-1"], ends_passed=2)
        assert after.just_flown == state.just_flown

    def test_a_mission_that_is_still_in_sun_is_flown_on(self) -> None:
        state, _given = decided(lit(), HERE)
        assert flown_to(state, 2, sun=lambda _east, north, _lead: north < 200.0)[1] == ()

    def test_if_the_other_rows_are_refused_it_flies_on(self) -> None:
        state, _given = decided(lit(), HERE)
        flown_m = state.flown_m
        state, (mission,) = flown_to(state, 2, sun=north_is_shaded)
        back = refused(state, "S-1", mission.number, "near Drone 2", 0, in_the_way=True)
        flight = back.flights["S-1"]
        assert (flight.number, flight.ends_passed) == (1, 2)
        assert back.flown_m == pytest.approx(flown_m)
        assert back.decisions["S-1"].text.endswith("other rows were refused")
        assert back.decisions["S-1"].again_ns == seconds_to_ns(3.0)
        assert (back.refusals, back.barred, back.waiting) == ({}, frozenset(), {})


LOST = ClosedArea("Drone 3", "S-3", (180.0, 120.0), 60.0, None, 20.0, lost_s=12.0)


class TestClosedGround:
    def test_a_mission_over_it_is_replaced_at_once(self) -> None:
        state, _given = decided(lit(), HERE)
        place = replace(HERE, place_m=ends_m(state, "S-1")[0])
        young = replace(LOST, lost_s=5.0)
        state, missions = decided(lit(2.0), place, state=state, now_s=2.0, closed=[young])
        assert missions == ()
        state, (mission,) = decided(lit(8.0), place, state=state, now_s=8.0, closed=[LOST])
        assert mission.serial == "S-1"
        assert state.decisions["S-1"].text.startswith(
            "keeps clear of Drone 3, without telemetry; flies row"
        )
        path = shapely.linestrings(state.flights["S-1"].corners_m)
        assert not shapely.intersects(closed_ground([LOST]), path)
        assert decided(lit(9.0), place, state=state, now_s=9.0, closed=[LOST])[1] == ()

    def test_without_other_rows_it_flies_on_and_looks_again_later(self) -> None:
        state, _given = decided(lit(), HERE)
        wide = replace(LOST, radius_m=190.0)
        place = replace(HERE, place_m=(-80.0, 0.0))
        state, missions = decided(lit(2.0), place, state=state, now_s=2.0, closed=[wide])
        assert missions == ()
        assert state.decisions["S-1"].again_ns == seconds_to_ns(5.0)
        assert state.flights["S-1"].number == 1

    def test_once_it_is_open_what_was_left_beside_it_is_left_for_whole_rows(self) -> None:
        wide = replace(LOST, radius_m=100.0)
        state, _given = decided(lit(), HERE, closed=[wide])
        assert min(leg.piece.length_m for leg in state.flights["S-1"].route) < 100.0
        still, none = state, ()
        for now_s, end_m in enumerate(ends_m(state, "S-1")[:2], 1):
            place = replace(HERE, place_m=end_m)
            still, none = decided(lit(now_s), place, state=still, now_s=now_s, closed=[wide])
        assert none == ()
        state, (mission,) = flown_to(state, 2)
        assert mission.serial == "S-1"
        assert state.decisions["S-1"].text.startswith("leaves its rows; flies row")
        assert {leg.piece.length_m for leg in state.flights["S-1"].route} == {360.0}
        state, _none = flown_to(decided(lit(), HERE)[0], 2)
        assert not state.flights["S-1"].is_beside_closed

    def test_none_is_replaced_during_takeoff(self) -> None:
        state, _given = decided(lit(), HERE)
        for height_m, missions in ((0.0, 0), (1.2, 0), (8.0, 1)):
            place = replace(HERE, height_above_takeoff_m=height_m)
            assert (
                len(decided(lit(8.0), place, state=state, now_s=8.0, closed=[LOST])[1]) == missions
            )

    def test_the_lost_vehicle_itself_gets_no_other_mission(self) -> None:
        state, _given = decided(lit(), HERE)
        own = replace(LOST, serial="S-1")
        place = replace(HERE, place_m=ends_m(state, "S-1")[0])
        assert decided(lit(8.0), place, state=state, now_s=8.0, closed=[own])[1] == ()


class TestInTheWay:
    def test_half_of_the_rows_are_asked_for_at_once(self) -> None:
        state, (first,) = decided(lit(), HERE)
        rows = flown_rows(state, "S-1")
        for half in (len(rows) // 2, len(rows) // 4):
            asked = refused(state, "S-1", first.number, "near Drone 2", 0, in_the_way=True)
            state, (first,) = decided(lit(), HERE, state=asked)
            assert flown_rows(state, "S-1") == rows[:half]
            named = f"rows {min(rows[:half]) + 1} to {max(rows[:half]) + 1}" if half > 1 else "row"
            assert f"flies {named}" in state.decisions["S-1"].text

    def test_later_all_of_them_are_again(self) -> None:
        state, (first,) = decided(lit(), HERE)
        rows = flown_rows(state, "S-1")
        asked = refused(state, "S-1", first.number, "near Drone 2", 0, in_the_way=True)
        state, _given = decided(lit(10.0), HERE, state=asked, now_s=10.0)
        assert flown_rows(state, "S-1") == rows


def test_whole_surveys_with_replaced_missions_end_with_all_in_sun() -> None:
    def a_cloud_comes(places_m: FloatArray, time_s: float) -> BoolArray:
        is_north = places_m[:, 1] > 150.0
        return np.asarray(~is_north | (time_s < 40.0) | (time_s > 200.0))

    replaced: set[tuple[int, int]] = set()
    for seed in range(3):

        def note(now: Flights, seed: int = seed) -> None:
            replaced.update(
                (seed, each.number)
                for each in now.state.flights.values()
                if each.replaces is not None
            )

        flyers: list[Flyer] = fleet(2, seed)
        survey = replace(SURVEY, budget=SurveyBudget(rounds=20))
        flights = Flights(begun(survey, flyers), flyers, sky=a_cloud_comes)
        assert flights.run(each_second=note).phase is SurveyPhase.DONE
        numbers = [mission.number for mission in flights.given]
        assert numbers == sorted(set(numbers))
    assert replaced
