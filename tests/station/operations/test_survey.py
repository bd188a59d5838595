"""Surveys flown live in virtual time: simulated apps, the real station, the real gate."""

import numpy as np
import pytest
from tests.flown_once import flown_once
from tests.station.surveyed_world import SURVEY_ID, SurveyedWorld, asked, field, surveyed_world

from recon.model.airspace import HeightDatum, Zone, ZoneKind
from recon.model.command import FlyMission, LandNow, Phase
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken, SurveyStarted
from recon.model.survey import SurveyPhase, WhenDone
from recon.station.operations.survey.commands import start_refusal
from recon.station.operations.survey.execution import STEP_SURVEY, advance
from recon.station.operations.survey.planning import step_survey
from recon.station.state.steps import Job, JobDone


def two_ends() -> SurveyedWorld:
    """Two vehicles, each at its end of a long field."""
    return surveyed_world(2, pads=((0.0, -40.0), (360.0, -40.0)))


@pytest.fixture(scope="module")
def flown() -> SurveyedWorld:
    world = two_ends()
    world.asks(asked(field(360.0), when_done=WhenDone.HOVER))
    world.starts("SIM-1", "SIM-2")
    assert world.runs_until(SurveyPhase.DONE, 400.0), world.record()
    return world


class TestFlownByTwo:
    def test_all_that_rows_reach_is_imaged(self, flown: SurveyedWorld) -> None:
        seen = flown.figures()
        assert seen.reached_m2 == pytest.approx(seen.region_m2)
        assert seen.not_yet_m2 < 0.02 * seen.region_m2

    def test_without_an_imaging_drone_the_light_is_unknown(self, flown: SurveyedWorld) -> None:
        assert flown.figures().in_sun_m2 == 0.0
        assert flown.figures().in_shade_m2 == 0.0
        assert flown.figures().sun_unknown_m2 > 0.98 * flown.figures().reached_m2

    def test_every_mission_passed_the_gate_as_guidance(self, flown: SurveyedWorld) -> None:
        given = flown.missions()
        assert {each.command.serial for each in given} == {"SIM-1", "SIM-2"}
        assert {each.command.role for each in given} == {AuthorityHolder.GUIDANCE}
        assert {each.command.issued_by for each in given} == {"ann: survey field"}
        assert all(each.command.id < 0 for each in given)
        assert all(each.phase is Phase.DONE for each in given)

    def test_its_vehicles_go_back_to_the_operator_when_it_is_done(
        self, flown: SurveyedWorld
    ) -> None:
        assert {flown.holder("SIM-1"), flown.holder("SIM-2")} == {AuthorityHolder.OPERATOR}

    def test_a_hovering_vehicle_is_an_alarm_until_its_next_order(
        self, flown: SurveyedWorld
    ) -> None:
        assert ("survey_over", "SIM-1") in flown.fleet.alarms()

    def test_the_flown_paths_are_kept(self, flown: SurveyedWorld) -> None:
        paths = flown.record().flown
        assert {serial for serial, _ in paths} == {"SIM-1", "SIM-2"}
        assert min(len(path) for path in paths.values()) > 10


class TestBeforeTheStart:
    def test_nothing_flies_and_guidance_controls_no_vehicle(self) -> None:
        world = surveyed_world()
        world.asks()
        world.runs(20.0)
        assert world.phase() is SurveyPhase.CREATED
        assert world.missions() == []
        assert world.holder("SIM-1") is AuthorityHolder.OPERATOR

    def test_one_that_cannot_be_flown_has_a_reason(self) -> None:
        world = surveyed_world()
        world.asks(asked(speed_mps=14.0))
        refusal = world.record().refusal
        assert refusal is not None
        assert "fly at" in refusal.reason
        world.starts("SIM-1")
        assert world.holder("SIM-1") is AuthorityHolder.OPERATOR

    def test_two_requested_at_once_are_planned_or_refused(self) -> None:
        world = surveyed_world()
        world.asks(asked(id=1))
        world.asks(asked(id=2, name="other"))
        assert [r.state is not None for r in world.driver.station.surveys.records.values()] == [
            True,
            True,
        ]


