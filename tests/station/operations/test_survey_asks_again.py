"""A survey asks again for a mission that was not sent, when time may end the reason."""

from dataclasses import replace

from tests.station.surveyed_world import SurveyedWorld, asked, field, surveyed_world

from recon.model.command import Phase, StartCamera
from recon.model.control import StopLatch
from recon.model.survey import SurveyPhase
from recon.station.api_views.operation_views import survey_views
from recon.station.operations.settings import SURVEY_TIMES

GAP_S = 2.0
"""Between two packets to the app: a mission after another order waits, and is judged again."""


def with_waiting_mission(height_m: float = 40.0) -> SurveyedWorld:
    """A survey whose first mission is approved and not sent yet: another packet went before it."""
    world = surveyed_world(height_m=height_m, packet_gap_s=GAP_S)
    world.asks(asked(field(60.0, 30.0)))
    world.fleet.world.order("SIM-1", StartCamera(1.0))
    world.starts("SIM-1", takeoff=height_m == 0.0)
    world.runs(0.2)
    assert [each.phase for each in world.missions()] == [Phase.QUEUED]
    return world


def is_silent(world: SurveyedWorld, is_it: bool) -> None:
    """Have the vehicle's app neither send nor read, or do so again."""
    world.fleet.world.connected["SIM-1"].connection.is_abandoned = is_it


def stop_reason(world: SurveyedWorld) -> str | None:
    return world.record().members["SIM-1"].stop_reason


def refusal_shown(world: SurveyedWorld) -> str | None:
    (view,) = survey_views(world.driver.station, world.driver.now_ns)
    return view.vehicles[0].refused


class TestLateTelemetry:
    def test_a_mission_that_it_holds_back_is_asked_for_again_and_flown(self) -> None:
        world = with_waiting_mission()
        is_silent(world, True)
        world.runs(2.2)
        is_silent(world, False)
        (first,) = world.missions()
        assert (first.phase, first.times_sent) == (Phase.REFUSED_BY_STATION, 0)
        assert first.refusal is not None
        assert first.refusal.rule == "link_age"
        world.runs(1.0)
        assert "core telemetry must be at most 1 s old" in str(refusal_shown(world))
        assert "asked for again" in str(refusal_shown(world))
        assert len(world.missions()) == 1
        world.runs(4.0)
        assert [each.times_sent for each in world.missions()] == [0, 1]
        assert refusal_shown(world) is None
        assert ("survey", "SIM-1") not in world.fleet.alarms()
        assert world.runs_until(SurveyPhase.DONE, 200.0)

    def test_while_it_lasts_the_vehicle_is_stopped_after_a_time(self) -> None:
        world = with_waiting_mission()
        is_silent(world, True)
        world.runs(SURVEY_TIMES.unsent_within_s - 2.0)
        assert stop_reason(world) is None
        world.runs(6.0)
        assert "no mission could be sent to it for 60 s" in str(stop_reason(world))
        assert "telemetry must be at most 1 s old" in str(stop_reason(world))
        assert ("survey", "SIM-1") in world.fleet.alarms()
        is_silent(world, False)
        world.runs(10.0)
        assert len(world.missions()) == 1
        world.starts("SIM-1")
        world.runs(5.0)
        assert [each.times_sent for each in world.missions()] == [0, 1]

    def test_a_takeoff_that_was_not_sent_is_still_allowed_once(self) -> None:
        world = with_waiting_mission(height_m=0.0)
        is_silent(world, True)
        world.runs(2.2)
        is_silent(world, False)
        world.runs(10.0)
        assert [each.command.takeoff for each in world.missions()] == [True, True]
        assert world.fleet.flies("SIM-1")
        assert not world.record().members["SIM-1"].may_take_off


def test_an_operators_pause_after_it_is_no_pause_by_itself() -> None:
    world = with_waiting_mission()
    is_silent(world, True)
    world.runs(2.2)
    is_silent(world, False)
    world.runs(0.8)
    assert refusal_shown(world) is not None
    world.pauses()
    world.runs(0.2)
    assert ("survey", None) not in world.fleet.alarms()


def test_after_a_reconnection_a_mission_that_was_not_sent_is_asked_for_again() -> None:
    world = with_waiting_mission()
    connected = world.fleet.world.connected["SIM-1"]
    world.driver.disconnect(connected.link_id)
    assert [each.phase for each in world.missions()] == [Phase.FAILED]
    world.fleet.world.connect(connected.app)
    world.runs(8.0)
    assert stop_reason(world) is None
    assert [each.times_sent for each in world.missions()] == [0, 1]


def test_what_time_does_not_end_stops_the_vehicle() -> None:
    world = with_waiting_mission()
    world.driver.station = replace(world.driver.station, stop_latch=StopLatch("bob", 0))
    world.runs(3.0)
    (mission,) = world.missions()
    assert (mission.phase, mission.times_sent) == (Phase.REFUSED_BY_STATION, 0)
    assert "the situation has changed" in str(stop_reason(world))
    assert ("survey", "SIM-1") in world.fleet.alarms()
