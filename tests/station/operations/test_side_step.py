"""Side-steps that a person orders, in virtual time: simulated apps, the real station and gate."""

from dataclasses import replace
from math import atan2, degrees, hypot

import numpy as np
import pytest
from tests.station.imager_world import IMAGER, ImagerWorld, imager_world
from tests.station.surveyed_world import field

from recon.model.airspace import HeightDatum, Zone, ZoneKind
from recon.model.command import GoTo, Hover, Phase
from recon.model.control import AuthorityHolder
from recon.model.event import (
    AllStopped,
    AuthorityTaken,
    OperatorOrder,
    SideStepOrdered,
)
from recon.model.geo import LatLon
from recon.station.operations.imager_motion.side_step import SIDE_STEP, refusal
from recon.station.state.imager_motion import MotionStage, SideStep
from recon.station.state.imaging import Imaging
from recon.station.state.steps import StepTaken


def under_way(**options: object) -> ImagerWorld:
    """A side-step that has begun 4 s ago."""
    world = imager_world(**options)  # type: ignore[arg-type]
    world.ordered()
    world.surveyed.runs(4.0)
    assert world.newest().stage is MotionStage.ASIDE
    return world


@pytest.fixture(scope="module")
def flown() -> tuple[ImagerWorld, float]:
    """A side-step from its beginning to its end, and how far it led."""
    world = imager_world()
    world.ordered()
    return world, world.farthest_while(40.0)


class TestFlown:
    def test_it_goes_25_m_aside_and_comes_back(self, flown: tuple[ImagerWorld, float]) -> None:
        world, farthest_m = flown
        assert farthest_m == pytest.approx(25.0, abs=2.0)
        assert world.newest().stage is MotionStage.DONE
        assert hypot(*world.off_m()) < 2.0

    def test_both_ways_passed_the_gate_as_guidance(self, flown: tuple[ImagerWorld, float]) -> None:
        records = flown[0].station.orders.records.values()
        paths = [each for each in records if isinstance(each.command.body, GoTo)]
        assert len(paths) == 2
        assert {each.command.role for each in paths} == {AuthorityHolder.GUIDANCE}
        assert all(each.phase in (Phase.DONE, Phase.SUPERSEDED) for each in paths)

    def test_it_ends_with_the_aircrafts_own_hold_and_the_operator(
        self, flown: tuple[ImagerWorld, float]
    ) -> None:
        world, _ = flown
        newest = list(world.station.orders.records.values())[-1]
        assert isinstance(newest.command.body, Hover)
        assert newest.phase is Phase.DONE
        assert world.station.control(IMAGER).stream is None
        assert world.holder() is AuthorityHolder.OPERATOR
        assert world.alarms() == {}

    def test_it_lasts_less_than_half_a_minute(self, flown: tuple[ImagerWorld, float]) -> None:
        newest = flown[0].newest()
        assert (newest.since_ns - newest.begun_at_ns) / 1e9 < 30.0


class TestTheDirection:
    def test_across_the_sun(self) -> None:
        world = imager_world()
        world.ordered()
        azimuth_deg = world.sun_azimuth_deg()
        assert world.newest().bearing_deg == pytest.approx((azimuth_deg + 90.0) % 360.0, abs=0.1)
        world.surveyed.runs(9.0)
        east_m, north_m = world.off_m()
        flown_deg = degrees(atan2(east_m, north_m)) % 360.0
        assert flown_deg == pytest.approx(world.newest().bearing_deg, abs=6.0)

    def test_another_one_beside_a_keep_out_zone(self) -> None:
        first_deg = imager_world().sun_azimuth_deg() + 90.0
        side = np.sign(np.sin(np.radians(first_deg)))
        # A wall 20 m from it on the side that it would choose.
        west_m = 60.0 + (20.0 if side > 0 else -40.0)
        region = field(20.0, 300.0, west_m=west_m, south_m=0.0)
        wall = Zone("wall", ZoneKind.KEEP_OUT, region, 0.0, 200.0, HeightDatum.GROUND)
        world = imager_world(zones=(wall,))
        world.ordered()
        chosen = np.radians(world.newest().bearing_deg)
        assert side * 25.0 * np.sin(chosen) < 20.0
        assert world.farthest_while(40.0) == pytest.approx(25.0, abs=2.0)
        assert world.newest().stage is MotionStage.DONE

    def test_with_no_direction_free_it_is_refused_with_the_gates_reason(self) -> None:
        # Walls all round it, 12 m from its place.
        sides = (
            field(40.0, 10.0, west_m=40.0, south_m=132.0),
            field(40.0, 10.0, west_m=40.0, south_m=98.0),
            field(10.0, 40.0, west_m=38.0, south_m=100.0),
            field(10.0, 40.0, west_m=72.0, south_m=100.0),
        )
        walls = tuple(
            Zone(f"wall {n}", ZoneKind.KEEP_OUT, side, 0.0, 200.0, HeightDatum.GROUND)
            for n, side in enumerate(sides)
        )
        world = imager_world(zones=walls)
        orders = len(world.station.orders.records)
        why = refusal(world.station, SideStepOrdered("ann"), world.surveyed.driver.now_ns)
        world.ordered()
        assert why is not None
        assert "every other direction" in why.reason
        assert world.station.imager_motions.of(SideStep) is None
        assert len(world.station.orders.records) == orders
        assert world.holder() is AuthorityHolder.OPERATOR


