"""A planner that raises: a failure costs a step, many in a row pause the survey and hold."""

import pickle
from dataclasses import replace
from types import MappingProxyType

import pytest
from tests.station.surveyed_world import SurveyedWorld, asked, surveyed_world

from recon.guidance.survey import Surveyor, life
from recon.model.command import Hover
from recon.model.control import AuthorityHolder
from recon.model.survey import SurveyPhase
from recon.station.kernel.method_process import packed
from recon.station.operations.survey.execution import FAILED_STEPS_MOST, STEP_SURVEY
from recon.station.operations.survey.planning import StepSurvey, SurveyStepped, step_survey


def flying() -> SurveyedWorld:
    world = surveyed_world(1)
    world.asks(asked(name="wheat"))
    world.starts("SIM-1")
    world.runs(6.0)
    assert world.missions("SIM-1")
    return world


def test_a_planner_that_keeps_failing_pauses_its_survey_and_holds() -> None:
    world = flying()

    def fails(_work: StepSurvey) -> SurveyStepped:
        raise KeyError("no row")

    assert world.driver.jobs is not None
    world.driver.jobs.replace(STEP_SURVEY, fails)
    assert world.runs_until(SurveyPhase.PAUSED, FAILED_STEPS_MOST + 5.0)
    planner = world.record().survey.planner
    reason = f"its planner {planner} failed {FAILED_STEPS_MOST} times in a row: KeyError: 'no row'"
    assert world.state().reason == reason
    assert world.holder("SIM-1") is not AuthorityHolder.GUIDANCE
    world.runs(1.0)
    bodies = [each.command.body for each in world.driver.station.orders.records.values()]
    assert any(isinstance(body, Hover) for body in bodies)
    alarms = [each.condition.text for each in world.driver.station.alarms.alarms.values()]
    assert any(f"survey wheat has paused automatically: {reason}" in text for text in alarms)

    # It goes on when the planner is whole again.
    world.driver.jobs.replace(STEP_SURVEY, step_survey)
    world.starts("SIM-1")
    world.runs(3.0)
    assert world.phase() is SurveyPhase.RUNNING
    assert world.record().trouble is None


def test_single_failures_cost_a_step_each() -> None:
    world, calls = flying(), []

    def fails_often(work: StepSurvey) -> SurveyStepped:
        calls.append(work)
        if len(calls) % FAILED_STEPS_MOST:
            raise ValueError("late")
        return step_survey(work)

    assert world.driver.jobs is not None
    world.driver.jobs.replace(STEP_SURVEY, fails_often)
    world.runs(2.5 * FAILED_STEPS_MOST)
    assert len(calls) > 2 * FAILED_STEPS_MOST
    assert world.phase() is SurveyPhase.RUNNING


def test_a_result_of_another_kind_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A package's planner may return anything."""
    work = work_of(flying())
    planner = work.state.plan.survey.planner
    monkeypatch.setattr(life, "PLANNERS", {planner: lambda *_: (None, ())})
    with pytest.raises(ValueError, match="expected a SurveyState of the planner, got None"):
        step_survey(work)


def test_a_step_in_another_process_is_the_same() -> None:
    work = work_of(flying())
    there = pickle.loads(packed(step_survey(pickle.loads(packed(work)))))
    here = step_survey(work)
    assert there.missions == here.missions
    assert there.returning == here.returning
    assert there.state.phase is here.state.phase
    assert (there.state.progress.state == here.state.progress.state).all()


def work_of(world: SurveyedWorld) -> StepSurvey:
    """A step in which the vehicle has just come to the survey, so that it gets a mission."""
    state = replace(world.state(), flights=MappingProxyType({}))
    surveyor = Surveyor("SIM-1", (0.0, -40.0), ended_mission=9)
    return StepSurvey(state, (), (), (surveyor,), world.driver.now_ns)
