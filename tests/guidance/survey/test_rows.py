"""Rows: every place of a region is in a photo, whatever the timer's phase; and no row strays."""

from dataclasses import replace
from itertools import pairwise
from math import hypot, pi, radians, tan

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.guidance.survey.fields import (
    FRAME,
    distance_m,
    holed,
    is_inside,
    l_shape,
    planned,
    points_in,
    rectangle,
    region,
    star,
    survey_of,
)

from recon.guidance.survey import SurveyPlan, SurveySurroundings, plan_survey
from recon.guidance.survey.plan import row_reach_m
from recon.guidance.survey.rows import Piece
from recon.model.airspace import Region
from recon.model.command import Refusal
from recon.model.survey import Survey, SurveyCamera

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

OVERLAPS = st.sampled_from([(0.7, 0.6), (0.8, 0.7), (0.3, 0.2), (0.15, 0.2), (0.5, 0.0)])


def drawn(seed: int, overlaps: tuple[float, float], fast_share: float = 1.0) -> Survey:
    """A survey of a drawn field, flown as fast as the overlap allows."""
    rng = np.random.default_rng(seed)
    front, side = overlaps
    field = star(rng, float(rng.uniform(60.0, 300.0)), bool(rng.random() < 0.5))
    camera = SurveyCamera(float(rng.uniform(50, 80)), float(rng.uniform(35, 60)))
    height_m = float(rng.uniform(40.0, 100.0))
    shown_m = 2.0 * height_m * tan(radians(camera.along_deg / 2.0))
    fastest_mps = min(shown_m * (1.0 - front), shown_m - 6.0) / camera.interval_s
    bearing_deg = float(rng.uniform(0.0, 180.0)) if rng.random() < 0.5 else None
    return survey_of(
        field,
        camera=camera,
        height_m=height_m,
        speed_mps=min(15.0, fastest_mps * fast_share),
        front=front,
        side=side,
        bearing_deg=bearing_deg,
    )


def photos_m(plan: SurveyPlan, phase: float) -> FloatArray:
    """Where photos are taken, (N, 2) east-north: one each interval, from a phase of it on."""
    places: list[FloatArray] = []
    photo_m = plan.survey.speed_mps * plan.survey.camera.interval_s
    for start_m, end_m in flown_m(plan):
        far_m = float(np.hypot(*(end_m - start_m)))
        along_m = np.arange(phase * photo_m, far_m + 1e-9, photo_m)
        places.append(start_m + along_m[:, np.newaxis] * (end_m - start_m) / far_m)
    return np.concatenate(places)


def flown_m(plan: SurveyPlan) -> list[tuple[FloatArray, FloatArray]]:
    lead_m = plan.swath.lead_m
    return [
        (
            east_north(plan, piece.row, piece.start_m - lead_m),
            east_north(plan, piece.row, piece.end_m + lead_m),
        )
        for piece in plan.pieces
    ]


def east_north(plan: SurveyPlan, row: int, along_m: float) -> FloatArray:
    """By the bearing's own trigonometry: along is clockwise from north, across to its right."""
    bearing = plan.lattice.bearing_deg * pi / 180.0
    ahead = np.array([np.sin(bearing), np.cos(bearing)])
    right = np.array([np.cos(bearing), -np.sin(bearing)])
    place: FloatArray = along_m * ahead + plan.lattice.row_across_m(row) * right
    return place


def are_shown(plan: SurveyPlan, points_m: FloatArray, phase: float) -> BoolArray:
    """Which points are in at least one photo's whole footprint."""
    camera = plan.survey.camera
    half_across_m = plan.survey.height_above_takeoff_m * tan(radians(camera.across_deg / 2.0))
    half_along_m = plan.survey.height_above_takeoff_m * tan(radians(camera.along_deg / 2.0))
    bearing = plan.lattice.bearing_deg * pi / 180.0
    shown = np.zeros(len(points_m), dtype=np.bool_)
    for photo in photos_m(plan, phase):
        east_m, north_m = (points_m - photo).T
        along_m = east_m * np.sin(bearing) + north_m * np.cos(bearing)
        across_m = east_m * np.cos(bearing) - north_m * np.sin(bearing)
        shown |= (np.abs(along_m) <= half_along_m) & (np.abs(across_m) <= half_across_m)
    return shown


