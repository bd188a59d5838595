"""Emergency orders: repeated, superseded, confirmed, or an alarm that stays (decisions 14-16)."""

import pytest
from tests.fleet.said import core, extended
from tests.safety.cases import STICK, mission
from tests.station.commanded import Told, flying

from recon.model.command import Body, Hover, LandNow, Phase, ReturnHome, StartCamera
from recon.model.vehicle import FlightMode

DEAF = 20.0
STANDING = (core(), extended(mode=FlightMode.GPS_ATTI))
LANDING = (core(velocity=(0.0, 0.0, 1.0)), extended(mode=FlightMode.AUTO_LANDING))
GROUND = (core(flying=False), extended(mode=FlightMode.GPS_ATTI))


class TestRepeats:
    @pytest.mark.parametrize("body", [Hover(), LandNow(), ReturnHome()])
    def test_every_0_7_s_three_at_most(self, body: Body) -> None:
        told = flying()
        order = told.order(body)
        told.passes(DEAF)
        assert told.times_s(order) == pytest.approx([0.5, 1.2, 1.9, 2.6])

    @pytest.mark.parametrize("newer", [Hover(), LandNow(), mission(), STICK])
    def test_they_end_on_a_newer_order_to_move(self, newer: Body) -> None:
        told = flying()
        order = told.order(Hover())
        told.passes(1.0).order(newer)
        told.passes(DEAF)
        assert len(told.times_s(order)) == 2
        assert told.phase(order) is Phase.SUPERSEDED

    def test_a_camera_order_does_not_end_the_repeats_of_a_stop(self) -> None:
        told = flying()
        order = told.order(Hover())
        told.order(StartCamera(1.0))
        told.passes(DEAF)
        assert len(told.times_s(order)) == 4

    def test_an_order_the_gate_refuses_ends_nothing(self) -> None:
        told = flying()
        order = told.order(Hover())
        refused = told.order(mission(*mission().mission.waypoints[:1]))
        told.passes(DEAF)
        assert told.phase(refused) is Phase.REFUSED_BY_STATION
        assert len(told.times_s(order)) == 4

    def test_they_end_on_pilot_takeover_and_no_alarm_follows(self) -> None:
        told = flying()
        order = told.order(Hover())
        moving = core(velocity=(9.0, 0.0, 0.0))
        told.keeps_saying(1, moving, extended(mode=FlightMode.GPS_SPORT)).passes(DEAF)
        assert len(told.times_s(order)) == 1
        assert told.phase(order) is Phase.SUPERSEDED
        assert "order_not_confirmed" not in told.alarms()

    def test_they_end_on_confirmation(self) -> None:
        told = flying()
        order = told.order(Hover())
        told.keeps_saying(1, *STANDING).passes(DEAF)
        assert len(told.times_s(order)) == 1
        assert told.phases(order) == [
            Phase.QUEUED,
            Phase.SENT,
            Phase.CONFIRMED,
            Phase.DONE,
        ]

    def test_an_acknowledgment_ends_nothing(self) -> None:
        told = flying()
        order = told.order(Hover())
        told.answered(order, True).passes(DEAF)
        assert len(told.times_s(order)) == 4
        assert told.phase(order) is Phase.TIMED_OUT

    def test_an_order_to_take_off_is_never_repeated_on_the_ground(self) -> None:
        told = Told().opens(1, *GROUND).keeps_saying(1, *GROUND).passes(0.5)
        order = told.order(Hover(), takeoff=True)
        told.passes(DEAF)
        assert len(told.times_s(order)) == 1
        assert "order_not_confirmed" in told.alarms()

    @pytest.mark.parametrize("body", [Hover(), ReturnHome()])
    def test_hover_and_return_are_not_repeated_when_telemetry_says_landed(self, body: Body) -> None:
        told = flying()
        order = told.order(body)
        told.keeps_saying(1, core(flying=False), extended(mode=None)).passes(DEAF)
        assert len(told.times_s(order)) == 1

    @pytest.mark.parametrize("body", [Hover(), ReturnHome()])
    def test_hover_and_return_are_not_repeated_on_stale_telemetry(self, body: Body) -> None:
        told = flying()
        told.talk.clear()
        told.passes(2.9)
        order = told.order(body)
        told.passes(DEAF)
        assert len(told.times_s(order)) == 1

    def test_land_is_repeated_whatever_telemetry_says(self) -> None:
        told = flying()
        told.talk.clear()
        told.passes(30.0)
        order = told.order(LandNow())
        told.passes(DEAF)
        assert len(told.times_s(order)) == 4

    def test_a_repeat_goes_to_the_link_the_vehicle_has_come_back_on(self) -> None:
        told = flying()
        order = told.order(Hover())
        told.closes(1).passes(0.3)
        reports = (core(velocity=(5.0, 0.0, 0.0)), extended(mode=FlightMode.GPS_WAYPOINT))
        told.opens(2, *reports).keeps_saying(2, *reports).passes(1.0)
        assert [(link, number) for _, link, number in told.sent] == [(1, order), (2, order)]


