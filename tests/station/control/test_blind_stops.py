"""A stop with telemetry lost and the link alive goes out while no landing was possible since."""

import pytest
from tests.fleet.reports import core, extended
from tests.safety.cases import mission
from tests.station.commanded import CommandedStation

from recon.model.command import Hover, LandNow, Phase
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken
from recon.model.vehicle import FlightMode

HIGH = (core(height_m=60.0, velocity=(5.0, 0.0, 0.0)), extended(mode=FlightMode.GPS_WAYPOINT))
STANDING = (core(height_m=60.0), extended(mode=FlightMode.GPS_ATTI))


def silent(seconds: float) -> CommandedStation:
    """A vehicle in a mission at 60 m, without telemetry for this long."""
    scene = CommandedStation().opens(1, *HIGH).keeps_receiving(1, *HIGH).passes(0.5)
    scene.talk.clear()
    return scene.passes(seconds)


class TestABlindStop:
    def test_it_goes_out_at_once_and_again_while_no_landing_is_possible(self) -> None:
        scene = silent(4.0)
        order = scene.order(Hover())
        scene.passes(10.0)
        assert scene.times_s(order) == pytest.approx([4.5, 5.2, 5.9])
        assert "stop_waits" in scene.alarms()

    def test_later_it_waits_for_telemetry(self) -> None:
        scene = silent(5.6)
        order = scene.order(Hover())
        assert scene.times_s(order) == []
        assert scene.phase(order) is Phase.QUEUED

    def test_when_telemetry_returns_and_it_flies_on_it_is_sent_again(self) -> None:
        scene = silent(4.0)
        order = scene.order(Hover())
        scene.passes(15.0)
        sent = len(scene.times_s(order))
        scene.keeps_receiving(1, *HIGH).passes(0.3)
        assert len(scene.times_s(order)) == sent + 1
        scene.keeps_receiving(1, *STANDING).passes(1.0)
        assert scene.phase(order) is Phase.DONE
        assert not {"stop_waits", "order_not_confirmed"} & scene.alarms()

    def test_when_telemetry_returns_and_it_holds_it_is_done(self) -> None:
        scene = silent(4.0)
        order = scene.order(Hover())
        scene.passes(5.0)
        sent = len(scene.times_s(order))
        scene.keeps_receiving(1, *STANDING).passes(1.0)
        assert scene.phase(order) is Phase.DONE
        assert len(scene.times_s(order)) <= sent + 1

    def test_without_telemetry_for_half_a_minute_it_has_timed_out(self) -> None:
        scene = silent(4.0)
        order = scene.order(Hover())
        scene.passes(29.0)
        assert scene.phase(order) is Phase.SENT
        scene.passes(2.0)
        assert scene.phase(order) is Phase.TIMED_OUT
        assert "order_not_confirmed" in scene.alarms()

    def test_a_newer_order_ends_it(self) -> None:
        scene = silent(4.0)
        order = scene.order(Hover())
        scene.order(LandNow())
        assert scene.phase(order) is Phase.SUPERSEDED


class TestAMissionThatResumes:
    def scene(self) -> CommandedStation:
        scene = CommandedStation().opens(1, *STANDING).keeps_receiving(1, *STANDING).passes(0.5)
        scene.order(mission())
        return scene.keeps_receiving(1, *HIGH).passes(2.0)

    def test_after_its_pilot_let_go_it_is_an_alarm(self) -> None:
        scene = self.scene()
        taken = core(height_m=60.0, velocity=(3.0, 0.0, 0.0)), extended(mode=FlightMode.GPS_SPORT)
        scene.keeps_receiving(1, *taken).passes(2.0)
        assert "pilot_took_over" in scene.alarms(active=False) | scene.alarms()
        assert "mission_resumed" not in scene.alarms()
        scene.keeps_receiving(1, *HIGH).passes(0.5)
        assert "mission_resumed" in scene.alarms()
        scene.keeps_receiving(1, *STANDING).passes(0.5)
        assert "mission_resumed" not in scene.alarms()

    def test_one_that_flies_on_under_its_pilot_is_none(self) -> None:
        scene = self.scene()
        scene.happens(AuthorityTaken("A", AuthorityHolder.PILOT, "Ann")).passes(2.0)
        assert "mission_resumed" not in scene.alarms()


class TestAReleaseToThePilot:
    def test_a_repeated_stop_ends(self) -> None:
        scene = CommandedStation().opens(1, *HIGH).keeps_receiving(1, *HIGH).passes(0.5)
        order = scene.order(Hover())
        scene.happens(AuthorityTaken("A", AuthorityHolder.PILOT, "Ann")).passes(10.0)
        assert scene.phase(order) is Phase.SUPERSEDED
        assert len(scene.times_s(order)) == 1

    def test_the_same_holder_again_withdraws_nothing(self) -> None:
        scene = CommandedStation().opens(1, *STANDING).keeps_receiving(1, *STANDING).passes(0.5)
        scene.is_stuck = True
        order = scene.order(mission())
        scene.happens(AuthorityTaken("A", AuthorityHolder.OPERATOR, "Ann"))
        assert scene.phase(order) is Phase.QUEUED
        scene.happens(AuthorityTaken("A", AuthorityHolder.GUIDANCE, "Ann"))
        assert scene.phase(order) is Phase.SUPERSEDED
