"""Telemetry lost or frozen, the link open: held after 3 s in a mission, and when steered."""

import pytest
from tests.station.failsafe.reacting import (
    A,
    alarm_text,
    fly,
    holds,
    in_mission,
    now_s,
    own_orders,
    reactions,
    steered,
    with_cell,
)

from recon.model.command import Hover, Phase
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken
from recon.model.failsafe_matrix import Activity, FailsafeCondition, Reaction

HELD = [(A, "hover", "station: telemetry lost")]
LOST = FailsafeCondition.TELEMETRY_LOST


class TestInAMission:
    @pytest.mark.parametrize("fault", ["telemetry-dropout", "frozen-telemetry"])
    def test_it_is_held_3_s_after_the_last_new_value(self, fault: str) -> None:
        w = in_mission(faults=(f"{fault}:{A}:40:20",))
        w.run_for(40.0 - now_s(w))
        assert reactions(w) == []
        assert w.run_until(lambda: own_orders(w) != [], 6.0)
        # The last value may be 0.1 s old, and a frozen one shows after a second.
        assert 42.9 <= now_s(w) <= 43.3
        w.run_for(6.0)
        assert reactions(w) == HELD
        assert holds(w), "a blind stop, while no landing was possible"
        w.run_for(15.0)
        assert own_orders(w)[0].phase is Phase.DONE

    def test_a_gap_of_a_video_stream_holds_nothing(self) -> None:
        w = in_mission(faults=(f"telemetry-dropout:{A}:40:2.5",))
        w.run_for(50.0 - now_s(w))
        assert reactions(w) == []

    def test_the_alarm_counts_down_and_then_states_what_was_done(self) -> None:
        w = in_mission(faults=(f"telemetry-dropout:{A}:40:20",))
        w.run_for(41.3 - now_s(w))
        assert "the station holds it in 2 s unless telemetry returns" in alarm_text(w, "link_late")
        w.run_for(2.5)
        assert "was ordered to hold" in alarm_text(w, "link_lost")

    def test_a_site_may_have_the_alarm_alone_or_another_delay(self) -> None:
        for matrix, count in (
            (with_cell(LOST, Activity.MISSION, Reaction.ALARM), 0),
            (with_cell(LOST, Activity.MISSION, Reaction.HOLD, 8.0), 0),
            (with_cell(LOST, Activity.MISSION, Reaction.HOLD, 4.0), 1),
        ):
            w = in_mission(faults=(f"telemetry-dropout:{A}:40:6",), matrix=matrix)
            w.run_for(47.0 - now_s(w))
            assert len(own_orders(w)) == count

    def test_a_pilots_vehicle_is_alarmed_about_only(self) -> None:
        w = in_mission(faults=(f"telemetry-dropout:{A}:40:20",))
        w.driver.handle(AuthorityTaken(A, AuthorityHolder.PILOT, "test"))
        w.run_for(50.0 - now_s(w))
        assert reactions(w) == []
        assert "the station holds it" not in alarm_text(w, "link_lost")


class TestAnOperatorsNewerOrder:
    def test_a_stop_that_waits_already_is_not_doubled(self) -> None:
        w = in_mission(faults=(f"telemetry-dropout:{A}:40:20",))
        w.run_for(42.0 - now_s(w))
        w.order(A, Hover())
        w.run_for(6.0)
        assert reactions(w) == []

    def test_a_mission_ordered_after_the_hold_is_flown(self) -> None:
        w = in_mission(faults=(f"telemetry-dropout:{A}:40:5",))
        w.run_for(46.0 - now_s(w))
        assert reactions(w) == HELD
        order = fly(w)
        w.run_for(10.0)
        assert reactions(w) == HELD
        assert w.record(order).phase is Phase.STARTED


def test_a_steered_vehicle_is_held_by_its_stream_once() -> None:
    w = steered(faults=(f"telemetry-dropout:{A}:12:20",))
    w.run_for(20.0 - now_s(w))
    orders = w.driver.station.orders.records.values()
    hovers = [r for r in orders if isinstance(r.command.body, Hover)]
    assert [r.command.issued_by for r in hovers] == ["station: end of a stream of sticks"]
    assert holds(w)


def test_one_that_holds_already_is_an_alarm() -> None:
    w = in_mission(faults=(f"telemetry-dropout:{A}:60:10",))
    w.order(A, Hover())
    w.run_for(66.0 - now_s(w))
    assert reactions(w) == []
    assert alarm_text(w, "link_lost") != ""