class TestStart:
    def test_all_vehicles_or_none(self) -> None:
        world = surveyed_world(2)
        world.asks()
        world.driver.handle(AuthorityTaken("SIM-2", AuthorityHolder.PILOT, "the pilot"))
        world.starts("SIM-1", "SIM-2")
        world.runs(5.0)
        assert world.phase() is SurveyPhase.CREATED
        assert world.holder("SIM-1") is AuthorityHolder.OPERATOR
        assert world.missions() == []

    @pytest.mark.parametrize("serials", [(), ("SIM-9",)])
    def test_no_vehicle_or_an_unknown_one_is_refused(self, serials: tuple[str, ...]) -> None:
        world = surveyed_world()
        world.asks()
        world.starts(*serials)
        assert world.phase() is SurveyPhase.CREATED

    def test_a_vehicle_on_the_ground_takes_off_only_if_allowed(self) -> None:
        world = surveyed_world(height_m=0.0)
        world.asks()
        start = SurveyStarted(SURVEY_ID, ("SIM-1",), "ann")
        refused = start_refusal(world.driver.station, start, world.driver.now_ns)
        assert refused is not None
        assert refused.reason == "SIM-1 is on the ground; allow takeoff for this start"
        world.driver.handle(start)
        world.runs(20.0)
        assert world.phase() is SurveyPhase.CREATED
        assert world.holder("SIM-1") is AuthorityHolder.OPERATOR
        assert not world.fleet.flies("SIM-1")
        world.starts("SIM-1", takeoff=True)
        world.runs(20.0)
        assert [each.command.takeoff for each in world.missions()] == [True]
        assert world.fleet.flies("SIM-1")

    def test_the_permission_is_for_one_takeoff(self) -> None:
        world = surveyed_world(height_m=0.0)
        world.asks()
        world.starts("SIM-1", takeoff=True)
        world.runs(20.0)
        member = world.record().members["SIM-1"]
        assert not member.may_take_off

    def test_a_vehicle_of_another_running_survey_is_refused(self) -> None:
        world = surveyed_world()
        world.asks()
        world.asks(asked(id=2, name="other"))
        world.starts("SIM-1")
        world.driver.handle(SurveyStarted(2, ("SIM-1",), "ann"))
        assert world.phase(2) is SurveyPhase.CREATED


@flown_once
def half_flown() -> SurveyedWorld:
    world = two_ends()
    world.asks(asked(field(360.0)))
    world.starts("SIM-1", "SIM-2")
    world.runs(30.0)
    assert len(world.missions()) == 2
    return world