class TestRefused:
    def why(self, world: ImagerWorld, person: str = "ann") -> str:
        event = SideStepOrdered(person, person=person)
        why = refusal(world.station, event, world.surveyed.driver.now_ns)
        world.ordered(person)
        assert why is not None
        return why.reason

    def test_without_an_imaging_drone(self) -> None:
        world = imager_world()
        world.station = replace(world.station, imaging=Imaging())
        assert self.why(world) == "the site has no imaging drone"

    def test_of_a_vehicle_that_is_none(self) -> None:
        world = imager_world(1)
        event = SideStepOrdered("ann", person="ann", serial="SIM-2")
        why = refusal(world.station, event, world.surveyed.driver.now_ns)
        assert why is not None
        assert why.reason == "SIM-2 is no imaging drone of the site: expected SIM-1"

    def test_on_the_ground(self) -> None:
        world = imager_world(height_m=0.0)
        world.surveyed.fleet.world.app(IMAGER).aircraft.land()
        world.surveyed.runs(5.0)
        assert "not in the air" in self.why(world)

    def test_while_one_is_under_way(self) -> None:
        assert "side-steps already" in self.why(under_way())

    def test_on_its_way_somewhere(self) -> None:
        world = imager_world()
        there = LatLon(41.9005, -93.6)
        body = GoTo(there, 60.0, 6.0)
        world.surveyed.driver.handle(OperatorOrder(7, body, "ann", serial=IMAGER))
        world.surveyed.runs(4.0)
        assert "hold it first" in self.why(world)
        assert world.station.orders.records[7].phase is Phase.STARTED

    def test_controlled_by_its_pilot(self) -> None:
        world = imager_world()
        taken = AuthorityTaken(IMAGER, AuthorityHolder.PILOT, "bob")
        world.surveyed.driver.handle(taken)
        assert "controlled by the pilot" in self.why(world)
        assert world.holder() is AuthorityHolder.PILOT

    def test_operated_by_another_person(self) -> None:
        world = imager_world()
        taken = AuthorityTaken(IMAGER, AuthorityHolder.OPERATOR, "bob", "bob")
        world.surveyed.driver.handle(taken)
        assert "bob" in self.why(world, "ann")

    def test_held_by_an_all_stop(self) -> None:
        world = imager_world()
        world.surveyed.driver.handle(AllStopped("bob"))
        assert "all stop" in self.why(world)


