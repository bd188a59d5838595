"""A stop is not lost in a gap of telemetry, and a stick ends with a zero from the station."""

from dataclasses import replace

import pytest
from tests.fleet.reports import S, core, extended
from tests.safety.cases import STICK, mission
from tests.station.commanded import CommandedStation, flying

from recon.model.command import Hover, LandNow, Phase, ReturnHome, VirtualStick
from recon.model.vehicle import FlightMode

GROUND = (core(flying=False, height_m=0.0), extended(mode=FlightMode.GPS_ATTI))
JOYSTICK = (core(velocity=(5.0, 0.0, 0.0)), extended(mode=FlightMode.JOYSTICK))
STANDING = (core(), extended(mode=FlightMode.GPS_ATTI))
PILOT = (core(velocity=(5.0, 0.0, 0.0)), extended(mode=FlightMode.GPS_SPORT))
HELD = replace(STICK, velocity_x_mps=5.0, velocity_y_mps=0.0, timeout_s=1.0)


def silent() -> CommandedStation:
    """A vehicle in a mission, without telemetry for five seconds."""
    scene = flying()
    scene.talk.clear()
    return scene.passes(5.0)


class TestAStopInAGap:
    def test_it_is_sent_as_soon_as_telemetry_shows_the_vehicle_in_flight(self) -> None:
        scene = silent()
        order = scene.order(Hover())
        assert scene.phase(order) is Phase.QUEUED
        assert scene.sent == []
        scene.passes(4.0)
        assert "stop_waits" in scene.alarms()
        scene.receives(1, core(velocity=(5.0, 0.0, 0.0)))
        assert scene.phase(order) is Phase.SENT
        assert "stop_waits" not in scene.passes(0.1).alarms()

    def test_it_goes_to_the_link_on_which_the_vehicle_comes_back(self) -> None:
        scene = silent().closes(1)
        order = scene.order(Hover())
        scene.opens(2, core(velocity=(5.0, 0.0, 0.0)), extended())
        scene.receives(2, core(velocity=(5.0, 0.0, 0.0)))
        assert scene.phase(order) is Phase.SENT
        assert {link for _, link, _ in scene.sent} == {2}

    def test_it_never_goes_to_a_vehicle_that_has_landed_meanwhile(self) -> None:
        scene = silent()
        order = scene.order(Hover())
        scene.keeps_receiving(1, *GROUND).passes(40.0)
        assert scene.sent == []
        assert scene.phase(order) is Phase.EXPIRED

    def test_what_never_went_raises_an_alarm_that_stays(self) -> None:
        scene = silent()
        order = scene.order(Hover())
        scene.passes(31.0)
        assert scene.phase(order) is Phase.EXPIRED
        assert "order_not_confirmed" in scene.passes(60.0).alarms()

    def test_a_newer_order_ends_the_wait(self) -> None:
        scene = silent()
        order = scene.order(Hover())
        scene.order(LandNow())
        assert scene.phase(order) is Phase.SUPERSEDED

    def test_nothing_that_starts_motion_waits(self) -> None:
        for body in (ReturnHome(), mission(), STICK):
            scene = silent()
            assert scene.phase(scene.order(body)) is Phase.REFUSED_BY_STATION
        assert scene.phase(scene.order(Hover(), takeoff=True)) is not Phase.QUEUED or scene.sent


