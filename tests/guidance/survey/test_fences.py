"""Missions of surveys planned with the site's fences, before the gate's own rules."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.guidance.survey.fields import l_shape, rectangle, star, survey_of
from tests.safety.fenced import FRAME, airspace, asked, flier, keep_out_zone

from recon.guidance.survey import (
    Surveyor,
    SurveyPlan,
    SurveyState,
    SurveySurroundings,
    create,
    plan_survey,
    start,
    step,
)
from recon.model.airspace import FlightLimits, Region
from recon.model.command import FlyMission, Refusal
from recon.model.vehicle import Failsafe
from recon.safety.rules.boundary import boundary
from recon.safety.rules.keep_out import keep_out

LIMITS = FlightLimits(
    max_height_above_ground_m=500.0, max_distance_from_home_m=8_000.0, boundary_margin_m=5.0
)


def refusals(field: Region, fence: Region, closed: tuple[Region, ...], count: int) -> list[Refusal]:
    """What boundary and keep-out say to each mission, of a vehicle that hovers where it begins.

    It would hover without its link: the leg to the field and home is not the survey's.
    """
    around = SurveySurroundings(fence, closed, LIMITS.boundary_margin_m)
    plan = plan_survey(survey_of(field), FRAME, around)
    if not isinstance(plan, SurveyPlan):
        return []
    created = create(plan)
    assert isinstance(created, SurveyState)
    surveyors = [Surveyor(f"S-{i}", (0.0, 0.0)) for i in range(count)]
    begun = start(created, [each.serial for each in surveyors], 0)
    assert isinstance(begun, SurveyState)
    state, missions = step(begun, surveyors, 10**10)
    air = airspace(*map(keep_out_zone, closed), boundary=fence, limits=LIMITS)
    refusals: list[Refusal] = []
    for each in missions:
        east_m, north_m = state.flights[each.serial].corners_m[0]
        hovering = flier(east_m, north_m, 60.0, failsafe=Failsafe.HOVER)
        for rule in (boundary, keep_out):
            refusal = asked(rule, FlyMission(each.mission), air, hovering)
            refusals += [refusal] if refusal else []
    return refusals


@settings(max_examples=examples(30), deadline=None)
@given(st.integers(0, 10**9), st.integers(1, 4))
def test_the_gate_lets_the_missions_of_drawn_sites_through(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    field = star(rng, float(rng.uniform(100.0, 250.0)), has_hole=bool(rng.random() < 0.5))
    if rng.random() < 0.5:
        fence = field
    else:
        middle_m = field.outline_m.mean(axis=0)
        fence = Region(middle_m + 1.4 * (field.outline_m - middle_m))
    zones = tuple(star(rng, float(rng.uniform(15.0, 50.0)), has_hole=False) for _ in range(2))
    assert [each.reason for each in refusals(field, fence, zones, count)] == []


@pytest.mark.parametrize("count", [1, 3, 8])
def test_the_gate_lets_an_l_shape_through_that_is_its_own_fence(count: int) -> None:
    assert refusals(l_shape(), l_shape(), (), count) == []


def test_a_zone_across_the_field_ends_a_mission() -> None:
    """The path over to the other part is a mission's path to its first row: the gate's to judge."""
    across = Region(np.array([(120.0, -50.0), (160.0, -50.0), (160.0, 250.0), (120.0, 250.0)]))
    assert refusals(rectangle(), rectangle(), (across,), 1) == []
