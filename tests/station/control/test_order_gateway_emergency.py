"""Emergency orders: repeated, superseded, confirmed, or an alarm that stays (decisions 14-16)."""

import pytest
from tests.fleet.reports import core, extended
from tests.safety.cases import STICK, mission
from tests.station.commanded import CommandedStation, flying

from recon.model.command import Body, Hover, LandNow, Phase, ReturnHome, StartCamera
from recon.model.vehicle import FlightMode

DEAF = 20.0
STANDING = (core(), extended(mode=FlightMode.GPS_ATTI))
LANDING = (core(velocity=(0.0, 0.0, 1.0)), extended(mode=FlightMode.AUTO_LANDING))
GROUND = (core(flying=False, height_m=0.0), extended(mode=FlightMode.GPS_ATTI))


class TestRepeats:
    @pytest.mark.parametrize("body", [Hover(), LandNow(), ReturnHome()])
    def test_every_0_7_s_three_at_most(self, body: Body) -> None:
        scene = flying()
        order = scene.order(body)
        scene.passes(DEAF)
        assert scene.times_s(order) == pytest.approx([0.5, 1.2, 1.9, 2.6])

    @pytest.mark.parametrize("newer", [Hover(), LandNow(), mission(), STICK])
    def test_they_end_on_a_newer_order_to_move(self, newer: Body) -> None:
        scene = flying()
        order = scene.order(Hover())
        scene.passes(1.0).order(newer)
        scene.passes(DEAF)
        assert len(scene.times_s(order)) == 2
        assert scene.phase(order) is Phase.SUPERSEDED

    def test_a_camera_order_does_not_end_the_repeats_of_a_stop(self) -> None:
        scene = flying()
        order = scene.order(Hover())
        scene.order(StartCamera(1.0))
        scene.passes(DEAF)
        assert len(scene.times_s(order)) == 4

    def test_an_order_the_gate_refuses_ends_nothing(self) -> None:
        scene = flying()
        order = scene.order(Hover())
        refused = scene.order(mission(*mission().mission.waypoints[:1]))
        scene.passes(DEAF)
        assert scene.phase(refused) is Phase.REFUSED_BY_STATION
        assert len(scene.times_s(order)) == 4

    def test_they_end_on_pilot_takeover_and_no_alarm_follows(self) -> None:
        scene = flying()
        order = scene.order(Hover())
        moving = core(velocity=(9.0, 0.0, 0.0))
        scene.keeps_receiving(1, moving, extended(mode=FlightMode.GPS_SPORT)).passes(DEAF)
        assert len(scene.times_s(order)) == 1
        assert scene.phase(order) is Phase.SUPERSEDED
        assert "order_not_confirmed" not in scene.alarms()

    def test_they_end_on_confirmation(self) -> None:
        scene = flying()
        order = scene.order(Hover())
        scene.keeps_receiving(1, *STANDING).passes(DEAF)
        assert len(scene.times_s(order)) == 1
        assert scene.phases(order) == [
            Phase.QUEUED,
            Phase.SENT,
            Phase.CONFIRMED,
            Phase.DONE,
        ]

    def test_an_acknowledgment_ends_nothing(self) -> None:
        scene = flying()
        order = scene.order(Hover())
        scene.answered(order, True).passes(DEAF)
        assert len(scene.times_s(order)) == 4
        assert scene.phase(order) is Phase.TIMED_OUT

    def test_an_order_to_take_off_is_never_repeated_on_the_ground(self) -> None:
        scene = CommandedStation().opens(1, *GROUND).keeps_receiving(1, *GROUND).passes(0.5)
        order = scene.order(Hover(), takeoff=True)
        scene.passes(DEAF)
        assert len(scene.times_s(order)) == 1
        assert "order_not_confirmed" in scene.alarms()

    @pytest.mark.parametrize("body", [Hover(), ReturnHome()])
    def test_hover_and_return_are_not_repeated_when_telemetry_shows_landed(
        self, body: Body
    ) -> None:
        scene = flying()
        for height_m in range(40, 1, -1):
            sinking = core(height_m=height_m, velocity=(0.0, 0.0, 10.0))
            scene.keeps_receiving(1, sinking, extended(mode=FlightMode.AUTO_LANDING)).passes(0.1)
        order = scene.order(body)
        scene.keeps_receiving(1, *GROUND).passes(DEAF)
        assert len(scene.times_s(order)) == 1

    @pytest.mark.parametrize("body", [Hover(), ReturnHome()])
    def test_hover_and_return_are_not_repeated_on_stale_telemetry(self, body: Body) -> None:
        scene = flying()
        scene.talk.clear()
        scene.passes(2.9)
        order = scene.order(body)
        scene.passes(DEAF)
        assert len(scene.times_s(order)) == 1

    def test_land_is_repeated_whatever_telemetry_shows(self) -> None:
        scene = flying()
        scene.talk.clear()
        scene.passes(30.0)
        order = scene.order(LandNow())
        scene.passes(DEAF)
        assert len(scene.times_s(order)) == 4

    def test_a_repeat_goes_to_the_link_the_vehicle_has_come_back_on(self) -> None:
        scene = flying()
        order = scene.order(Hover())
        scene.closes(1).passes(0.3)
        reports = (core(velocity=(5.0, 0.0, 0.0)), extended(mode=FlightMode.GPS_WAYPOINT))
        scene.opens(2, *reports).keeps_receiving(2, *reports).passes(1.0)
        assert [(link, number) for _, link, number in scene.sent] == [(1, order), (2, order)]


