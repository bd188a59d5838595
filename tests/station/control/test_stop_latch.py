"""An all stop stays in force until a person releases it: nothing moves by any order."""

from dataclasses import replace

import pytest
from tests.fleet.reports import core, extended
from tests.safety.cases import STICK, mission
from tests.station.commanded import CommandedStation, flying
from tests.station.recovery.restarts import restored_from, saved

from recon.model.command import Hover, LandNow, Phase, ReturnHome, StartCamera
from recon.model.control import AuthorityHolder, StopLatch
from recon.model.event import (
    AllStopped,
    AuthorityTaken,
    FleetReturnOrdered,
    OperatorOrder,
    StopReleased,
)
from recon.model.vehicle import FlightMode
from recon.station.control import stop_latch
from recon.station.recovery.snapshot import decode_snapshot, encode_snapshot, take_snapshot
from recon.station.state.station import Station
from recon.station.state.steps import WithdrawMotion

HOVERING = (core(), extended(mode=FlightMode.GPS_ATTI))
GROUND = (core(flying=False, height_m=0.0), extended(mode=FlightMode.GPS_ATTI))
OTHER = (core(), extended("B", mode=FlightMode.GPS_ATTI))


def stopped() -> CommandedStation:
    """One vehicle that hovers, after an all stop."""
    scene = CommandedStation().opens(1, *HOVERING).keeps_receiving(1, *HOVERING).passes(0.5)
    return scene.happens(AllStopped("Ann"))


def released(scene: CommandedStation, *serials: str) -> CommandedStation:
    return scene.happens(StopReleased(serials or None, "Bob"))


class TestTheLatch:
    @pytest.mark.parametrize("role", AuthorityHolder)
    def test_nothing_moves_of_any_client(self, role: AuthorityHolder) -> None:
        scene = stopped()
        scene.happens(AuthorityTaken("A", role, "Ann"))
        for number, body in enumerate((mission(), STICK), start=50):
            scene.happens(OperatorOrder(number, body, "test", "A", role=role))
            assert scene.refusal_rule(number) == "stop_latch"
        assert scene.sent == []

    def test_hold_land_return_and_camera_are_sent(self) -> None:
        scene = stopped()
        for body in (Hover(), LandNow(), ReturnHome(), StartCamera(1.0)):
            assert scene.phase(scene.order(body)) is Phase.SENT

    def test_a_takeoff_by_hover_is_refused(self) -> None:
        scene = stopped().keeps_receiving(1, *GROUND).passes(0.2)
        assert scene.refusal_rule(scene.order(Hover(), takeoff=True)) == "stop_latch"

    def test_a_vehicle_that_connects_later_is_latched_too(self) -> None:
        scene = stopped().opens(2, *OTHER).keeps_receiving(2, *OTHER).passes(0.2)
        assert scene.refusal_rule(scene.order(STICK, "B")) == "stop_latch"

    def test_a_fleet_return_is_refused_and_one_under_way_ends(self) -> None:
        scene = stopped().happens(FleetReturnOrdered(80, ("A",), "Ann"))
        assert scene.refusal_rule(80) == "stop_latch"

    def test_a_fleet_return_given_long_ago_is_refused(self) -> None:
        scene = released(stopped()).passes(30.0)
        scene.happens(FleetReturnOrdered(80, ("A",), "Ann", scene.now_ns - 25 * 1_000_000_000))
        assert scene.refusal_rule(80) == "not_expired"

    def test_guidance_has_nothing_to_resume_with(self) -> None:
        scene = CommandedStation().opens(1, *HOVERING).keeps_receiving(1, *HOVERING).passes(0.5)
        scene.happens(AuthorityTaken("A", AuthorityHolder.GUIDANCE, "Ann"))
        scene.happens(AllStopped("Ann"))
        assert scene.station.control("A").authority.holder is AuthorityHolder.OPERATOR

    def test_what_waits_unsent_ends_also_on_the_ground(self) -> None:
        scene = CommandedStation().opens(1, *GROUND).keeps_receiving(1, *GROUND).passes(0.5)
        scene.is_stuck = True
        waiting = scene.order(mission(), takeoff=True)
        station, outputs = stop_latch.latch(scene.station, AllStopped("Ann"), scene.now_ns)
        assert outputs == (WithdrawMotion((1,), "all stop by Ann"),)
        assert station.orders.records[waiting].phase is Phase.SUPERSEDED
        assert station.orders.records[waiting].note == "withdrawn: all stop by Ann"

    def test_it_is_an_alarm_that_names_the_vehicles(self) -> None:
        scene = stopped().passes(0.1)
        (alarm,) = (a for a in scene.station.alarms.alarms.values() if a.is_active)
        assert alarm.condition.rule == "all_stop"
        assert alarm.condition.text.startswith("all stop by Ann in force for A:")
        assert "all_stop" not in released(scene).passes(0.1).alarms()

    def test_a_single_hold_does_not_latch(self) -> None:
        scene = flying()
        scene.order(Hover())
        assert scene.station.stop_latch is None
        assert scene.phase(scene.order(STICK)) is Phase.SENT


class TestTheRelease:
    def test_of_one_vehicle_leaves_the_others_latched(self) -> None:
        scene = stopped().opens(2, *OTHER).keeps_receiving(2, *OTHER).passes(0.2)
        released(scene, "A")
        assert scene.phase(scene.order(STICK)) is Phase.SENT
        assert scene.refusal_rule(scene.order(STICK, "B")) == "stop_latch"

    def test_of_all_ends_it_and_sends_nothing(self) -> None:
        scene = released(stopped().passes(1.0)).passes(5.0)
        assert scene.station.stop_latch is None
        assert scene.sent == []
        assert scene.phase(scene.order(STICK)) is Phase.SENT

    def test_another_all_stop_latches_every_vehicle_again(self) -> None:
        scene = released(stopped(), "A").happens(AllStopped("Bob"))
        assert scene.station.stop_latch == StopLatch("Bob", scene.now_ns)

    def test_of_an_unknown_vehicle_is_refused_as_a_whole(self) -> None:
        scene = stopped()
        event = StopReleased(("A", "X"), "Bob")
        refusal = stop_latch.refusal(scene.station, event)
        assert refusal is not None
        assert "X: unknown serial" in refusal.reason
        assert scene.happens(event).station.is_stopped("A")

    def test_without_an_all_stop_there_is_nothing_to_release(self) -> None:
        scene = flying()
        refusal = stop_latch.refusal(scene.station, StopReleased(None, "Bob"))
        assert refusal is not None
        before = scene.station
        assert released(scene).station is before

    def test_a_vehicle_that_was_forgotten_is_latched_again(self) -> None:
        scene = released(stopped(), "A")
        gone = scene.station.with_fleet(replace(scene.station.fleet, vehicles={}))
        later = stop_latch.release(gone, StopReleased((), "Bob"), scene.now_ns)
        assert later.is_stopped("A")


class TestARestart:
    def test_the_latch_outlives_it_however_old_the_snapshot(self) -> None:
        scene = released(stopped(), "A")
        snapshot = saved(scene.station, scene.now_ns)
        later_ns = scene.now_ns + 10 * 3600 * 1_000_000_000
        assert restored_from(snapshot, later_ns).stop_latch == scene.station.stop_latch

    def test_a_snapshot_of_version_1_has_none(self) -> None:
        payload = encode_snapshot(take_snapshot(Station(), 0))
        old = payload.replace(b'"stop_latch":null,', b"")
        assert old != payload
        assert decode_snapshot(old).stop_latch is None