class TestUnconfirmed:
    def test_an_alarm_follows_the_last_repeat_and_stays(self) -> None:
        told = flying()
        order = told.order(LandNow())
        told.passes(3.4)
        assert "order_not_confirmed" not in told.alarms()
        told.passes(0.2)
        assert "order_not_confirmed" in told.alarms()
        told.passes(600.0)
        assert "order_not_confirmed" in told.alarms()
        assert told.phase(order) is Phase.TIMED_OUT

    def test_a_hover_that_has_begun_gets_time_to_brake(self) -> None:
        told = flying()
        order = told.order(Hover())
        braking = (core(velocity=(3.0, 0.0, 0.0)), extended(mode=FlightMode.GPS_ATTI))
        told.keeps_saying(1, *braking).passes(9.8)
        assert "order_not_confirmed" not in told.alarms()
        told.passes(0.4)
        assert "order_not_confirmed" in told.alarms()
        told.keeps_saying(1, *STANDING).passes(0.2)
        assert "order_not_confirmed" not in told.alarms()
        assert told.phase(order) is Phase.TIMED_OUT
        assert told.record(order).note == "by telemetry: it stands, after its time"

    def test_it_ends_when_confirmed_late(self) -> None:
        told = flying()
        told.order(LandNow())
        told.passes(10.0).keeps_saying(1, *LANDING).passes(0.2)
        assert "order_not_confirmed" not in told.alarms()
        assert "order_not_confirmed" in told.alarms(active=False)

    def test_it_ends_when_replaced(self) -> None:
        told = flying()
        told.order(LandNow())
        told.passes(10.0).order(Hover())
        told.passes(0.1)
        assert "order_not_confirmed" not in told.alarms()

    def test_a_refusal_by_the_app_is_an_alarm_at_once_and_repeats_go_on(self) -> None:
        told = flying()
        order = told.order(Hover())
        told.answered(order, False).passes(0.1)
        assert "order_not_confirmed" in told.alarms()
        told.passes(5.0)
        assert len(told.times_s(order)) == 4

    def test_an_emergency_order_that_never_left_is_an_alarm(self) -> None:
        told = flying()
        told.is_stuck = True
        order = told.order(Hover())
        told.passes(5.2)
        assert told.phase(order) is Phase.EXPIRED
        assert "order_not_confirmed" in told.alarms()

    def test_so_is_one_whose_link_closed_before_it_left(self) -> None:
        told = flying()
        told.is_stuck = True
        order = told.order(LandNow())
        told.dropped(order, Phase.FAILED).closes(1).passes(0.1)
        assert told.phase(order) is Phase.FAILED
        assert "order_not_confirmed" in told.alarms()

    def test_one_stuck_in_a_queue_is_judged_anew_until_it_expires(self) -> None:
        told = flying()
        told.is_stuck = True
        order = told.order(Hover())
        told.passes(3.4)
        assert len(told.handed) == 5
        assert told.record(order).repeats_left == 3
        told.is_stuck = False
        told.passes(DEAF)
        assert told.times_s(order) == pytest.approx([4.0, 4.7, 5.4])  # expired at 5.5 s

    def test_one_sent_before_its_link_closed_stays_open_for_a_confirmation(self) -> None:
        told = flying()
        order = told.order(LandNow())
        told.closes(1).passes(DEAF)
        assert told.phase(order) is Phase.TIMED_OUT
        assert "order_not_confirmed" in told.alarms()
        told.opens(2, *LANDING)
        assert told.record(order).note == "by telemetry: it is landing, after its time"
        assert "order_not_confirmed" not in told.passes(0.1).alarms()


