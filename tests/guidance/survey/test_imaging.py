"""Pixels on the ground and speed limits: round trips, and overlaps reached by construction."""

from dataclasses import replace
from itertools import pairwise
from math import floor, radians, tan

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.guidance.survey.fields import FRAME, rectangle, survey_of

from recon.guidance.survey import SurveyPlan, plan_survey
from recon.guidance.survey.imaging import (
    best_interval_s,
    blur_px,
    height_for_gsd_m,
    speed_limits,
)
from recon.guidance.survey.settings import DEFAULT
from recon.model.survey import SurveyCamera
from recon.model.survey_camera import CAMERAS, SurveyCameraError, camera_named, of_diagonal

MODELS = st.sampled_from(sorted(CAMERAS))


@given(MODELS, st.floats(0.002, 0.5))
def test_the_height_for_a_pixel_size_gives_that_pixel_size(name: str, gsd_m: float) -> None:
    camera = CAMERAS[name].at_interval(2.0)
    height_m = height_for_gsd_m(camera, gsd_m)
    assert height_m is not None
    assert camera.gsd_m(height_m) == pytest.approx(gsd_m)


@pytest.mark.parametrize("name", sorted(CAMERAS))
def test_pixels_are_square(name: str) -> None:
    model = CAMERAS[name]
    camera = model.at_interval(2.0)
    along_m = camera.along_m(100.0) / model.along_px
    assert along_m == pytest.approx(camera.gsd_m(100.0), rel=0.01)


@pytest.mark.parametrize(
    ("name", "metres_per_cm"),
    [("p4rtk", 36.5), ("p4m", 18.9), ("p1-24mm", 55.0), ("p1-35mm", 80.0), ("p1-50mm", 114.0)],
)
def test_pixel_sizes_are_those_that_the_maker_states(name: str, metres_per_cm: float) -> None:
    """DJI writes them as height over a number, in centimetres."""
    gsd_m = CAMERAS[name].at_interval(2.0).gsd_m(100.0)
    assert gsd_m == pytest.approx(1.0 / metres_per_cm, rel=0.01)


@given(MODELS, st.floats(20.0, 120.0), st.floats(0.3, 0.9), st.floats(1e-4, 0.01))
def test_at_the_speed_limit_nothing_is_exceeded(
    name: str, height_m: float, front: float, exposure_s: float
) -> None:
    camera = CAMERAS[name].at_interval(2.0)
    limit, *others = speed_limits(camera, height_m, front, exposure_s, 15.0)
    speed_mps = limit.speed_mps
    assert all(each.speed_mps >= speed_mps for each in others)
    assert speed_mps <= 15.0
    assert blur_px(camera, height_m, speed_mps, exposure_s) <= 0.5 + 1e-9
    photo_m = speed_mps * camera.interval_s
    overlap_m = camera.along_m(height_m) - photo_m
    assert overlap_m >= front * camera.along_m(height_m) - 1e-6
    # The limit that is named is met exactly.
    reached = {
        "fastest allowed": speed_mps == 15.0,
        "blur": blur_px(camera, height_m, speed_mps, exposure_s) >= 0.5 - 1e-9,
        "front overlap": overlap_m == pytest.approx(front * camera.along_m(height_m))
        or photo_m == pytest.approx(camera.along_m(height_m) - 2.0 * DEFAULT.place_slack_m),
    }
    assert [is_met for words, is_met in reached.items() if words in limit.reason] == [True]


@given(MODELS, st.floats(20.0, 120.0), st.floats(0.3, 0.9))
def test_the_best_interval_costs_no_speed_and_the_next_longer_one_would(
    name: str, height_m: float, front: float
) -> None:
    model = CAMERAS[name]
    chosen_s = best_interval_s(model, height_m, front)

    def fastest(interval_s: float) -> float:
        return speed_limits(model.at_interval(interval_s), height_m, front)[0].speed_mps

    assert fastest(chosen_s) == pytest.approx(max(fastest(s) for s in model.timer_s))
    longer = [s for s in model.timer_s if s > chosen_s]
    assert all(fastest(s) < fastest(chosen_s) for s in longer[:1])