class TestEndedBefore:
    """Whatever ends it, the vehicle holds and nothing resumes."""

    def stays(self, world: ImagerWorld, why: str) -> None:
        world.surveyed.runs(4.0)
        newest = world.newest()
        assert newest.stage is MotionStage.STOPPED
        assert why in newest.reason
        off_m = world.off_m()
        orders = len(world.station.orders.records)
        world.surveyed.runs(20.0)
        assert hypot(world.off_m()[0] - off_m[0], world.off_m()[1] - off_m[1]) < 1.5
        assert world.newest() is newest
        assert len(world.station.orders.records) == orders
        assert world.station.control(IMAGER).stream is None

    def test_by_a_hold(self) -> None:
        world = under_way()
        hold = OperatorOrder(9, Hover(), "bob", serial=IMAGER, person="bob")
        world.surveyed.driver.handle(hold)
        self.stays(world, "hover, ordered by bob")
        assert world.holder() is AuthorityHolder.OPERATOR
        assert "from its place" in world.alarms()["side_step:stopped"]

    def test_by_an_all_stop(self) -> None:
        world = under_way()
        world.surveyed.driver.handle(AllStopped("bob"))
        hold = OperatorOrder(9, Hover(), "bob", serial=IMAGER, person="bob")
        world.surveyed.driver.handle(hold)
        self.stays(world, "all stop by bob")

    def test_by_its_pilot(self) -> None:
        world = under_way()
        world.surveyed.fleet.world.app(IMAGER).aircraft.pilot_takes()
        self.stays(world, "pilot")
        assert world.holder() is AuthorityHolder.PILOT

    def test_by_control_taken(self) -> None:
        world = under_way()
        taken = AuthorityTaken(IMAGER, AuthorityHolder.OPERATOR, "ann", "ann")
        world.surveyed.driver.handle(taken)
        self.stays(world, "taken over by ann")

    def test_by_a_lost_connection(self) -> None:
        world = under_way()
        connected = world.surveyed.fleet.world.connected[IMAGER]
        world.surveyed.driver.disconnect(connected.link_id)
        world.surveyed.runs(6.0)
        newest = world.newest()
        assert newest.stage is MotionStage.STOPPED
        world.surveyed.fleet.world.connect(connected.app)
        world.surveyed.runs(5.0)  # an app without its station does not move in this world
        off_m = world.off_m()
        world.surveyed.runs(10.0)
        assert world.newest() is newest
        assert hypot(world.off_m()[0] - off_m[0], world.off_m()[1] - off_m[1]) < 1.5

    def test_the_alarm_ends_when_it_is_sent_elsewhere(self) -> None:
        world = under_way()
        hold = OperatorOrder(9, Hover(), "bob", serial=IMAGER)
        world.surveyed.driver.handle(hold)
        world.surveyed.runs(4.0)
        assert "side_step:stopped" in world.alarms()
        body = GoTo(LatLon(41.9015, -93.599), 60.0, 6.0)
        world.surveyed.driver.handle(OperatorOrder(10, body, "ann", serial=IMAGER, person="ann"))
        world.surveyed.runs(1.0)
        assert "side_step:stopped" not in world.alarms()


class TestTheWayBack:
    """Another vehicle has come to hover at its place."""

    @pytest.fixture
    def blocked(self) -> ImagerWorld:
        world = imager_world(1)
        world.ordered()
        world.surveyed.runs(6.0)
        world.surveyed.fleet.put("SIM-2", world.start_m)
        # Put there, not flown: the watchdog would hold both.
        watchdogs = replace(world.station.watchdog_state, is_hold_on=False)
        world.station = replace(world.station, watchdog_state=watchdogs)
        world.surveyed.runs(8.0)
        assert world.newest().stage is MotionStage.WAITING
        return world

    def test_it_waits_beside_its_place_until_that_is_free(self, blocked: ImagerWorld) -> None:
        assert hypot(*blocked.off_m()) == pytest.approx(25.0, abs=2.0)
        assert "must keep" in blocked.alarms()["side_step:waits"]
        blocked.surveyed.fleet.put("SIM-2", (0.0, -40.0, 40.0))
        blocked.surveyed.runs(15.0)
        assert blocked.newest().stage is MotionStage.DONE
        assert hypot(*blocked.off_m()) < 2.0

    def test_after_half_a_minute_it_holds_there(self, blocked: ImagerWorld) -> None:
        blocked.surveyed.runs(32.0)
        newest = blocked.newest()
        assert newest.stage is MotionStage.STOPPED
        assert "refused for 30 s" in newest.reason
        assert blocked.station.control(IMAGER).stream is None
        assert blocked.holder() is AuthorityHolder.OPERATOR
        assert "25 m from its place" in blocked.alarms()["side_step:stopped"]
        assert hypot(*blocked.off_m()) == pytest.approx(25.0, abs=2.0)

    def test_a_lost_connection_meanwhile_ends_it(self, blocked: ImagerWorld) -> None:
        connected = blocked.surveyed.fleet.world.connected[IMAGER]
        blocked.surveyed.driver.disconnect(connected.link_id)
        blocked.surveyed.runs(0.5)
        blocked.surveyed.fleet.put("SIM-2", (0.0, -40.0, 40.0))
        blocked.surveyed.fleet.world.connect(connected.app)
        blocked.surveyed.runs(20.0)
        assert blocked.newest().stage is MotionStage.STOPPED
        assert blocked.holder() is AuthorityHolder.OPERATOR
        assert hypot(*blocked.off_m()) == pytest.approx(25.0, abs=2.0)


def test_each_stage_is_audited() -> None:
    world = imager_world()
    entries: list[tuple[str, str]] = []

    def observe(step: StepTaken) -> None:
        found = SIDE_STEP.audit(step.before, step.event, step.after, step.now_ns)
        entries.extend((each.kind, each.by) for each in found)

    world.surveyed.driver.observe = observe
    world.ordered()
    world.ordered("bob")
    world.surveyed.runs(28.0)
    assert entries == [
        ("side_step.aside", "ann"),
        ("side_step.refused", "bob"),
        ("side_step.back", "ann"),
        ("side_step.done", "ann"),
    ]