class TestUnconfirmed:
    def test_an_alarm_follows_the_last_repeat_and_stays(self) -> None:
        scene = flying()
        order = scene.order(LandNow())
        scene.passes(3.4)
        assert "order_not_confirmed" not in scene.alarms()
        scene.passes(0.2)
        assert "order_not_confirmed" in scene.alarms()
        scene.passes(600.0)
        assert "order_not_confirmed" in scene.alarms()
        assert scene.phase(order) is Phase.TIMED_OUT

    def test_a_hover_that_has_begun_gets_time_to_brake(self) -> None:
        scene = flying()
        order = scene.order(Hover())
        braking = (core(velocity=(3.0, 0.0, 0.0)), extended(mode=FlightMode.GPS_ATTI))
        scene.keeps_receiving(1, *braking).passes(9.8)
        assert "order_not_confirmed" not in scene.alarms()
        scene.passes(0.4)
        assert "order_not_confirmed" in scene.alarms()
        scene.keeps_receiving(1, *STANDING).passes(0.2)
        assert "order_not_confirmed" not in scene.alarms()
        assert scene.phase(order) is Phase.TIMED_OUT
        assert scene.record(order).note == "telemetry shows it hovering, after its time"

    def test_it_ends_when_confirmed_late(self) -> None:
        scene = flying()
        scene.order(LandNow())
        scene.passes(10.0).keeps_receiving(1, *LANDING).passes(0.2)
        assert "order_not_confirmed" not in scene.alarms()
        assert "order_not_confirmed" in scene.alarms(active=False)

    def test_it_ends_when_replaced(self) -> None:
        scene = flying()
        scene.order(LandNow())
        scene.passes(10.0).order(Hover())
        scene.passes(0.1)
        assert "order_not_confirmed" not in scene.alarms()

    def test_a_refusal_by_the_app_is_an_alarm_at_once_and_repeats_go_on(self) -> None:
        scene = flying()
        order = scene.order(Hover())
        scene.answered(order, False).passes(0.1)
        assert "order_not_confirmed" in scene.alarms()
        scene.passes(5.0)
        assert len(scene.times_s(order)) == 4

    def test_an_emergency_order_that_never_left_is_an_alarm(self) -> None:
        scene = flying()
        scene.is_stuck = True
        order = scene.order(Hover())
        scene.passes(5.2)
        assert scene.phase(order) is Phase.EXPIRED
        assert "order_not_confirmed" in scene.alarms()

    def test_so_is_one_whose_link_closed_before_it_left(self) -> None:
        scene = flying()
        scene.is_stuck = True
        order = scene.order(LandNow())
        scene.dropped(order, Phase.FAILED).closes(1).passes(0.1)
        assert scene.phase(order) is Phase.FAILED
        assert "order_not_confirmed" in scene.alarms()

    def test_one_stuck_in_a_queue_is_judged_anew_until_it_expires(self) -> None:
        scene = flying()
        scene.is_stuck = True
        order = scene.order(Hover())
        scene.passes(3.4)
        assert len(scene.handed) == 5
        assert scene.record(order).repeats_left == 3
        scene.is_stuck = False
        scene.passes(DEAF)
        assert scene.times_s(order) == pytest.approx([4.0, 4.7, 5.4])  # expired at 5.5 s

    def test_one_sent_before_its_link_closed_stays_open_for_a_confirmation(self) -> None:
        scene = flying()
        order = scene.order(LandNow())
        scene.closes(1).passes(DEAF)
        assert scene.phase(order) is Phase.TIMED_OUT
        assert "order_not_confirmed" in scene.alarms()
        scene.opens(2, *LANDING)
        assert scene.record(order).note == "telemetry shows it landing, after its time"
        assert "order_not_confirmed" not in scene.passes(0.1).alarms()


