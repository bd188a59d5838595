"""Rows in an order, shared among vehicles; and the missions they become."""

from collections.abc import Sequence
from itertools import pairwise
from math import hypot

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.guidance.survey.fields import FRAME, holed, l_shape, planned, rectangle, star, survey_of
from tests.guidance.survey.flyers import east_north

from recon.geo.distance import horizontal_distance_m
from recon.guidance.survey import Surveyor, SurveyPlan, SurveyState, create, start, step
from recon.guidance.survey.route import Cost, Route, RowLeg, route_of, shared
from recon.guidance.survey.rows import Piece
from recon.model.airspace import Region
from recon.model.geo import LatLon
from recon.model.survey import MissionAssignment
from recon.model.vehicle import VehicleProfile
from recon.vehicles.mission_repair import Repaired, repair

COST = Cost(stop_m=25.6, least_cut_m=25.0)


def drawn(seed: int) -> SurveyPlan:
    rng = np.random.default_rng(seed)
    field = star(rng, float(rng.uniform(80.0, 400.0)), bool(rng.random() < 0.5))
    return planned(survey_of(field))


def missions(plan: SurveyPlan, count: int) -> tuple[SurveyState, tuple[MissionAssignment, ...]]:
    created = create(plan)
    assert isinstance(created, SurveyState)
    surveyors = [Surveyor(f"S-{i}", (30.0 * i, -50.0)) for i in range(count)]
    begun = start(created, [each.serial for each in surveyors], 0)
    assert isinstance(begun, SurveyState)
    return step(begun, surveyors, 10**10)


def cost_m(plan: SurveyPlan, route: Route) -> float:
    """What a route costs to fly, reckoned from its corners alone: its path, and stops."""
    corners = [place for leg in route for place in leg.ends_m(plan.lattice, 0.0)]
    path_m = sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(corners))
    return path_m + COST.stop_m * (len(corners) - 1)


def covered(pieces: Sequence[Piece]) -> dict[int, list[tuple[float, float]]]:
    """By row, from where to where pieces reach; those that touch are one."""
    found: dict[int, list[tuple[float, float]]] = {}
    for piece in sorted(pieces, key=lambda each: (each.row, each.start_m)):
        spans = found.setdefault(piece.row, [])
        if spans and abs(piece.start_m - spans[-1][1]) < 1e-6:
            spans[-1] = (spans[-1][0], piece.end_m)
        else:
            spans.append((piece.start_m, piece.end_m))
    return found


class TestRoute:
    @settings(max_examples=examples(40), deadline=None)
    @given(st.integers(0, 10**9))
    def test_every_piece_is_flown_once(self, seed: int) -> None:
        plan = drawn(seed)
        route = route_of(plan.pieces, plan.lattice, (0.0, 0.0))
        assert len(route) == len(plan.pieces)
        assert {leg.piece for leg in route} == set(plan.pieces)

    def test_a_rectangle_is_flown_to_and_fro_from_the_near_corner(self) -> None:
        plan = planned(survey_of(rectangle(), bearing_deg=90.0))
        route = route_of(plan.pieces, plan.lattice, (310.0, 0.0))
        assert [leg.is_reversed for leg in route] == [index % 2 == 0 for index in range(len(route))]
        rows = [leg.piece.row for leg in route]
        assert rows == sorted(rows, reverse=True)

    def test_nothing_to_fly_is_no_route(self) -> None:
        plan = planned(survey_of(rectangle()))
        assert route_of((), plan.lattice, None) == ()

    def test_both_sides_of_a_hole_are_flown_without_crossing_it_row_by_row(self) -> None:
        plan = planned(survey_of(holed()))
        route = route_of(plan.pieces, plan.lattice, (0.0, 0.0))
        rows_m = sum(piece.length_m for piece in plan.pieces)
        corners = [place for leg in route for place in leg.ends_m(plan.lattice, 0.0)]
        path_m = sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(corners))
        assert path_m < 1.2 * rows_m