class TestCoverage:
    @settings(max_examples=examples(60), deadline=None)
    @given(st.integers(0, 10**9), OVERLAPS, st.floats(0.0, 1.0))
    def test_every_place_of_a_drawn_field_is_in_a_photo(
        self, seed: int, overlaps: tuple[float, float], phase: float
    ) -> None:
        plan = planned(drawn(seed, overlaps))
        points_m = points_in(plan.survey.region, np.random.default_rng(seed), 2000)
        shown = are_shown(plan, points_m, phase)
        assert shown.all(), points_m[~shown][:5]

    @pytest.mark.parametrize("field", [l_shape(), holed(), rectangle()], ids="LHR")
    @pytest.mark.parametrize("phase", [0.0, 0.5, 0.999])
    def test_every_place_of_a_known_field_is_in_a_photo(self, field: Region, phase: float) -> None:
        plan = planned(survey_of(field))
        points_m = points_in(field, np.random.default_rng(7), 5000)
        assert are_shown(plan, points_m, phase).all()

    @pytest.mark.parametrize("phase", [0.0, 0.5, 0.999])
    def test_a_field_smaller_than_a_photo_distance_is_in_a_photo(self, phase: float) -> None:
        field = rectangle(9.0, 7.0)
        plan = planned(survey_of(field, cell_m=1.0))
        assert are_shown(plan, points_in(field, np.random.default_rng(7), 500), phase).all()

    def test_the_sampler_finds_a_missing_row(self) -> None:
        plan = planned(survey_of(rectangle(), side=0.2))
        pieces = tuple(piece for piece in plan.pieces if piece.row != 1)
        points_m = points_in(rectangle(), np.random.default_rng(7), 5000)
        assert not are_shown(replace(plan, pieces=pieces), points_m, 0.5).all()

    @settings(max_examples=examples(40), deadline=None)
    @given(st.integers(0, 10**9), OVERLAPS)
    def test_every_cell_of_a_drawn_field_has_a_stretch_that_answers_for_it(
        self, seed: int, overlaps: tuple[float, float]
    ) -> None:
        plan = planned(drawn(seed, overlaps))
        assert (plan.cells.is_reached == plan.cells.is_inside).all()


class TestStraying:
    @settings(max_examples=examples(60), deadline=None)
    @given(st.integers(0, 10**9), OVERLAPS)
    def test_no_place_of_a_row_is_farther_out_than_documented(
        self, seed: int, overlaps: tuple[float, float]
    ) -> None:
        plan = planned(drawn(seed, overlaps))
        most_m = hypot(
            plan.lattice.spacing_m / 2.0, max(plan.swath.lead_m, 0.525 * plan.swath.photo_m)
        )
        assert row_reach_m(plan.lattice, plan.swath) == pytest.approx(most_m)
        for start_m, end_m in flown_m(plan):
            places = start_m + np.linspace(0.0, 1.0, 60)[:, np.newaxis] * (end_m - start_m)
            assert distance_m(plan.survey.region, places).max() <= most_m + 1e-6

    def test_rows_of_a_rectangle_end_on_its_edge(self) -> None:
        plan = planned(survey_of(rectangle(300.0, 200.0), bearing_deg=90.0))
        assert {(round(p.start_m, 6), round(p.end_m, 6)) for p in plan.pieces} == {(0.0, 300.0)}

    def test_with_little_front_overlap_rows_run_on_beyond_it(self) -> None:
        plan = planned(survey_of(rectangle(), speed_mps=14.0, front=0.5, bearing_deg=90.0))
        shown_m = 2.0 * 60.0 * tan(radians(26.0))
        assert plan.swath.lead_m == pytest.approx(28.0 - (shown_m / 2.0 - 3.0))