class TestLanding:
    def test_land_is_confirmed_by_mode_9_or_21_then_on_ground(self) -> None:
        scene = flying()
        order = scene.order(LandNow())
        scene.keeps_receiving(1, *LANDING).passes(40.0)
        assert scene.phases(order) == [Phase.QUEUED, Phase.SENT, Phase.CONFIRMED]
        assert not scene.phase(order).is_final
        assert len(scene.times_s(order)) == 1
        scene.lands(1, *GROUND)
        assert scene.phase(order) is Phase.DONE

    def test_a_landing_that_stops_in_the_air_is_an_alarm(self) -> None:
        scene = flying()
        scene.order(LandNow())
        scene.keeps_receiving(1, *LANDING).passes(5.0).keeps_receiving(1, *STANDING).passes(0.9)
        assert "landing_stopped" not in scene.alarms()
        scene.passes(0.3)
        assert "landing_stopped" in scene.alarms()
        scene.order(LandNow())
        scene.keeps_receiving(1, *GROUND).passes(0.2)
        assert "landing_stopped" not in scene.alarms()

    def test_mode_21_and_still_flying_for_long_is_an_alarm(self) -> None:
        scene = flying()
        scene.keeps_receiving(1, core(), extended(mode=FlightMode.CONFIRM_LANDING)).passes(8.0)
        assert "landing_waits" not in scene.alarms()
        scene.passes(0.2)
        assert "landing_waits" in scene.alarms()
        scene.keeps_receiving(1, *GROUND).passes(0.1)
        assert "landing_waits" not in scene.alarms()


class TestTakeoffByHover:
    def test_it_is_refused_without_the_word_and_sent_with_it(self) -> None:
        scene = CommandedStation().opens(1, *GROUND).keeps_receiving(1, *GROUND)
        assert scene.phase(scene.order(Hover())) is Phase.REFUSED_BY_STATION
        assert scene.sent == []
        order = scene.order(Hover(), takeoff=True)
        scene.passes(1.0)
        assert scene.phase(order) is Phase.SENT
        scene.keeps_receiving(1, *STANDING).passes(0.1)
        assert scene.phase(order) is Phase.DONE


class TestSeveralLinks:
    def conflict(self) -> CommandedStation:
        scene = flying()
        scene.opens(2, *scene.talk[1]).keeps_receiving(2, *scene.talk[1])
        return scene.passes(0.5)

    def test_a_stop_goes_to_every_link_that_claims_the_serial(self) -> None:
        scene = self.conflict()
        assert scene.station.fleet.vehicles["A"].in_conflict
        scene.order(Hover())
        assert {link for _, link, _ in scene.sent} == {1, 2}
        assert "serial_conflict" in scene.alarms()

    def test_it_is_confirmed_only_when_both_have_stopped(self) -> None:
        scene = self.conflict()
        order = scene.order(Hover())
        scene.keeps_receiving(1, *STANDING).passes(0.5)
        assert scene.phase(order) is Phase.SENT
        scene.keeps_receiving(2, *STANDING).passes(0.2)
        assert scene.phase(order) is Phase.DONE

    def test_dropped_by_one_link_it_lives_on_at_the_other(self) -> None:
        scene = self.conflict()
        scene.is_stuck = True
        order = scene.order(LandNow())
        scene.dropped(order, Phase.FAILED, link_id=1)
        assert scene.phase(order) is Phase.QUEUED
        scene.dropped(order, Phase.FAILED, link_id=2)
        assert scene.phase(order) is Phase.FAILED


class TestUnidentified:
    def unidentified(self) -> CommandedStation:
        reports = (core(velocity=(5.0, 0.0, 0.0)), extended(None, mode=FlightMode.GPS_WAYPOINT))
        return CommandedStation().opens(1, *reports).keeps_receiving(1, *reports).passes(0.2)

    def test_a_link_without_identity_can_be_held(self) -> None:
        scene = self.unidentified()
        order = scene.order(Hover(), None, link=1)
        assert scene.times_s(order) == [0.2]
        scene.keeps_receiving(1, core(), extended(None)).passes(0.2)
        assert scene.phase(order) is Phase.DONE

    def test_the_order_follows_the_link_when_it_reports_its_serial(self) -> None:
        scene = self.unidentified()
        order = scene.order(Hover(), None, link=1)
        scene.keeps_receiving(1, core(velocity=(5.0, 0.0, 0.0)), extended("A")).passes(1.0)
        assert len(scene.times_s(order)) == 2
        scene.keeps_receiving(1, core(), extended("A")).passes(0.2)
        assert scene.phase(order) is Phase.DONE

    def test_an_order_by_serial_supersedes_the_one_by_link(self) -> None:
        scene = self.unidentified()
        order = scene.order(Hover(), None, link=1)
        scene.receives(1, extended("A"))
        scene.order(LandNow())
        assert scene.phase(order) is Phase.SUPERSEDED

    def test_when_its_link_closes_the_order_has_ended(self) -> None:
        scene = self.unidentified()
        order = scene.order(Hover(), None, link=1)
        scene.closes(1).passes(0.1)
        assert scene.phase(order) is Phase.FAILED
        assert not scene.record(order).is_tracked