class TestShares:
    @settings(max_examples=examples(60), deadline=None)
    @given(st.integers(0, 10**9), st.integers(1, 9))
    def test_shares_are_the_whole_route_cut_at_marks(self, seed: int, count: int) -> None:
        plan = drawn(seed)
        route = route_of(plan.pieces, plan.lattice, (0.0, 0.0))
        runs = shared(route, count, plan.lattice, COST)
        assert 1 <= len(runs) <= count
        assert all(runs)
        assert covered([leg.piece for run in runs for leg in run]) == covered(plan.pieces)
        ends_m = {end for piece in plan.pieces for end in (piece.start_m, piece.end_m)}
        for leg in (leg for run in runs for leg in run):
            for end_m in {leg.piece.start_m, leg.piece.end_m} - ends_m:
                mark = (end_m - plan.lattice.first_mark_m) / plan.lattice.mark_m
                assert mark == pytest.approx(round(mark), abs=1e-6)

    @settings(max_examples=examples(60), deadline=None)
    @given(st.integers(0, 10**9), st.integers(2, 9))
    def test_no_share_is_much_longer_than_an_equal_one(self, seed: int, count: int) -> None:
        plan = drawn(seed)
        route = route_of(plan.pieces, plan.lattice, (0.0, 0.0))
        runs = shared(route, count, plan.lattice, COST)
        equal_m = cost_m(plan, route) / count
        # A share may miss its length by a cut too near to a row's end, a mark, and a cut's stops.
        slack_m = COST.least_cut_m + plan.lattice.mark_m + 2.0 * COST.stop_m
        least_m = 2.0 * COST.least_cut_m + plan.lattice.mark_m + COST.stop_m
        assert max(cost_m(plan, run) for run in runs) <= max(equal_m, least_m) + slack_m

    @pytest.mark.parametrize("count", [2, 3, 8])
    def test_a_large_field_is_shared_about_equally(self, count: int) -> None:
        plan = planned(survey_of(rectangle(1000.0, 600.0)))
        runs = shared(route_of(plan.pieces, plan.lattice, None), count, plan.lattice, COST)
        lengths_m = [cost_m(plan, run) for run in runs]
        assert len(runs) == count
        assert min(lengths_m) > 0.85 * max(lengths_m)

    def test_a_row_is_not_cut_near_its_end(self) -> None:
        plan = planned(survey_of(rectangle(), bearing_deg=90.0))
        for count in range(2, 12):
            runs = shared(route_of(plan.pieces, plan.lattice, None), count, plan.lattice, COST)
            assert min(leg.piece.length_m for run in runs for leg in run) >= COST.least_cut_m

    def test_four_short_rows_are_cut_for_nine_vehicles(self) -> None:
        plan = planned(survey_of(rectangle(160.0, 120.0), bearing_deg=90.0))
        runs = shared(route_of(plan.pieces, plan.lattice, None), 9, plan.lattice, COST)
        assert len(plan.pieces) == 4
        assert len(runs) > 4
        assert max(cost_m(plan, run) for run in runs) < 160.0

    def test_one_short_row_is_one_share(self) -> None:
        plan = planned(survey_of(rectangle()))
        row = (RowLeg(Piece(0, 0.0, 40.0), False),)
        assert shared(row, 3, plan.lattice, COST) == (row,)


class TestMissions:
    @pytest.mark.parametrize("field", [l_shape(), holed(), rectangle()], ids="LHR")
    def test_they_stop_at_both_ends_of_every_row(self, field: Region) -> None:
        plan = planned(survey_of(field))
        state, given = missions(plan, 3)
        for mission in given:
            flight = state.flights[mission.serial]
            corners = east_north(mission.mission, plan)
            assert np.allclose(corners, flight.corners_m, atol=0.01)
            for leg in flight.route:
                for end in plan.lattice.east_north_m(leg.ends_m(plan.lattice, 0.0)):
                    assert min(hypot(*(end - corner)) for corner in corners) < 1.0

    def test_they_are_flown_straight_at_the_height_and_speed_asked_for(self) -> None:
        _state, given = missions(planned(survey_of(rectangle(), height_m=55.0, speed_mps=7.0)), 2)
        for mission in (each.mission for each in given):
            assert not mission.curved
            assert not mission.land_at_end
            assert {w.height_above_takeoff_m for w in mission.waypoints} == {55.0}
            assert {w.speed_mps for w in mission.waypoints} == {7.0}
            assert [w.gimbal_pitch_deg for w in mission.waypoints[:2]] == [-90.0, None]
            assert mission.purpose == "survey north field: round 1"

    def test_their_length_is_that_of_their_way(self) -> None:
        _state, given = missions(planned(survey_of(holed())), 3)
        for each in given:
            places = [LatLon(w.latitude_deg, w.longitude_deg) for w in each.mission.waypoints]
            path_m = sum(horizontal_distance_m(a, b) for a, b in pairwise(places))
            assert path_m == pytest.approx(each.length_m, rel=1e-3)

    @pytest.mark.parametrize("field", [l_shape(), holed(), rectangle()], ids="LHR")
    def test_dji_takes_them_as_they_are(self, field: Region) -> None:
        profile = VehicleProfile("S-0")
        for count in (1, 3, 8):
            _state, given = missions(planned(survey_of(field)), count)
            for each in given:
                assert repair(each.mission, profile) == Repaired((each.mission,))

    def test_each_vehicle_gets_one_and_numbers_rise(self) -> None:
        _state, given = missions(planned(survey_of(rectangle())), 3)
        assert [each.number for each in given] == [1, 2, 3]
        assert {each.serial for each in given} == {"S-0", "S-1", "S-2"}

    def test_the_near_share_goes_to_the_near_vehicle(self) -> None:
        plan = planned(survey_of(rectangle(300.0, 400.0), bearing_deg=90.0))
        created = create(plan)
        assert isinstance(created, SurveyState)
        begun = start(created, ["north", "south"], 0)
        assert isinstance(begun, SurveyState)
        state, _ = step(
            begun, [Surveyor("north", (150.0, 450.0)), Surveyor("south", (150.0, -50.0))], 10**10
        )
        middle_m = {
            serial: float(np.mean([corner[1] for corner in flight.corners_m]))
            for serial, flight in state.flights.items()
        }
        assert middle_m["north"] > 250.0
        assert middle_m["south"] < 150.0

    def test_the_frame_is_the_sites(self) -> None:
        assert planned(survey_of(rectangle())).cells.grid.frame == FRAME
