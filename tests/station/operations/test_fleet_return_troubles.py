"""Failures of a fleet return: the vehicle is excluded or released, with a reason."""

from dataclasses import replace

import pytest
from tests.fleet.reports import core, extended
from tests.safety.cases import PLACE, vehicle
from tests.station.commanded import CommandedStation
from tests.station.returning_world import ReturningWorld, returning_world
from tests.station.station_world import square_mission

from recon.fleet.state import Fleet
from recon.geo import point_from_enu
from recon.model.airspace import Airspace, LandingPad
from recon.model.command import FlyMission, Hover, Phase, issued_by_station
from recon.model.event import FleetReturnOrdered, OperatorOrder
from recon.model.geo import GeoPoint, LatLon, LocalFrame
from recon.model.vehicle import VehicleProfile
from recon.safety import OPEN_AIRSPACE, PreparedAirspace
from recon.station.operations.fleet_return import planning
from recon.station.operations.fleet_return.planning import PLAN_RETURN
from recon.station.state.fleet_return_record import Stage
from recon.station.state.station import Station
from recon.station.state.steps import JobDropped, JobFailed

ONE = [(0, 100, 30)]
TWO = [(0, 100, 30), (60, 100, 40)]
ONE_PAD = [(0, -20), (0, -20)]


def reason(world: ReturningWorld, serial: str) -> str:
    member = world.member(serial)
    assert member.stage is Stage.EXCLUDED
    assert ("fleet_return", serial) in world.alarms()
    return member.reason


class TestBeforeItsTurn:
    def test_one_that_does_not_stop(self) -> None:
        world = returning_world(ONE, [(0, 0)], faults=("ack-then-nothing:SIM-1:14",))
        world.world.order("SIM-1", FlyMission(square_mission(30.0, 250.0)))
        world.runs(14.0)
        world.call("SIM-1")
        world.runs(14.0)
        assert "did not stop within 12 s" in reason(world, "SIM-1")

    def test_one_whose_telemetry_is_lost_while_it_waits(self) -> None:
        world = returning_world(TWO, ONE_PAD, faults=("telemetry-dropout:*:15:6",))
        world.call("SIM-1", "SIM-2")
        world.runs(10.0)
        (waiting,) = [m.serial for m in map(world.member, world.pads_m) if m.mission_id is None]
        world.runs(6.5)
        assert "no telemetry for 3 s" in reason(world, waiting)

    def test_one_that_is_moved_while_it_waits(self) -> None:
        """By its pilot in position mode: no mode tells of it."""
        world = returning_world(TWO, ONE_PAD)
        world.call("SIM-1", "SIM-2")
        world.runs(10.0)
        (waiting,) = [m.serial for m in map(world.member, world.pads_m) if m.mission_id is None]
        world.put(waiting, (150.0, 180.0, 55.0))
        assert world.runs_until_over(300.0)
        assert "moved while it waited" in reason(world, waiting)

    def test_one_that_lands_by_itself(self) -> None:
        world = returning_world([(0, 100, 9), (60, 100, 9)], ONE_PAD)
        world.call("SIM-1", "SIM-2")
        world.runs(10.0)
        (waiting,) = [m.serial for m in map(world.member, world.pads_m) if m.mission_id is None]
        world.world.app(waiting).aircraft.land()
        assert world.runs_until_over(300.0)
        assert world.member(waiting).stage is Stage.LANDED

    def test_a_watchdogs_hold_of_one_that_hovers_anyway_changes_nothing(self) -> None:
        world = returning_world(TWO, ONE_PAD)
        world.call("SIM-1", "SIM-2")
        world.runs(10.0)
        (waiting,) = [m.serial for m in map(world.member, world.pads_m) if m.mission_id is None]
        held = OperatorOrder(-999, Hover(), issued_by_station("separation"), waiting)
        world.world.driver.handle(held)
        assert world.runs_until_over(300.0)
        assert set(world.stages().values()) == {Stage.LANDED}

    def test_one_with_an_unknown_takeoff_point(self) -> None:
        world = returning_world(ONE, [(0, 0)], knows_pads=False)
        world.call("SIM-1")
        world.runs(5.0)
        assert "give it a pad in the site's file" in reason(world, "SIM-1")