class TestLattice:
    @settings(max_examples=examples(40), deadline=None)
    @given(st.integers(0, 10**9), OVERLAPS)
    def test_rows_are_as_far_apart_as_the_side_overlap_allows(
        self, seed: int, overlaps: tuple[float, float]
    ) -> None:
        plan = planned(drawn(seed, overlaps))
        camera, height_m = plan.survey.camera, plan.survey.height_above_takeoff_m
        shown_m = 2.0 * height_m * tan(radians(camera.across_deg / 2.0))
        widest_m = min(shown_m * (1.0 - plan.survey.side_overlap), shown_m - 6.0)
        assert plan.lattice.spacing_m <= widest_m + 1e-9
        one_less = (plan.lattice.rows - 1) * widest_m
        assert plan.lattice.rows == 1 or plan.lattice.rows * plan.lattice.spacing_m > one_less

    @settings(max_examples=examples(40), deadline=None)
    @given(st.integers(0, 10**9), OVERLAPS)
    def test_stretches_join_to_their_pieces_on_marks(
        self, seed: int, overlaps: tuple[float, float]
    ) -> None:
        plan = planned(drawn(seed, overlaps))
        lattice = plan.lattice
        for index, piece in enumerate(plan.pieces):
            own = [s for s in plan.cells.stretches if s.piece == index]
            assert (own[0].start_m, own[-1].end_m) == (piece.start_m, piece.end_m)
            for a, b in pairwise(own):
                marks = (a.end_m - lattice.first_mark_m) / lattice.mark_m
                assert a.end_m == b.start_m
                assert marks == pytest.approx(round(marks), abs=1e-6)

    def test_marks_are_whole_photo_distances_apart(self) -> None:
        plan = planned(survey_of(rectangle(), speed_mps=3.0))
        assert plan.lattice.mark_m == pytest.approx(2 * 6.0)

    def test_pieces_of_a_row_do_not_overlap(self) -> None:
        plan = planned(survey_of(holed()))
        for a, b in pairwise(plan.pieces):
            assert b.row > a.row or b.start_m > a.end_m

    def test_rows_to_show_are_those_that_are_flown(self) -> None:
        plan = planned(survey_of(l_shape(), front=0.4, speed_mps=15.0))
        assert plan.swath.lead_m > 0.0
        for (start_m, end_m), (shown_start_m, shown_end_m) in zip(
            flown_m(plan), plan.rows_m, strict=True
        ):
            assert np.allclose(start_m, shown_start_m)
            assert np.allclose(end_m, shown_end_m)


class TestDirection:
    def test_a_long_field_is_flown_lengthwise(self) -> None:
        plan = planned(survey_of(rectangle(600.0, 100.0)))
        assert plan.lattice.bearing_deg == pytest.approx(90.0)

    def test_whichever_way_it_is_turned(self) -> None:
        turn = radians(37.0)
        corners = np.array([(0, 0), (600, 0), (600, 100), (0, 100)], dtype=np.float64)
        turned = corners @ np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        plan = planned(survey_of(Region(turned)))
        assert plan.lattice.bearing_deg == pytest.approx(90.0 + 37.0, abs=0.1)

    def test_a_bay_is_not_crossed_by_more_rows_than_needed(self) -> None:
        comb = region(
            [(0, 0), (500, 0), (500, 200), (300, 200), (300, 60), (200, 60), (200, 200), (0, 200)]
        )
        plan = planned(survey_of(comb))
        across = planned(survey_of(comb, bearing_deg=90.0))
        assert len(plan.pieces) <= len(across.pieces)

    def test_a_given_one_is_kept(self) -> None:
        assert planned(survey_of(l_shape(), bearing_deg=200.0)).lattice.bearing_deg == 20.0