class TestTheZeroOfAStick:
    def sticks(self, scene: CommandedStation) -> list[VirtualStick]:
        return [body for body in scene.bodies() if isinstance(body, VirtualStick)]

    def test_it_is_sent_when_the_time_is_over(self) -> None:
        scene = flying()
        scene.order(HELD)
        scene.keeps_receiving(1, *JOYSTICK).passes(0.9)
        assert len(self.sticks(scene)) == 1
        scene.passes(0.3)
        first, zero = self.sticks(scene)
        assert (zero.velocity_x_mps, zero.velocity_y_mps) == (0.0, 0.0)
        assert (zero.yaw_deg, zero.height_above_takeoff_m) == (first.yaw_deg, 40.0)
        scene.passes(10.0)
        assert len(self.sticks(scene)) == 2

    def test_a_newer_order_takes_its_place(self) -> None:
        for newer in (Hover(), LandNow(), HELD):
            scene = flying()
            scene.order(HELD)
            scene.keeps_receiving(1, *JOYSTICK).passes(0.5)
            scene.order(newer)
            scene.passes(0.8)
            assert not any(s.velocity_x_mps == 0.0 for s in self.sticks(scene))

    def test_the_pilot_is_not_fought(self) -> None:
        scene = flying()
        scene.order(HELD)
        scene.keeps_receiving(1, *JOYSTICK).passes(0.5).keeps_receiving(1, *PILOT).passes(10.0)
        assert len(self.sticks(scene)) == 1

    def test_a_standing_stick_needs_none(self) -> None:
        scene = flying()
        scene.order(replace(HELD, velocity_x_mps=0.0, height_above_takeoff_m=40.5))
        scene.keeps_receiving(1, *JOYSTICK).passes(10.0)
        assert len(self.sticks(scene)) == 1

    def test_a_climb_ends_where_it_has_come_to(self) -> None:
        scene = flying()
        scene.order(replace(HELD, velocity_x_mps=0.0, height_above_takeoff_m=60.0))
        climbing = (core(height_m=43.0, velocity=(0.0, 0.0, -3.0)), JOYSTICK[1])
        scene.keeps_receiving(1, *climbing).passes(3.0)
        assert [stick.height_above_takeoff_m for stick in self.sticks(scene)] == [60.0, 43.0]

    def test_telemetry_that_stops_in_a_climb_holds_no_zero_back(self) -> None:
        scene = flying()
        scene.order(replace(HELD, height_above_takeoff_m=60.0))
        climbing = (core(height_m=43.0, velocity=(5.0, 0.0, -3.0)), JOYSTICK[1])
        scene.keeps_receiving(1, *climbing).passes(0.2)
        scene.talk.clear()
        scene.passes(2.0)
        _, zero = self.sticks(scene)
        assert (zero.velocity_x_mps, zero.height_above_takeoff_m) == (0.0, 43.0)

    def test_a_height_that_is_lost_in_a_climb_holds_no_zero_back(self) -> None:
        scene = flying()
        scene.order(replace(HELD, height_above_takeoff_m=60.0))
        lost = (core(height_m=None, velocity=(5.0, 0.0, -3.0)), JOYSTICK[1])
        scene.keeps_receiving(1, *lost).passes(2.0)
        _, zero = self.sticks(scene)
        assert (zero.velocity_x_mps, zero.height_above_takeoff_m) == (0.0, 60.0)


class TestTheHoldAfterAStick:
    """In stick mode an aircraft drifts, also at zero velocity."""

    def holds_at_s(self, scene: CommandedStation) -> list[float]:
        holds = {
            number
            for number, record in scene.station.orders.records.items()
            if isinstance(record.command.body, Hover)
        }
        return [round(at_s, 1) for at_s, _, number in scene.sent if number in holds]

    def test_it_follows_the_neutral_setpoint_and_ends_stick_mode(self) -> None:
        scene = flying()
        began_s = scene.now_ns / S
        scene.order(HELD)
        scene.keeps_receiving(1, *JOYSTICK).passes(2.3)
        (at_s,) = self.holds_at_s(scene)
        assert at_s - began_s == pytest.approx(HELD.timeout_s + 1.0, abs=0.21)
        scene.keeps_receiving(1, *STANDING).passes(20.0)
        assert len(self.holds_at_s(scene)) == 1

    def test_it_follows_a_stick_that_only_stops(self) -> None:
        scene = flying()
        scene.order(replace(HELD, velocity_x_mps=0.0, height_above_takeoff_m=40.5))
        scene.keeps_receiving(1, *JOYSTICK).passes(2.3)
        assert len(self.holds_at_s(scene)) == 1

    def test_sticks_that_follow_each_other_are_not_interrupted(self) -> None:
        scene = flying()
        scene.keeps_receiving(1, core(), JOYSTICK[1])
        for _ in range(6):
            scene.order(HELD)
            scene.passes(HELD.timeout_s + 0.5)
        assert self.holds_at_s(scene) == []

    def test_neither_the_pilot_nor_a_newer_order_gets_one(self) -> None:
        scene = flying()
        scene.order(HELD)
        scene.keeps_receiving(1, *JOYSTICK).passes(1.5)
        scene.keeps_receiving(1, *PILOT).passes(10.0)
        assert self.holds_at_s(scene) == []
        scene = flying()
        scene.order(HELD)
        scene.keeps_receiving(1, *JOYSTICK).passes(1.5)
        scene.order(LandNow())
        scene.passes(10.0)
        assert self.holds_at_s(scene) == []
