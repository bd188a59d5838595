"""Photos that are reported: what counts as imaged, and in which light."""

from dataclasses import replace

import numpy as np
import pytest
from tests.guidance.survey.test_progress import LATE_NS, PLAN, ROW_M, imaged, shade

from recon.guidance.survey import CoverageProgress, PhotoSample, SurveyState, create, observe, start
from recon.guidance.survey.photo_progress import count_settled_photos, with_photos
from recon.guidance.survey.progress import first_progress, with_shade
from recon.model.shade import ShadeMap
from recon.model.survey import CellState
from recon.model.units import seconds_to_ns

PHOTO = PhotoSample(seconds_to_ns(10.0), 150.0, ROW_M, 60.0, 90.0)


def counted(*photos: PhotoSample, maps: tuple[ShadeMap, ...] = ()) -> CoverageProgress:
    progress = first_progress(PLAN)
    for each in maps:
        progress = with_shade(progress, each, PLAN)
    return count_settled_photos(with_photos(progress, photos), PLAN, LATE_NS)


def test_a_photo_images_its_footprint_less_the_slack_and_nothing_else() -> None:
    swath = PLAN.counted_swath
    near = (np.abs(PLAN.cells.along_m - 150.0) <= swath.half_along_m) & PLAN.cells.is_inside
    near &= np.abs(PLAN.cells.across_m - PLAN.lattice.row_across_m(3)) <= swath.half_across_m
    assert near.sum() > 50
    assert (imaged(counted(PHOTO)) == near).all()


@pytest.mark.parametrize("yaw_deg", [90.0, 100.0, -90.0, 270.0])
def test_a_photo_along_the_row_counts_either_way(yaw_deg: float) -> None:
    assert imaged(counted(replace(PHOTO, yaw_deg=yaw_deg))).any()


@pytest.mark.parametrize(
    "change",
    [
        {"yaw_deg": 0.0},
        {"yaw_deg": 110.0},
        {"height_above_takeoff_m": 70.0},
        {"height_above_takeoff_m": 50.0},
        {"gimbal_pitch_deg": -60.0},
        {"east_m": 900.0},
    ],
)
def test_a_photo_that_is_taken_otherwise_than_planned_does_not_count(
    change: dict[str, float],
) -> None:
    assert not imaged(counted(replace(PHOTO, **change))).any()


def test_it_counts_in_the_light_of_its_own_time() -> None:
    lit, shaded = shade(10.0), shade(40.0, is_lit=False)
    assert (counted(PHOTO, maps=(lit, shaded)).state == CellState.IN_SUN).any()
    later = replace(PHOTO, at_ns=seconds_to_ns(40.0))
    states = counted(later, maps=(lit, shaded))
    assert (states.state == CellState.IN_SHADE).any()
    assert not (states.state == CellState.IN_SUN).any()
    assert (states.is_sun_known == imaged(states)).all()
    assert not counted(PHOTO).is_sun_known.any()


def test_it_counts_when_it_has_settled_and_once() -> None:
    waiting = with_photos(first_progress(PLAN), [PHOTO])
    early = count_settled_photos(waiting, PLAN, PHOTO.at_ns)
    assert early is waiting
    done = count_settled_photos(waiting, PLAN, LATE_NS)
    assert done.photos == ()
    assert count_settled_photos(done, PLAN, LATE_NS) is done


def test_a_survey_observes_photos_of_its_own_vehicles() -> None:
    state = start(create(PLAN), ("A",), 0)
    assert isinstance(state, SurveyState)
    assert observe(state, "A", [PHOTO]).progress.photos == (PHOTO,)
    assert observe(state, "B", [PHOTO]).progress.photos == ()
