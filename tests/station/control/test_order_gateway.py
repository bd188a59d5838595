"""Missions, sticks and camera orders; what is sent, and what becomes of it."""

from dataclasses import replace

import pytest
from tests.fleet.reports import core, extended
from tests.safety.cases import STICK, mission
from tests.station.commanded import PROFILES, CommandedStation, flying

from recon.fleet.state import Fleet
from recon.model.command import Body, Hover, Phase, ReturnHome, StartCamera, StopCamera
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken, CommandSent
from recon.model.report import ImageReport
from recon.model.vehicle import AltitudeReference, FlightMode

GROUND = (core(flying=False), extended(mode=FlightMode.GPS_ATTI))
HOVERING = (core(), extended(mode=FlightMode.GPS_ATTI))


def hovering() -> CommandedStation:
    return CommandedStation().opens(1, *HOVERING).keeps_receiving(1, *HOVERING).passes(0.5)


@pytest.mark.parametrize("body", [Hover(), ReturnHome(), mission(), STICK])
def test_nothing_that_could_take_off_is_sent_to_a_vehicle_on_the_ground(body: Body) -> None:
    scene = CommandedStation().opens(1, *GROUND).keeps_receiving(1, *GROUND)
    order = scene.order(body)
    scene.passes(10.0)
    assert scene.sent == []
    assert scene.refusal_rule(order) == "flying"


@pytest.mark.parametrize("body", [Hover(), mission(), STICK])
def test_takeoff_is_always_explicit(body: Body) -> None:
    scene = CommandedStation().opens(1, *GROUND)
    scene.order(body, takeoff=True)
    assert len(scene.sent) == 1


class TestStickUnconfirmed:
    def test_one_that_telemetry_does_not_show_is_an_alarm_until_it_does(self) -> None:
        scene = hovering()
        order = scene.order(replace(STICK, timeout_s=5.0))
        scene.passes(scene.station.settings.stick_confirm_s + 0.2)
        assert scene.phase(order) is Phase.TIMED_OUT
        assert scene.alarms() == {"order_not_confirmed"}
        scene.order(Hover())
        assert scene.passes(0.2).alarms() == set()


class TestMission:
    def test_it_has_started_when_the_mode_becomes_10(self) -> None:
        scene = hovering()
        order = scene.order(mission())
        scene.answered(order, True)
        assert scene.phase(order) is Phase.ACKNOWLEDGED
        scene.keeps_receiving(1, core(), extended(mode=FlightMode.GPS_WAYPOINT)).passes(0.1)
        assert scene.phase(order) is Phase.STARTED

    def test_an_old_mode_is_no_knowledge_of_the_mode_now(self) -> None:
        """Mode 3 four seconds ago: it may be 10 by now, from the mission before."""
        scene = hovering().happens(AuthorityTaken("A", AuthorityHolder.OPERATOR, "Ann"))
        scene.keeps_receiving(1, core(velocity=(-5.0, 0.0, 0.0))).passes(2.5)
        scene.is_stuck = True
        order = scene.order(mission())
        scene.passes(1.5).happens(CommandSent(1, order))
        scene.receives(1, extended(mode=FlightMode.GPS_WAYPOINT)).passes(1.0)
        assert scene.phase(order) is Phase.SENT

    def test_one_that_is_silently_rejected_is_an_alarm(self) -> None:
        scene = hovering()
        order = scene.order(mission())
        upload_s = 0.1 * len(mission().mission.waypoints)
        scene.answered(order, True).passes(7.9 + upload_s)
        assert scene.phase(order) is not Phase.TIMED_OUT
        scene.passes(0.2)
        assert scene.phase(order) is Phase.TIMED_OUT
        assert scene.alarms() == {"mission_ignored"}
        scene.keeps_receiving(1, core(), extended(mode=FlightMode.GPS_WAYPOINT)).passes(0.2)
        assert scene.alarms() == set()

    def test_a_refusal_by_the_app_ends_it(self) -> None:
        scene = hovering()
        order = scene.order(mission())
        scene.answered(order, False).passes(20.0)
        assert scene.phase(order) is Phase.REFUSED_BY_APP
        assert scene.times_s(order) == [0.5]

    def test_a_missed_acknowledgment_is_written_down_and_changes_nothing(self) -> None:
        scene = hovering()
        order = scene.order(mission())
        scene.answered(order, None)
        assert scene.phase(order) is Phase.SENT
        assert "not acknowledged" in scene.record(order).note

    def test_it_is_never_repeated(self) -> None:
        scene = hovering()
        order = scene.order(mission())
        scene.passes(30.0)
        assert len(scene.times_s(order)) == 1

    def test_one_that_never_left_expires(self) -> None:
        scene = hovering()
        scene.is_stuck = True
        order = scene.order(mission())
        scene.passes(5.1)
        assert scene.phase(order) is Phase.EXPIRED
        assert not scene.record(order).is_tracked

    def test_the_audit_has_the_altitudes_sent(self) -> None:
        scene = hovering()
        assert scene.record(scene.order(mission())).altitudes == (
            "sent as 40.0 to 40.0 m above takeoff"
        )
        profile = replace(PROFILES["A"], waypoint_altitude=AltitudeReference.WGS84)
        scene = CommandedStation()
        scene.station = replace(scene.station, fleet=Fleet(profiles={"A": profile}))
        scene.opens(1, *HOVERING, core())
        order = scene.order(mission())
        assert scene.handed[0].altitude_offset_m == 260.0
        assert "sent as 300.0 to 300.0 m WGS84" in (scene.record(order).altitudes or "")

    def test_a_vehicle_whose_altitude_reference_is_unset_gets_none(self) -> None:
        reports = (core(), extended("C"))
        scene = CommandedStation().opens(1, *reports)
        order = scene.order(mission(), "C")
        assert scene.refusal_rule(order) == "altitude_reference"
        assert scene.sent == []


