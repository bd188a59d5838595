"""Operator gone: only after one was there for a while; a mission is held after a minute."""

import pytest
from tests.station.failsafe.reacting import (
    OWNER,
    STEERED_ORDER,
    A,
    alarm_text,
    holds,
    in_mission,
    issued_s,
    now_s,
    own_orders,
    reactions,
    steered,
    with_cell,
)
from tests.station.station_world import World

from recon.model.command import Hover, Phase
from recon.model.event import OwnerConnected, OwnerDisconnected
from recon.model.failsafe_matrix import Activity, FailsafeCondition, Reaction

GONE = FailsafeCondition.OPERATOR_GONE


def is_watched_for(w: World, seconds: float) -> float:
    """A client connects for a while; return when it has gone."""
    w.driver.handle(OwnerConnected(OWNER))
    w.run_for(seconds)
    w.driver.handle(OwnerDisconnected(OWNER))
    return now_s(w)


def test_a_mission_is_an_alarm_after_10_s_and_held_after_60_s() -> None:
    w = in_mission()
    gone_s = is_watched_for(w, 31.0)
    w.run_for(9.5)
    assert alarm_text(w, "operator_gone") == ""
    w.run_for(1.0)
    text = alarm_text(w, "operator_gone")
    assert "no operator connected for 10 s" in text
    assert f"{A}: the station holds it in 50 s unless an operator connects" in text
    w.run_for(48.0)
    assert reactions(w) == []
    w.run_for(8.0)
    assert reactions(w) == [(A, "hover", "station: operator gone")]
    assert issued_s(w) - gone_s == pytest.approx(60.0, abs=0.3)
    assert holds(w)
    assert "was ordered to hold" in alarm_text(w, "operator_gone")


def test_a_page_opened_again_in_time_changes_nothing() -> None:
    w = in_mission()
    is_watched_for(w, 31.0)
    w.run_for(50.0)
    w.driver.handle(OwnerConnected("another"))
    w.run_for(40.0)
    assert own_orders(w) == []
    assert alarm_text(w, "operator_gone") == ""


def test_a_station_that_nobody_watched_or_for_a_moment_only_reacts_to_nothing() -> None:
    for seconds in (0.0, 20.0):
        w = in_mission()
        if seconds:
            is_watched_for(w, seconds)
        w.run_for(80.0)
        assert own_orders(w) == []
        assert alarm_text(w, "operator_gone") == ""


def test_a_steered_vehicle_is_held_at_once_by_its_stream() -> None:
    w = steered()
    w.driver.handle(OwnerDisconnected(OWNER))
    w.run_for(1.0)
    assert w.record(STEERED_ORDER).phase is Phase.FAILED
    hovers = [
        record.command.issued_by
        for record in w.driver.station.orders.records.values()
        if isinstance(record.command.body, Hover)
    ]
    assert hovers == ["station: end of a stream of sticks"]
    w.run_for(4.0)
    assert holds(w)


def test_a_site_may_call_it_home_or_do_nothing() -> None:
    home = [(A, "return_home", "station: operator gone")]
    for reaction, after_s, expected in ((Reaction.RETURN, 30.0, home), (Reaction.NOTHING, 0.0, [])):
        w = in_mission(matrix=with_cell(GONE, Activity.MISSION, reaction, after_s))
        is_watched_for(w, 31.0)
        w.run_for(31.0)
        assert reactions(w) == expected
        assert (alarm_text(w, "operator_gone") == "") is (reaction is Reaction.NOTHING)