class TestStopped:
    @pytest.fixture
    def flying(self) -> SurveyedWorld:
        return half_flown()

    def test_a_pause_holds_its_vehicles_and_orders_no_more_missions(
        self, flying: SurveyedWorld
    ) -> None:
        given = len(flying.missions())
        flying.pauses()
        flying.runs(30.0)
        assert flying.phase() is SurveyPhase.PAUSED
        assert len(flying.missions()) == given
        assert {flying.holder("SIM-1"), flying.holder("SIM-2")} == {AuthorityHolder.OPERATOR}
        before = [flying.fleet.place_m(serial) for serial in ("SIM-1", "SIM-2")]
        flying.runs(5.0)
        after = [flying.fleet.place_m(serial) for serial in ("SIM-1", "SIM-2")]
        assert np.abs(np.array(after) - before).max() < 0.5
        assert all(flying.fleet.flies(serial) for serial in ("SIM-1", "SIM-2"))

    def test_after_a_pause_it_is_flown_to_its_end(self, flying: SurveyedWorld) -> None:
        flying.pauses()
        flying.runs(10.0)
        flying.starts("SIM-1", "SIM-2")
        assert flying.runs_until(SurveyPhase.DONE, 500.0)
        assert flying.figures().not_yet_m2 < 0.02 * flying.figures().region_m2

    def test_a_paused_survey_leaves_its_vehicles_to_the_next_one(
        self, flying: SurveyedWorld
    ) -> None:
        """It still counts their positions, which are on the leg to the other survey's rows."""
        flying.pauses()
        flying.runs(5.0)
        flying.asks(asked(field(200.0, 80.0), id=2, name="other"))
        flying.starts("SIM-1", number=2)
        for _ in range(20):
            flying.runs(1.0)
            assert flying.holder("SIM-1") is AuthorityHolder.GUIDANCE
        assert flying.state(2).reason == "round 1"
        assert [each.phase for each in flying.missions("SIM-1")][-1] is Phase.STARTED

    def test_an_abort_is_for_good(self, flying: SurveyedWorld) -> None:
        imaged = flying.figures().not_yet_m2
        flying.aborts()
        flying.runs(5.0)
        flying.starts("SIM-1")
        flying.runs(20.0)
        assert flying.phase() is SurveyPhase.ABORTED
        assert flying.figures().not_yet_m2 <= imaged
        assert flying.holder("SIM-1") is AuthorityHolder.OPERATOR

    @pytest.mark.flight
    def test_one_landed_by_the_operator_stays_landed_and_the_other_flies_all(
        self, flying: SurveyedWorld
    ) -> None:
        flying.fleet.world.order("SIM-1", LandNow())
        given = len(flying.missions("SIM-1"))
        assert flying.runs_until(SurveyPhase.DONE, 600.0)
        assert len(flying.missions("SIM-1")) == given
        assert flying.holder("SIM-1") is AuthorityHolder.OPERATOR
        assert flying.figures().not_yet_m2 < 0.02 * flying.figures().region_m2

    def test_a_pause_leaves_the_pilots_vehicle_alone(self, flying: SurveyedWorld) -> None:
        flying.driver.handle(AuthorityTaken("SIM-1", AuthorityHolder.PILOT, "the pilot"))
        before = len(flying.driver.station.orders.records)
        flying.pauses()
        flying.runs(2.0)
        held = list(flying.driver.station.orders.records.values())[before:]
        assert {each.command.serial for each in held} == {"SIM-2"}


class TestFailures:
    def test_an_ignored_mission_is_not_repeated(self) -> None:
        world = surveyed_world(faults=("ack-then-nothing:SIM-1:1:900",))
        world.asks()
        world.starts("SIM-1")
        world.runs(60.0)
        assert [each.phase for each in world.missions()] == [Phase.TIMED_OUT]
        assert ("survey", "SIM-1") in world.fleet.alarms()

    @pytest.mark.flight
    def test_one_that_was_stopped_and_still_hovers_at_the_end_is_an_alarm(self) -> None:
        world = surveyed_world(2, faults=("ack-then-nothing:SIM-1:1:900",))
        world.asks()
        world.starts("SIM-1", "SIM-2")
        assert world.runs_until(SurveyPhase.DONE, 400.0)
        world.runs(90.0)
        assert world.fleet.flies("SIM-1")
        assert not world.fleet.flies("SIM-2")
        assert ("survey_over", "SIM-1") in world.fleet.alarms()
        (text,) = [
            each.condition.text
            for each in world.driver.station.alarms.alarms.values()
            if each.condition.rule == "survey_over" and each.is_active
        ]
        assert "it had stopped: mission timed out" in text
        world.fleet.world.order("SIM-1", LandNow())
        world.runs(1.0)
        assert ("survey_over", "SIM-1") not in world.fleet.alarms()

    def test_one_taken_from_guidance_during_a_step_flies_when_it_is_given_back(self) -> None:
        world = surveyed_world()
        world.asks()
        world.starts("SIM-1")
        station, (job,) = advance(world.driver.station, world.driver.now_ns)
        assert isinstance(job, Job)
        result = step_survey(job.input)
        assert len(result.missions) == 1
        world.driver.station = station
        world.driver.handle(AuthorityTaken("SIM-1", AuthorityHolder.OPERATOR, "bob"))
        world.driver.handle(JobDone(job.id, STEP_SURVEY, result))
        world.runs(5.0)
        assert world.phase() is SurveyPhase.RUNNING
        world.driver.handle(AuthorityTaken("SIM-1", AuthorityHolder.GUIDANCE, "bob"))
        world.runs(5.0)
        assert world.missions()[-1].times_sent == 1

    def test_a_refused_mission_pauses_the_survey_with_the_reason(self) -> None:
        wires = Zone("wires", ZoneKind.HEIGHT, field(), None, 30.0, HeightDatum.GROUND)
        world = surveyed_world(zones=(wires,))
        world.asks()
        world.starts("SIM-1")
        world.runs(20.0)
        assert world.phase() is SurveyPhase.PAUSED
        assert [each.refusal.rule for each in world.missions() if each.refusal] == ["height_zones"]
        assert "every mission was refused; SIM-1: " in world.state().reason
        assert world.holder("SIM-1") is AuthorityHolder.OPERATOR
        assert ("survey", None) in world.fleet.alarms()

    def test_a_field_far_from_home_is_refused_by_the_fences_not_flown(self) -> None:
        world = surveyed_world()
        world.asks(asked(field(west_m=1_100.0)))
        world.starts("SIM-1")
        world.runs(10.0)
        assert all(
            each.phase is Phase.REFUSED_BY_STATION and isinstance(each.command.body, FlyMission)
            for each in world.missions()
        )
        assert world.phase() is SurveyPhase.PAUSED

    @pytest.mark.flight
    def test_the_same_run_again_is_the_same(self) -> None:
        def flown() -> list[object]:
            world = two_ends()
            world.asks(asked(field(360.0)))
            world.starts("SIM-1", "SIM-2")
            world.runs(60.0)
            return [
                world.figures(),
                [(e.command.id, e.command.serial, e.history) for e in world.missions()],
            ]

        assert flown() == flown()