class TestSurroundings:
    def test_rows_keep_off_zones_and_boundary(self) -> None:
        closed = Region(np.array([(100.0, 60.0), (180.0, 60.0), (180.0, 140.0), (100.0, 140.0)]))
        field = rectangle()
        plan = plan_survey(
            survey_of(field), FRAME, SurveySurroundings(field, (closed,), margin_m=5.0)
        )
        assert isinstance(plan, SurveyPlan)
        for start_m, end_m in flown_m(plan):
            places = start_m + np.linspace(0.0, 1.0, 200)[:, np.newaxis] * (end_m - start_m)
            assert is_inside(field, places).all()
            assert distance_m(closed, places).min() >= 5.0

    def test_unreached_area_is_reported(self) -> None:
        closed = Region(np.array([(100.0, 60.0), (180.0, 60.0), (180.0, 140.0), (100.0, 140.0)]))
        plan = plan_survey(survey_of(rectangle()), FRAME, SurveySurroundings(keep_out=(closed,)))
        assert isinstance(plan, SurveyPlan)
        missed = plan.cells.is_inside & ~plan.cells.is_reached
        assert 0 < missed.sum() * plan.cells.cell_m2 < 90.0 * 90.0

    def test_no_room_for_a_row_is_refused(self) -> None:
        far = Region(np.array([(900.0, 900.0), (990.0, 900.0), (990.0, 990.0)]))
        refusal = plan_survey(survey_of(rectangle()), FRAME, SurveySurroundings(far))
        assert isinstance(refusal, Refusal)
        assert "the region north field lies outside the site's boundary" in refusal.reason

    @settings(max_examples=examples(25), deadline=None)
    @given(st.integers(0, 10**9))
    def test_every_cell_counted_as_reached_is_in_a_photo(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        survey = drawn(seed, (0.7, 0.6))
        zone = star(rng, 40.0, has_hole=False)
        surroundings = SurveySurroundings(survey.region, (zone,), margin_m=3.0)
        plan = plan_survey(survey, FRAME, surroundings)
        if isinstance(plan, Refusal):
            return
        rows, cols = np.nonzero(plan.cells.is_reached)
        grid = plan.cells.grid
        middles = np.column_stack(
            [
                grid.west_m + (cols + 0.5) * grid.cell_m,
                grid.north_m - (rows + 0.5) * grid.cell_m,
            ]
        )
        assert are_shown(plan, middles, float(rng.uniform())).all()


class TestRefusals:
    @pytest.mark.parametrize(
        ("change", "words"),
        [
            ({"speed_mps": 12.0}, "fly at 8.8 m/s at most"),
            ({"height_above_takeoff_m": 8.0, "speed_mps": 1.0}, "fly higher"),
            ({"side_overlap": 1.0}, "side overlap is 1"),
            ({"front_overlap": float("nan")}, "front overlap is nan"),
            ({"cell_m": 0.1}, "cell is 0.1 m"),
            (
                {"region": Region(np.array([(0.0, 0.0), (9.0, 9.0), (9.0, 0.0), (0.0, 9.0)]))},
                "edges cross",
            ),
            ({"region": rectangle(90_000.0, 9_000.0)}, "90.0 x 9.0 km"),
        ],
    )
    def test_infeasible_surveys_are_refused_with_a_reason(
        self, change: dict[str, object], words: str
    ) -> None:
        refusal = plan_survey(replace(survey_of(rectangle()), **change), FRAME)
        assert isinstance(refusal, Refusal)
        assert words in refusal.reason


class TestFlyingAgain:
    def test_pieces_over_all_cells_are_all_pieces(self) -> None:
        plan = planned(survey_of(holed()))
        assert plan.pieces_over(plan.cells.is_inside) == plan.pieces

    @pytest.mark.parametrize("phase", [0.0, 0.5, 0.999])
    def test_pieces_over_one_stretch_show_all_of_it(self, phase: float) -> None:
        plan = planned(survey_of(rectangle(100.0, 60.0), bearing_deg=90.0))
        cells = plan.cells
        assert min(s.end_m - s.start_m for s in cells.stretches) < plan.swath.photo_m / 2.0
        for index in range(len(cells.stretches)):
            rows, cols = np.nonzero(cells.stretch == index)
            again = replace(plan, pieces=plan.pieces_over(cells.stretch == index))
            at = np.column_stack(
                [
                    cells.grid.west_m + (cols + 0.5) * cells.grid.cell_m,
                    cells.grid.north_m - (rows + 0.5) * cells.grid.cell_m,
                ]
            )
            assert len(at) > 0
            assert are_shown(again, at, phase).all()

    def test_nothing_wanted_is_nothing_flown(self) -> None:
        plan = planned(survey_of(holed()))
        assert plan.pieces_over(np.zeros_like(plan.cells.is_inside)) == ()

    @settings(max_examples=examples(40), deadline=None)
    @given(st.integers(0, 10**9), OVERLAPS, st.floats(0.0, 1.0))
    def test_pieces_over_some_cells_show_them_all(
        self, seed: int, overlaps: tuple[float, float], phase: float
    ) -> None:
        plan = planned(drawn(seed, overlaps))
        rng = np.random.default_rng(seed)
        cells = plan.cells
        spot = rng.integers(0, cells.is_inside.shape)
        rows, cols = np.indices(cells.is_inside.shape)
        wanted = np.hypot(rows - spot[0], cols - spot[1]) * cells.grid.cell_m < 30.0
        wanted &= cells.is_inside
        if not wanted.any():
            return
        again = replace(plan, pieces=plan.pieces_over(wanted))
        at = np.column_stack(
            [
                cells.grid.west_m + (cols[wanted] + 0.5) * cells.grid.cell_m,
                cells.grid.north_m - (rows[wanted] + 0.5) * cells.grid.cell_m,
            ]
        )
        assert are_shown(again, at, phase).all()
        assert all(_is_part(piece, plan) for piece in again.pieces)


def _is_part(piece: Piece, plan: SurveyPlan) -> bool:
    return any(
        whole.row == piece.row and whole.start_m <= piece.start_m and piece.end_m <= whole.end_m
        for whole in plan.pieces
    )
