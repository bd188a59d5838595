"""A survey asks again for a mission that was not sent, when time may end the reason."""

from dataclasses import replace

import numpy as np
import pytest
from tests.station.surveyed_world import SurveyedWorld, asked, field, surveyed_world

from recon.model.command import Command, FlyMission, Phase, Refusal, StartCamera
from recon.model.control import StopLatch
from recon.model.geo import GroundGrid
from recon.model.shade import SunForecast
from recon.model.survey import SurveyPhase, WhenDone
from recon.safety import gate
from recon.safety.situation import Situation
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


EVERYWHERE_M, NOWHERE_M = 300.0, -300.0


def lit(world: SurveyedWorld, to_m: float, seconds: float = 0.0) -> None:
    """A forecast of now, of sun west of here; anew for some seconds."""
    for _ in range(round(seconds)):
        lit(world, to_m)
        world.runs(1.0)
    station = world.driver.station
    frame = station.airspace.airspace.frame
    assert frame is not None
    grid, leads_s = GroundGrid(frame, -60.0, 160.0, 8.0, 28, 40), np.arange(0.0, 330.0, 15.0)
    east_m = grid.west_m + grid.cell_m * (np.arange(grid.cols) + 0.5)
    sure = np.where(east_m < to_m, 255, 0).astype(np.uint8)
    sun = SunForecast(
        grid=grid,
        issued_at_ns=world.driver.now_ns,
        lead_s=leads_s,
        sun_probability=np.tile(sure, (len(leads_s), grid.rows, 1)),
        horizon_s=np.full((28, 40), 300.0, np.float32),
        prior_sunlit=0.5,
        method="made",
        velocity_mps=(1.0, 0.0),
    )
    world.driver.station = replace(station, shade=replace(station.shade, sun=sun))


def test_one_whose_telemetry_is_back_may_wait_for_sun_and_flies_then() -> None:
    world = surveyed_world(packet_gap_s=GAP_S)
    world.asks(asked(field(60.0, 30.0), planner="sunlit_first", when_done=WhenDone.HOVER))
    world.fleet.world.order("SIM-1", StartCamera(1.0))
    lit(world, EVERYWHERE_M)
    world.starts("SIM-1")
    world.runs(0.2)
    is_silent(world, True)
    world.runs(2.2)
    is_silent(world, False)
    assert [each.times_sent for each in world.missions()] == [0]
    lit(world, NOWHERE_M, SURVEY_TIMES.unsent_within_s + 10.0)
    assert stop_reason(world) is None
    assert refusal_shown(world) is None
    lit(world, EVERYWHERE_M, 20.0)
    assert world.missions()[-1].times_sent == 1


def test_after_an_earlier_mission_it_is_stopped_after_the_same_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def late(command: Command, _situation: Situation) -> Refusal | None:
        is_mission = isinstance(command.body, FlyMission)
        return Refusal("link_age", "extended telemetry is 9 s old") if is_mission else None

    world = surveyed_world()
    world.asks(asked(field(180.0, 60.0), planner="sunlit_first", when_done=WhenDone.HOVER))
    lit(world, 90.0)
    world.starts("SIM-1")
    lit(world, 90.0, 100.0)
    assert Phase.DONE in {each.phase for each in world.missions()}
    monkeypatch.setattr(gate, "RULES", (*gate.RULES, late))
    while world.missions()[-1].phase is not Phase.REFUSED_BY_STATION:
        lit(world, EVERYWHERE_M, 1.0)
    lit(world, EVERYWHERE_M, SURVEY_TIMES.unsent_within_s - 5.0)
    assert stop_reason(world) is None
    lit(world, EVERYWHERE_M, 15.0)
    assert "extended telemetry is 9 s old" in str(stop_reason(world))
    assert ("survey", "SIM-1") in world.fleet.alarms()


def test_fewer_rows_are_asked_for_where_the_battery_does_not_last_for_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def too_long(command: Command, _situation: Situation) -> Refusal | None:
        body = command.body
        is_long = isinstance(body, FlyMission) and len(body.mission.waypoints) > 8
        return Refusal("battery", "this mission needs 82 %") if is_long else None

    monkeypatch.setattr(gate, "RULES", (*gate.RULES, too_long))
    world = surveyed_world()
    world.asks(asked(field(180.0, 140.0), planner="sunlit_first"))
    lit(world, EVERYWHERE_M)
    world.starts("SIM-1")
    lit(world, EVERYWHERE_M, 10.0)
    assert world.missions()[0].phase is Phase.REFUSED_BY_STATION
    assert world.missions()[-1].times_sent == 1
    assert world.record().members["SIM-1"].return_reason is None