class TestLanding:
    def test_land_is_confirmed_by_mode_9_or_21_then_on_ground(self) -> None:
        told = flying()
        order = told.order(LandNow())
        told.keeps_saying(1, *LANDING).passes(40.0)
        assert told.phases(order) == [Phase.QUEUED, Phase.SENT, Phase.CONFIRMED]
        assert not told.phase(order).is_final
        assert len(told.times_s(order)) == 1
        told.keeps_saying(1, *GROUND).passes(0.1)
        assert told.phase(order) is Phase.DONE

    def test_a_landing_that_stops_in_the_air_is_an_alarm(self) -> None:
        told = flying()
        told.order(LandNow())
        told.keeps_saying(1, *LANDING).passes(5.0).keeps_saying(1, *STANDING).passes(0.9)
        assert "landing_stopped" not in told.alarms()
        told.passes(0.3)
        assert "landing_stopped" in told.alarms()
        told.order(LandNow())
        told.keeps_saying(1, *GROUND).passes(0.2)
        assert "landing_stopped" not in told.alarms()

    def test_mode_21_and_still_flying_for_long_is_an_alarm(self) -> None:
        told = flying()
        told.keeps_saying(1, core(), extended(mode=FlightMode.CONFIRM_LANDING)).passes(8.0)
        assert "landing_waits" not in told.alarms()
        told.passes(0.2)
        assert "landing_waits" in told.alarms()
        told.keeps_saying(1, *GROUND).passes(0.1)
        assert "landing_waits" not in told.alarms()


class TestTakeoffByHover:
    def test_it_is_refused_without_the_word_and_sent_with_it(self) -> None:
        told = Told().opens(1, *GROUND).keeps_saying(1, *GROUND)
        assert told.phase(told.order(Hover())) is Phase.REFUSED_BY_STATION
        assert told.sent == []
        order = told.order(Hover(), takeoff=True)
        told.passes(1.0)
        assert told.phase(order) is Phase.SENT
        told.keeps_saying(1, *STANDING).passes(0.1)
        assert told.phase(order) is Phase.DONE


class TestSeveralLinks:
    def conflict(self) -> Told:
        told = flying()
        told.opens(2, *told.talk[1]).keeps_saying(2, *told.talk[1])
        return told.passes(0.5)

    def test_a_stop_goes_to_every_link_that_claims_the_serial(self) -> None:
        told = self.conflict()
        assert told.station.fleet.vehicles["A"].in_conflict
        told.order(Hover())
        assert {link for _, link, _ in told.sent} == {1, 2}
        assert "serial_conflict" in told.alarms()

    def test_it_is_confirmed_only_when_both_have_stopped(self) -> None:
        told = self.conflict()
        order = told.order(Hover())
        told.keeps_saying(1, *STANDING).passes(0.5)
        assert told.phase(order) is Phase.SENT
        told.keeps_saying(2, *STANDING).passes(0.2)
        assert told.phase(order) is Phase.DONE

    def test_dropped_by_one_link_it_lives_on_at_the_other(self) -> None:
        told = self.conflict()
        told.is_stuck = True
        order = told.order(LandNow())
        told.dropped(order, Phase.FAILED, link_id=1)
        assert told.phase(order) is Phase.QUEUED
        told.dropped(order, Phase.FAILED, link_id=2)
        assert told.phase(order) is Phase.FAILED


class TestUnidentified:
    def nameless(self) -> Told:
        reports = (core(velocity=(5.0, 0.0, 0.0)), extended(None, mode=FlightMode.GPS_WAYPOINT))
        return Told().opens(1, *reports).keeps_saying(1, *reports).passes(0.2)

    def test_a_link_without_identity_can_be_held(self) -> None:
        told = self.nameless()
        order = told.order(Hover(), None, link=1)
        assert told.times_s(order) == [0.2]
        told.keeps_saying(1, core(), extended(None)).passes(0.2)
        assert told.phase(order) is Phase.DONE

    def test_the_order_follows_the_link_when_it_says_its_serial(self) -> None:
        told = self.nameless()
        order = told.order(Hover(), None, link=1)
        told.keeps_saying(1, core(velocity=(5.0, 0.0, 0.0)), extended("A")).passes(1.0)
        assert len(told.times_s(order)) == 2
        told.keeps_saying(1, core(), extended("A")).passes(0.2)
        assert told.phase(order) is Phase.DONE

    def test_an_order_by_serial_supersedes_the_one_by_link(self) -> None:
        told = self.nameless()
        order = told.order(Hover(), None, link=1)
        told.says(1, extended("A"))
        told.order(LandNow())
        assert told.phase(order) is Phase.SUPERSEDED

    def test_when_its_link_closes_the_order_has_ended(self) -> None:
        told = self.nameless()
        order = told.order(Hover(), None, link=1)
        told.closes(1).passes(0.1)
        assert told.phase(order) is Phase.FAILED
        assert not told.record(order).is_watched