class TestItsFlight:
    def test_a_watchdogs_hold_ends_it(self) -> None:
        world = returning_world(ONE, [(0, 0)])
        world.call("SIM-1")
        world.runs(10.0)
        held = OperatorOrder(-999, Hover(), issued_by_station("separation"), "SIM-1")
        world.world.driver.handle(held)
        world.runs(1.0)
        assert "replaced by hover, ordered by station: separation" in reason(world, "SIM-1")

    def test_one_that_stops_on_its_way_gets_no_more_orders(self) -> None:
        world = returning_world(ONE, [(0, 0)])
        world.call("SIM-1")
        world.runs(12.0)
        before = len(world.world.driver.station.orders.records)
        world.world.app("SIM-1").aircraft.hover()
        assert world.runs_until_over(60.0)
        assert world.member("SIM-1").stage in (Stage.RELEASED, Stage.EXCLUDED)
        assert world.member("SIM-1").reason
        assert len(world.world.driver.station.orders.records) == before

    def test_one_that_the_gate_refuses(self) -> None:
        world = returning_world(ONE, [(0, 0)], endurance_s=None)
        world.call("SIM-1")
        world.runs(5.0)
        assert "its mission refused by station" in reason(world, "SIM-1")
        assert "endurance" in reason(world, "SIM-1")


class TestThePlan:
    def test_a_worker_that_cannot_plan(self) -> None:
        world = returning_world(ONE, [(0, 0)], plans=False)
        world.call("SIM-1")
        world.runs(5.0)
        assert "could not be planned: this driver runs no jobs" in reason(world, "SIM-1")

    def test_a_worker_that_takes_too_long(self) -> None:
        world = returning_world(ONE, [(0, 0)], plan_takes_s=30.0)
        world.call("SIM-1")
        world.runs(24.0)
        assert "not planned within 20 s" in reason(world, "SIM-1")
        world.runs(20.0)
        assert world.member("SIM-1").stage is Stage.EXCLUDED

    def test_a_plan_that_is_dropped_is_asked_for_again(self) -> None:
        world = returning_world(ONE, [(0, 0)], plan_takes_s=5.0)
        world.call("SIM-1")
        world.runs(2.0)
        running = world.world.driver.station.fleet_return
        assert running is not None
        asked_ns = running.planning_since_ns
        assert asked_ns is not None
        world.world.driver.handle(JobDropped(asked_ns + 1, PLAN_RETURN))
        assert world.world.driver.station.fleet_return == running
        world.world.driver.handle(JobDropped(asked_ns, PLAN_RETURN))
        world.runs(1.0)
        again = world.world.driver.station.fleet_return
        assert again is not None
        assert again.planning_since_ns is not None
        assert again.planning_since_ns > asked_ns
        assert world.runs_until_over(200.0)
        assert world.member("SIM-1").stage is Stage.LANDED

    def test_a_plan_too_late_for_a_vehicle_stopped_meanwhile(self) -> None:
        world = returning_world(TWO, [(0, 0), (60, 0)], plan_takes_s=4.0)
        world.call("SIM-1", "SIM-2")
        world.runs(3.0)
        world.world.order("SIM-1", Hover())
        assert world.runs_until_over(200.0)
        assert world.stages() == {"SIM-1": Stage.RELEASED, "SIM-2": Stage.LANDED}

    def test_the_end_of_an_unknown_job_changes_nothing(self) -> None:
        scene = CommandedStation()
        scene.happens(JobFailed(5, PLAN_RETURN, "late"))
        assert scene.station.fleet_return is None


def test_a_vehicle_without_a_position_is_refused_without_a_site() -> None:
    scene = CommandedStation()
    scene.station = replace(scene.station, airspace=OPEN_AIRSPACE)
    scene.opens(1, extended("A"), core(position=None))
    scene.happens(FleetReturnOrdered(1, ("A",), "test"))
    assert scene.phase(1) is Phase.REFUSED_BY_STATION
    assert "no position received" in scene.record(1).note
    assert scene.station.fleet_return is None


@pytest.mark.parametrize(
    ("layer", "profile", "name"),
    [(True, True, "north"), (False, True, "of its own"), (False, False, "at its takeoff point")],
)
def test_where_it_lands(layer: bool, profile: bool, name: str) -> None:
    """Its pad of the site's layer; else that of its profile; else where it took off."""
    frame = LocalFrame(GeoPoint(PLACE.latitude_deg, PLACE.longitude_deg, 270.0))
    first = point_from_enu(frame, (30.0, 0.0, 2.0))
    second = point_from_enu(frame, (0.0, 40.0, 3.0))
    pads = (LandingPad("north", "A", first),) if layer else ()
    state = vehicle(
        VehicleProfile("A", pad=second if profile else None),
        takeoff_point=LatLon(PLACE.latitude_deg, PLACE.longitude_deg),
    )
    airspace = PreparedAirspace(Airspace(frame=frame, landing_pads=pads))
    station = Station(fleet=Fleet(vehicles={"A": state}), airspace=airspace)
    found = planning.returning(station, "A", frame)
    assert not isinstance(found, str)
    wanted_m = {"north": (30.0, 0.0, 2.0), "of its own": (0.0, 40.0, 3.0)}.get(name, (0.0,) * 3)
    assert found.pad.name == name
    assert (found.pad.east_m, found.pad.north_m, found.pad.up_m) == pytest.approx(
        wanted_m, abs=0.01
    )