class TestCameraAndStick:
    def test_a_newer_camera_order_ends_the_older(self) -> None:
        scene = hovering()
        first = scene.order(StartCamera(1.0))
        second = scene.order(StopCamera())
        assert scene.phase(first) is Phase.SUPERSEDED
        scene.passes(3.0)
        assert scene.phase(second) is Phase.DONE

    def test_a_start_is_confirmed_by_an_image(self) -> None:
        scene = hovering()
        order = scene.order(StartCamera(1.0))
        scene.passes(0.1).receives(1, ImageReport(target_fps_hz=1.0, jpeg=b"x")).passes(0.1)
        assert scene.phase(order) is Phase.DONE

    @pytest.mark.parametrize(
        ("body", "limit_s", "alarms"),
        [(StartCamera(1.0), 8.0, set()), (STICK, 2.0, {"order_not_confirmed"})],
    )
    def test_without_confirmation_it_times_out_and_what_moves_is_an_alarm(
        self, body: Body, limit_s: float, alarms: set[str]
    ) -> None:
        scene = flying()
        scene.keeps_receiving(1, core(), extended(mode=FlightMode.GPS_WAYPOINT))
        order = scene.order(body)
        scene.passes(limit_s - 0.1)
        assert scene.phase(order) is Phase.SENT
        scene.passes(0.2)
        assert scene.phase(order) is Phase.TIMED_OUT
        assert scene.alarms() == alarms

    def test_in_a_conflict_neither_is_sent(self) -> None:
        scene = hovering().opens(2, *HOVERING)
        for body in (STICK, StartCamera(1.0), mission()):
            assert scene.refusal_rule(scene.order(body)) == "identified"


def test_an_order_to_an_unknown_vehicle_is_refused() -> None:
    scene = CommandedStation()
    assert scene.phase(scene.order(Hover(), "X")) is Phase.REFUSED_BY_STATION
    assert scene.phase(scene.order(Hover(), None, link=9)) is Phase.REFUSED_BY_STATION
    assert scene.phase(scene.order(Hover(), None)) is Phase.REFUSED_BY_STATION


def test_a_link_event_of_an_unknown_order_is_ignored() -> None:
    scene = hovering()
    before = scene.station
    scene.answered(77, True).dropped(77, Phase.FAILED)
    assert scene.station is before
