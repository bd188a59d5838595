"""What holds for every row: the pilot, the ground, an all stop, a restart, a refusal, a fault."""

from dataclasses import replace

import pytest
from tests.fleet.reports import core, extended
from tests.station.commanded import CommandedStation
from tests.station.failsafe.reacting import (
    A,
    alarm_text,
    hovering,
    in_mission,
    own_orders,
    reactions,
    with_cell,
)
from tests.station.failsafe.test_battery_low import drains_to
from tests.station.recovery.restarts import restart_world

from recon.model.command import Hover, ReturnHome
from recon.model.control import AuthorityHolder
from recon.model.event import AllStopped, AuthorityTaken
from recon.model.failsafe_matrix import Activity, FailsafeCondition, Reaction
from recon.safety.failsafe import DEFAULT_MATRIX
from recon.station.failsafe import runner
from recon.station.kernel.failsafe_orders import run_failsafes_isolated

CRITICAL = FailsafeCondition.BATTERY_CRITICAL
EMPTY = 0.095


def test_a_pilots_vehicle_is_alarmed_about_only() -> None:
    w = in_mission()
    w.driver.handle(AuthorityTaken(A, AuthorityHolder.PILOT, "test"))
    drains_to(w, EMPTY)
    w.run_for(30.0)
    assert reactions(w) == []
    assert alarm_text(w, "battery").endswith("land now")


def test_nothing_is_ordered_on_the_ground_or_where_that_is_uncertain() -> None:
    empty = extended(battery=EMPTY)
    ground = CommandedStation(DEFAULT_MATRIX).opens(1, core(flying=False, height_m=0.0), empty)
    ground.keeps_receiving(1, core(flying=False, height_m=0.0), empty).passes(30.0)
    assert ground.handed == []
    unsure = CommandedStation(DEFAULT_MATRIX).opens(1, core(flying=None), empty)
    unsure.keeps_receiving(1, core(flying=None), empty).passes(30.0)
    assert unsure.handed == []


def test_under_an_all_stop_a_person_decides() -> None:
    w = in_mission()
    w.driver.handle(AllStopped("test"))
    w.run_for(8.0)
    drains_to(w, EMPTY)
    w.run_for(10.0)
    assert reactions(w) == []


def test_it_is_given_once_and_a_newer_order_stands() -> None:
    w = hovering()
    drains_to(w, EMPTY)
    w.run_for(2.0)
    w.order(A, Hover())
    w.run_for(10.0)
    assert reactions(w) == [(A, "return_home", "station: battery critical")]


def test_of_two_at_once_the_stronger_is_ordered() -> None:
    empty = replace(extended(battery=EMPTY), wind_level=2)
    matrix = with_cell(CRITICAL, Activity.HOLDING, Reaction.LAND)
    matrix = with_cell(FailsafeCondition.WIND, Activity.HOLDING, Reaction.RETURN, 0.0, matrix)
    scene = CommandedStation(matrix)
    scene.is_stuck = True
    scene.opens(1, core(), empty).keeps_receiving(1, core(), empty).passes(0.3)
    assert [type(body).__name__ for body in scene.bodies()] == ["LandNow"]


def test_each_vehicle_has_its_own() -> None:
    w = hovering(2)
    drains_to(w, EMPTY)
    w.run_for(5.0)
    assert {serial for serial, _, _ in reactions(w)} == {A}


class TestARestart:
    def test_what_was_so_before_is_not_ordered_again(self) -> None:
        w = hovering()
        drains_to(w, EMPTY)
        w.run_for(2.0)
        w.order(A, Hover())
        w.run_for(5.0)
        restart_world(w)
        w.run_for(30.0)
        assert own_orders(w) == []
        assert "so before the restart" in alarm_text(w, "battery")

    def test_what_begins_later_is_ordered(self) -> None:
        w = hovering()
        restart_world(w)
        w.run_for(10.0)
        drains_to(w, EMPTY)
        w.run_for(3.0)
        assert reactions(w) == [(A, "return_home", "station: battery critical")]


def test_a_refused_reaction_is_tried_again_a_few_times() -> None:
    empty = extended(battery=EMPTY)
    scene = CommandedStation(DEFAULT_MATRIX).opens(1, core(), extended())
    scene.keeps_receiving(1, core(), extended()).passes(1.0)
    scene.keeps_receiving(1, core(), empty)
    settings = replace(scene.station.settings.safety, fresh_telemetry_s=-1.0)
    scene.station = replace(
        scene.station, settings=replace(scene.station.settings, safety=settings)
    )
    scene.passes(20.0)
    records = [
        record
        for record in scene.station.orders.records.values()
        if isinstance(record.command.body, ReturnHome)
    ]
    assert len(records) == scene.station.settings.failsafe.tries
    texts = [alarm.condition.text for alarm in scene.station.alarms.alarms.values()]
    assert any("could not be ordered to return (" in text for text in texts)


def test_a_fault_costs_one_vehicle_of_one_run(monkeypatch: pytest.MonkeyPatch) -> None:
    w = hovering(2)
    advance = runner.advance

    def faulty(station, serial, run, now_ns):  # type: ignore[no-untyped-def]
        if serial == A:
            raise RuntimeError("broken")
        return advance(station, serial, run, now_ns)

    monkeypatch.setattr(runner, "advance", faulty)
    now_ns = w.driver.now_ns + 200_000_000
    station, _ = run_failsafes_isolated(w.driver.station, now_ns)
    assert [fault.where for fault in station.faults.values()] == [
        f"reacting to the conditions of {A}"
    ]
    again, outputs = run_failsafes_isolated(station, now_ns)
    assert outputs == ()
    assert again.faults == station.faults
