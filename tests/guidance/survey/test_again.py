"""The same field again: the same rows to the centimetre, and only what is left of them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.guidance.survey.fields import (
    FLOWN_S,
    FRAME,
    flown,
    l_shape,
    planned,
    rectangle,
    star,
    survey_of,
)

from recon.geo import enu_from_geo, geo_from_enu
from recon.guidance.survey import SurveyPlan, SurveyState, create, plan_survey
from recon.guidance.survey.again import with_rows
from recon.guidance.survey.estimate import Batteries, SurveyEstimate, estimate
from recon.guidance.survey.progress import first_pieces
from recon.guidance.survey.state import Surveyor
from recon.model.airspace import Region
from recon.model.arrays import BoolArray
from recon.model.command import Refusal
from recon.model.flown_region import FlownRegion
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.survey import CellState, RowChoice, Survey, SurveyCamera

DAY = "2026-05-01"
CENTIMETRE = 0.01


def named(over: Region, **changes: object) -> Survey:
    return replace(survey_of(over, bearing_deg=30.0), region_name="north", **changes)  # type: ignore[arg-type]


def again(
    survey: Survey,
    last: FlownRegion,
    choice: RowChoice = RowChoice.AUTO,
    frame: LocalFrame = FRAME,
) -> Survey:
    found = with_rows(survey, frame, [last], choice, lambda _: DAY)
    assert isinstance(found, Survey), found
    return found


def imported(over: Region) -> Region:
    """The region from a file with seven decimals, begun at another corner, the other way round."""
    flat_m = np.column_stack([over.outline_m, np.zeros(len(over.outline_m))])
    latitude_deg, longitude_deg, _ = geo_from_enu(FRAME, flat_m)
    rounded = np.round(latitude_deg, 7), np.round(longitude_deg, 7)
    outline_m = enu_from_geo(FRAME, *rounded, np.zeros(len(flat_m)) + 250.0)[:, :2]
    return Region(np.roll(outline_m[::-1], 1, axis=0), over.holes_m)


class TestRows:
    @given(st.integers(0, 999))
    def test_an_outline_read_again_gives_the_same_rows(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        field = star(rng, float(rng.uniform(80.0, 250.0)), has_hole=False)
        before = planned(replace(survey_of(field), region_name="north"))
        survey = again(replace(survey_of(imported(field)), region_name="north"), flown(before))
        assert survey.rows_note == f"Same rows as on {DAY}"
        after = planned(survey)
        assert np.abs(np.array(after.rows_m) - np.array(before.rows_m)).max() < CENTIMETRE
        assert np.array_equal(after.cells.is_reached, before.cells.is_reached)

    @given(st.floats(-120.0, 120.0), st.floats(-80.0, 80.0))
    def test_a_grown_region_keeps_the_rows_of_then_and_gets_more(
        self, east_m: float, north_m: float
    ) -> None:
        before = planned(named(rectangle(300.0, 200.0)))
        corners = [(min(0, east_m), min(0, north_m)), (300 + max(0, east_m), min(0, north_m))]
        corners += [(300 + max(0, east_m), 200 + max(0, north_m)), (min(0, east_m), 200.0)]
        survey = again(named(Region(np.array(corners))), flown(before), RowChoice.AS_BEFORE)
        lattice = planned(survey).lattice
        offsets = (lattice.rows_across_m - before.lattice.first_row_m) / lattice.spacing_m
        assert np.abs(offsets - np.round(offsets)).max() * lattice.spacing_m < CENTIMETRE
        assert set(range(before.lattice.rows)) <= set(np.round(offsets).astype(int).tolist())

    def test_an_outline_that_was_changed_gets_new_rows_and_the_note_says_what_differs(self) -> None:
        last = flown(planned(named(rectangle())))
        survey = again(named(rectangle(320.0)), last)
        assert survey.lattice is None
        assert survey.rows_note == (
            f"New rows: since {DAY} the region's outline has moved by up to 20.0 m: it was 6.00 ha "
            "and is 6.40 ha"
        )
        assert "outline" in again(named(rectangle(320.0)), last, RowChoice.AS_BEFORE).rows_note

    @pytest.mark.parametrize(
        ("changes", "words"),
        [
            ({"height_above_takeoff_m": 50.0}, "the height was 60 m above takeoff and is 50 m"),
            ({"camera": SurveyCamera(70.0)}, "the camera was 66.0° x 52.0° and is 70.0° x 52.0°"),
            ({"side_overlap": 0.5}, "the overlap was 70% front, 60% side and is 70% front, 50%"),
            ({"row_bearing_deg": 31.0}, "rows ran at 30.0° and 31.0° is asked for"),
        ],
    )
    def test_what_decides_the_rows_is_compared(
        self, changes: dict[str, object], words: str
    ) -> None:
        survey = again(named(l_shape(), **changes), flown(planned(named(l_shape()))))
        assert survey.lattice is None
        assert words in survey.rows_note

    def test_the_opposite_bearing_and_another_speed_leave_the_rows(self) -> None:
        before = planned(named(l_shape()))
        for changes in ({"row_bearing_deg": 210.0}, {"speed_mps": 5.0}):
            after = planned(again(named(l_shape(), **changes), flown(before)))
            assert np.array_equal(after.lattice.rows_across_m, before.lattice.rows_across_m)

    def test_rows_too_far_apart_for_the_overlap_are_refused(self) -> None:
        last = flown(planned(named(l_shape())))
        survey = again(named(l_shape(), side_overlap=0.8), last, RowChoice.AS_BEFORE)
        plan = plan_survey(survey, FRAME)
        assert isinstance(plan, Refusal)
        assert "choose those of then, or new rows" in plan.reason

    def test_a_moved_origin_is_named_and_its_rows_cannot_be_had(self) -> None:
        last = flown(planned(named(l_shape())))
        moved = LocalFrame(GeoPoint(44.991, -93.2, 250.0))
        assert "origin has moved by 111." in again(named(l_shape()), last, frame=moved).rows_note
        asked = with_rows(named(l_shape()), moved, [last], RowChoice.AS_BEFORE, lambda _: DAY)
        assert isinstance(asked, Refusal)
        assert "origin has moved" in asked.reason

    def test_a_drawn_region_and_one_never_flown_have_no_note(self) -> None:
        last = flown(planned(named(l_shape())))
        for name in (None, "south"):
            survey = replace(named(l_shape()), region_name=name)
            assert again(survey, last) is survey
            refused = with_rows(survey, FRAME, [last], RowChoice.AS_BEFORE, lambda _: DAY)
            assert isinstance(refused, Refusal)


class TestRest:
    def test_only_what_was_not_imaged_is_flown_and_estimated(self) -> None:
        whole = planned(named(rectangle()))
        is_west = whole.cells.is_reached & (whole.cells.along_m < np.median(whole.cells.along_m))
        rest = rest_of(whole, is_west)
        wanted = first_pieces(rest)
        whole_m, left_m = (sum(p.length_m for p in each) for each in (whole.pieces, wanted))
        assert 0.4 * whole_m < left_m < 0.65 * whole_m
        alone = [Surveyor("A", (0.0, 0.0))]
        all_of_it, needs = (estimate(each, alone, Batteries()) for each in (whole, rest))
        assert isinstance(all_of_it, SurveyEstimate)
        assert isinstance(needs, SurveyEstimate)
        assert needs.photos < 0.65 * all_of_it.photos

    def test_its_figures_begin_with_what_was_imaged(self) -> None:
        whole = planned(named(rectangle()))
        is_west = whole.cells.is_reached & (whole.cells.along_m < np.median(whole.cells.along_m))
        state = create(rest_of(whole, is_west))
        assert isinstance(state, SurveyState)
        assert np.array_equal(state.progress.state == CellState.IN_SUN, is_west)
        assert np.array_equal(state.missing(), whole.cells.is_reached & ~is_west)

    def test_cells_count_from_the_asked_moment_on(self) -> None:
        last = flown(planned(named(rectangle())))
        assert (last.cells_since(FLOWN_S).state == CellState.IN_SUN).all()
        assert (last.cells_since(FLOWN_S + 1).state == CellState.NOT_YET).all()
        assert not last.is_left(FLOWN_S).any()
        assert np.array_equal(last.is_left(FLOWN_S + 1), last.is_reached)

    def test_nothing_left_is_refused(self) -> None:
        whole = planned(named(rectangle()))
        refused = create(rest_of(whole, whole.cells.is_reached))
        assert isinstance(refused, Refusal)
        assert "nothing is left to fly" in refused.reason


def rest_of(whole: SurveyPlan, imaged: BoolArray) -> SurveyPlan:
    last = flown(whole, imaged)
    survey = replace(whole.survey, lattice=last.lattice, flown=last.cells_since(FLOWN_S))
    return planned(survey)
