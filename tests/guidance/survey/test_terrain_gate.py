"""Missions of surveys above ground, before the gate's own rules about heights."""

from dataclasses import replace

from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.guidance.survey.fields import rectangle, survey_of
from tests.guidance.survey.grounds import Ground, hills, model, slope
from tests.safety.fenced import FRAME, airspace, asked, flier

from recon.guidance.survey import (
    Surveyor,
    SurveyPlan,
    SurveyState,
    create,
    plan_survey,
    start,
    step,
    surroundings_of,
)
from recon.model.airspace import FlightLimits
from recon.model.command import FlyMission, Refusal
from recon.model.vehicle import Failsafe
from recon.safety.datum import takeoff_up_m
from recon.safety.rules.max_height import max_height
from recon.safety.rules.min_height import min_height


def refusals(ground: Ground, height_m: float, *, above_ground: bool = True) -> list[Refusal]:
    """What the height rules say to a mission over all rows, of a vehicle at its beginning.

    It hovers there, took off at the origin and would hover without its link: its paths there and
    home are not the survey's.
    """
    air = airspace(limits=FlightLimits(), elevation=model(ground, frame=FRAME))
    survey = survey_of(rectangle(400.0, 120.0), speed_mps=1.5, height_m=height_m)
    if above_ground:
        survey = replace(survey, height_above_takeoff_m=None, height_above_ground_m=height_m)
    plan = plan_survey(survey, FRAME, surroundings_of(air.airspace))
    assert isinstance(plan, SurveyPlan), plan
    created = create(plan)
    assert isinstance(created, SurveyState)
    begun = start(created, ["S-1"], 0)
    assert isinstance(begun, SurveyState)
    up_m = takeoff_up_m(air, flier())
    state, (given_out,) = step(begun, [Surveyor("S-1", (0.0, 0.0), takeoff_up_m=up_m)], 10**10)
    first_m = given_out.mission.waypoints[0].height_above_takeoff_m
    hovering = flier(*state.flights["S-1"].corners_m[0], first_m, failsafe=Failsafe.HOVER)
    body = FlyMission(given_out.mission)
    found = (asked(rule, body, air, hovering) for rule in (min_height, max_height))
    return [refusal for refusal in found if refusal is not None]


@settings(max_examples=examples(20), deadline=None)
@given(st.integers(0, 10_000), st.floats(0.0, 0.4), st.floats(20.0, 100.0))
def test_the_gate_lets_rows_over_hills_through(seed: int, steepest: float, height_m: float) -> None:
    assert [each.reason for each in refusals(hills(seed, steepest), height_m)] == []


def test_the_gate_lets_a_long_row_up_a_slope_through_that_is_flown_low() -> None:
    """The ground rises by 40 m along each row: by more than the rows' height."""
    assert refusals(slope, 20.0) == []


def test_above_takeoff_the_same_rows_are_refused() -> None:
    (refusal,) = refusals(slope, 20.0, above_ground=False)
    assert refusal.rule == "min_height"