def test_a_command_is_for_the_survey_of_its_number() -> None:
    world = surveyed_world()
    world.asks()
    world.starts("SIM-1", number=SURVEY_ID + 1)
    assert world.phase() is SurveyPhase.CREATED


class TestApproach:
    """Pads lie south of the field; a zone limits heights in between."""

    @staticmethod
    def flown(*zones: Zone, count: int = 1) -> SurveyedWorld:
        world = surveyed_world(count, zones=zones)
        world.asks()
        world.starts(*(f"SIM-{number + 1}" for number in range(count)))
        world.runs(12.0)
        return world

    @staticmethod
    def paths_m(world: SurveyedWorld) -> list[float]:
        bodies = [
            each.command.body
            for each in world.missions()
            if each.phase is not Phase.REFUSED_BY_STATION
        ]
        return [body.mission.waypoints[0].height_above_takeoff_m for body in bodies]  # type: ignore[union-attr]

    def test_it_is_flown_at_the_nearest_height_that_the_zones_allow(self) -> None:
        strip = field(400.0, 10.0, west_m=-150.0, south_m=-25.0)
        wires = Zone("wires", ZoneKind.HEIGHT, strip, 52.0, None, HeightDatum.GROUND)
        assert self.paths_m(self.flown()) == [50.0]
        assert self.paths_m(self.flown(wires)) == [60.0]

    def test_no_two_share_a_height_that_a_zone_moves_them_to(self) -> None:
        strip = field(400.0, 10.0, west_m=-150.0, south_m=-25.0)
        wires = Zone("wires", ZoneKind.HEIGHT, strip, 60.0, None, HeightDatum.GROUND)
        heights_m = self.paths_m(self.flown(wires, count=2))
        assert min(heights_m) >= 60.0
        assert len(set(heights_m)) == len(heights_m)

    def test_where_no_height_is_allowed_the_zone_is_named(self) -> None:
        strip = field(400.0, 10.0, west_m=-150.0, south_m=-25.0)
        world = self.flown(Zone("school", ZoneKind.KEEP_OUT, strip))
        assert world.missions()[-1].phase is Phase.REFUSED_BY_STATION
        assert world.phase() is SurveyPhase.PAUSED
        assert "school" in world.state().reason
        assert "no other height of its approach" in world.state().reason
