"""GNSS lost: an alarm, for nothing that can be ordered holds an aircraft without it."""

from tests.station.failsafe.reacting import (
    A,
    alarm_text,
    in_mission,
    now_s,
    reactions,
    with_cell,
)

from recon.model.failsafe_matrix import Activity, FailsafeCondition, Reaction

FAULT = (f"gnss-loss:{A}:40",)


def test_it_is_an_alarm_and_nothing_is_ordered() -> None:
    w = in_mission(faults=FAULT)
    w.run_for(60.0 - now_s(w))
    assert reactions(w) == []
    assert "GNSS lost" in alarm_text(w, "gnss")


def test_a_site_may_have_it_land_after_a_while() -> None:
    lost = FailsafeCondition.GNSS_LOST
    matrix = with_cell(lost, Activity.HOLDING, Reaction.LAND, 10.0)
    matrix = with_cell(lost, Activity.MISSION, Reaction.LAND, 10.0, matrix)
    w = in_mission(faults=FAULT, matrix=matrix)
    w.run_for(49.5 - now_s(w))
    assert reactions(w) == []
    assert "the station lands it in " in alarm_text(w, "gnss")
    w.run_for(2.5)
    assert reactions(w) == [(A, "land", "station: GNSS lost")]
