"""The scripted operator's decisions, without a station."""

from dataclasses import replace

import pytest

from recon.score.scripted_operator import (
    AbortSurvey,
    CallFleetHome,
    CallHome,
    DismissHazard,
    DroneView,
    FieldView,
    OperatorAction,
    RequestPlan,
    ScriptedOperator,
    StartDrones,
    SurveyStage,
    TakeAuthority,
)

SERIALS = ("SIM-1", "SIM-2")
READY = DroneView("SIM-1", is_ready=True, is_live=True, is_flying=False, battery_fraction=1.0)
FLYING = replace(READY, is_flying=True, battery_fraction=0.6)
OTHER = replace(FLYING, serial="SIM-2")


def actions(
    operator: ScriptedOperator, view: FieldView, seconds: int
) -> list[tuple[int, OperatorAction]]:
    """Ask once a second from 0 on; return (second, action)."""
    return [(s, action) for s in range(seconds) for action in operator.decide(view, float(s))]


def flying_view(drone: DroneView) -> FieldView:
    return FieldView([drone, OTHER], SurveyStage.FLYING)


def test_a_survey_is_requested_when_all_drones_have_been_ready_for_3_s() -> None:
    both = FieldView([READY, replace(READY, serial="SIM-2")])
    assert actions(ScriptedOperator(SERIALS, 0.5), both, 5) == [(3, RequestPlan())]
    for other in ([], [replace(READY, serial="SIM-2", is_ready=False)]):
        assert actions(ScriptedOperator(SERIALS, 0.5), FieldView([READY, *other]), 30) == []


def test_a_planned_survey_is_started_once_with_all_drones() -> None:
    view = FieldView([READY, replace(READY, serial="SIM-2")], SurveyStage.PLANNED)
    assert actions(ScriptedOperator(SERIALS, 0.5), view, 5) == [(0, StartDrones(SERIALS))]


@pytest.mark.parametrize(
    "drone",
    [
        replace(READY, is_called_home=True),
        replace(READY, is_called_home=True, battery_fraction=0.5),
        replace(READY, is_stopped=True),
        replace(FLYING, is_stopped=True),
    ],
)
def test_a_drone_without_a_task_is_started_after_20_s(drone: DroneView) -> None:
    found = actions(ScriptedOperator(SERIALS, 0.5), flying_view(drone), 25)
    assert found == [(20, StartDrones(("SIM-1",)))]


@pytest.mark.parametrize(
    "drone",
    [
        FLYING,
        replace(READY, is_called_home=True, battery_fraction=0.49),
        replace(READY, is_called_home=True, battery_fraction=None),
        replace(READY, is_called_home=True, is_live=False),
        replace(FLYING, is_stopped=True, is_called_home=True),
        replace(FLYING, is_stopped=True, is_descending=True),
    ],
)
def test_a_busy_discharged_lost_or_returning_drone_is_left_alone(drone: DroneView) -> None:
    assert actions(ScriptedOperator(SERIALS, 0.5), flying_view(drone), 60) == []


def test_a_drone_lost_in_the_air_is_found_after_90_s() -> None:
    lost = replace(FLYING, is_live=False)
    assert actions(ScriptedOperator(SERIALS, 0.5), flying_view(lost), 100) == [
        (90, DismissHazard("SIM-1"))
    ]
    landed = replace(READY, is_live=False)
    assert actions(ScriptedOperator(SERIALS, 0.5), flying_view(landed), 100) == []


def test_authority_is_taken_back_from_a_pilot_first() -> None:
    drone = replace(FLYING, is_stopped=True, is_under_pilot=True)
    found = actions(ScriptedOperator(SERIALS, 0.5), flying_view(drone), 21)
    assert found == [(20, TakeAuthority("SIM-1")), (20, StartDrones(("SIM-1",)))]


def test_a_low_battery_alarm_is_answered_by_return_to_home_and_again() -> None:
    view = flying_view(replace(FLYING, has_battery_alarm=True))
    found = actions(ScriptedOperator(SERIALS, 0.5), view, 45)
    assert found == [(20, CallHome("SIM-1")), (41, CallHome("SIM-1"))]
    for change in ({"is_descending": True}, {"is_flying_home": True}):
        returning = flying_view(replace(FLYING, has_battery_alarm=True, **change))
        assert actions(ScriptedOperator(SERIALS, 0.5), returning, 60) == []


def test_a_condition_that_lapses_starts_its_time_again() -> None:
    operator, stopped = (
        ScriptedOperator(SERIALS, 0.5),
        flying_view(replace(FLYING, is_stopped=True)),
    )
    assert actions(operator, stopped, 19) == []
    assert list(operator.decide(flying_view(FLYING), 19.0)) == []
    assert list(operator.decide(stopped, 20.0)) == []


def test_at_the_limit_the_survey_is_aborted_and_all_return() -> None:
    operator = ScriptedOperator(SERIALS, 0.5, limit_s=10.0)
    assert actions(operator, flying_view(FLYING), 12) == [(10, AbortSurvey()), (11, AbortSurvey())]
    over = FieldView([FLYING, replace(OTHER, is_descending=True)], SurveyStage.FINISHED)
    assert list(operator.decide(over, 12.0)) == [CallFleetHome(("SIM-1",))]
    returning = replace(over, vehicles=[replace(FLYING, is_in_fleet_return=True)])
    assert [list(operator.decide(returning, 13.0 + s)) for s in range(30)] == [[]] * 30
    # It was stopped on its way; of two, one is called after the other.
    found = actions(operator, over, 70)
    assert found == [(30, CallHome("SIM-1")), (51, CallHome("SIM-1"))]
    both = replace(over, vehicles=[FLYING, OTHER])
    assert list(operator.decide(both, 100.0)) == [CallHome("SIM-1")]


def test_the_next_survey_follows_only_where_surveys_repeat() -> None:
    over = FieldView([READY, replace(READY, serial="SIM-2")], SurveyStage.FINISHED)
    assert actions(ScriptedOperator(SERIALS, 0.5), over, 60) == []
    repeating = ScriptedOperator(SERIALS, 0.5, repeats=True)
    assert actions(repeating, over, 21) == [(20, RequestPlan())]
    planned = replace(over, stage=SurveyStage.PLANNED)
    assert list(repeating.decide(planned, 22.0)) == [StartDrones(SERIALS)]