@given(MODELS, st.floats(0.1, 5.0), st.integers(1, 12))
def test_the_best_interval_is_one_of_the_timers_from_a_height_too_low_for_any(
    name: str, height_m: float, count: int
) -> None:
    model = CAMERAS[name]
    model = replace(model, timer_s=model.timer_s[:count])
    chosen_s = best_interval_s(model, height_m, 0.9)

    def fastest(interval_s: float) -> float:
        return speed_limits(model.at_interval(interval_s), height_m, 0.9)[0].speed_mps

    assert chosen_s in model.timer_s
    assert fastest(chosen_s) == pytest.approx(max(fastest(s) for s in model.timer_s))


@given(
    st.sampled_from(["mavic3m", "mini3pro", "p4m", "p1-35mm"]),
    st.floats(40.0, 110.0),
    st.floats(0.4, 0.85),
    st.floats(0.3, 0.85),
)
def test_overlaps_are_reached_by_the_rows_that_are_planned(
    name: str, height_m: float, front: float, side: float
) -> None:
    """Photos are laid out along the planned rows; what two neighbours share is measured."""
    model = CAMERAS[name]
    camera = model.at_interval(best_interval_s(model, height_m, front))
    speed_mps = speed_limits(camera, height_m, front)[0].speed_mps
    if speed_mps < 0.5:
        return
    survey = survey_of(
        rectangle(), camera=camera, height_m=height_m, speed_mps=speed_mps, front=front, side=side
    )
    plan = plan_survey(survey, FRAME)
    assert isinstance(plan, SurveyPlan), plan
    across_m = 2.0 * height_m * tan(radians(camera.across_deg) / 2.0)
    along_m = 2.0 * height_m * tan(radians(camera.along_deg) / 2.0)
    rows_m = sorted({plan.lattice.row_across_m(piece.row) for piece in plan.pieces})
    for here_m, there_m in pairwise(rows_m):
        assert across_m - (there_m - here_m) >= side * across_m - 1e-6
    assert along_m - speed_mps * camera.interval_s >= front * along_m - 1e-6
    # The timer's phase is unknown: with the lead, the last photo still shows the piece's end.
    for piece in plan.pieces:
        flown_m = piece.length_m + 2.0 * plan.swath.lead_m
        for phase in (0.0, 0.5, 0.999):
            photo_m = plan.swath.photo_m
            last_m = phase * photo_m + photo_m * floor(flown_m / photo_m - phase)
            assert last_m + along_m / 2.0 >= plan.swath.lead_m + piece.length_m


def test_a_camera_without_pixels_has_no_blur_limit_and_no_pixel_size() -> None:
    camera = SurveyCamera()
    assert camera.gsd_m(60.0) is None
    assert height_for_gsd_m(camera, 0.02) is None
    assert not any("blur" in limit.reason for limit in speed_limits(camera, 60.0, 0.7))


def test_an_unknown_camera_is_answered_with_the_known_ones() -> None:
    with pytest.raises(SurveyCameraError, match=r"available: mavic3m, .*did you mean 'mini3pro'"):
        camera_named("mini3prro")


@given(st.integers(100, 9000), st.integers(100, 9000), st.floats(5.0, 150.0))
def test_a_diagonal_angle_is_that_of_the_two_sides(across: int, along: int, deg: float) -> None:
    _, _, across_deg, along_deg = of_diagonal(across, along, deg)
    halves = [tan(radians(side) / 2.0) for side in (across_deg, along_deg)]
    assert (halves[0] ** 2 + halves[1] ** 2) ** 0.5 == pytest.approx(tan(radians(deg) / 2.0))
