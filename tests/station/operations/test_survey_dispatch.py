"""A survey's mission becomes an order, or waits: judged beforehand by the gate's own rules."""

from dataclasses import replace

import pytest
from tests.station.surveyed_world import (
    HEIGHT_M,
    SURVEY_ID,
    SurveyedWorld,
    asked,
    surveyed_world,
)

from recon.api import schema
from recon.geo import geo_from_enu
from recon.guidance.survey import AssignedMission
from recon.model.command import FlyMission
from recon.model.mission import Mission, Waypoint
from recon.model.survey import MissionAssignment, SurveyPhase
from recon.station.api_views.operation_views import survey_views
from recon.station.operations.survey import execution
from recon.station.operations.survey.mission_dispatch import NO_ROOM, Dispatch, dispatch
from recon.station.operations.survey.planning import SurveyStepped
from recon.station.state.station import Station
from recon.station.state.steps import Stepped
from recon.station.state.survey_record import PendingStep


def started(count: int) -> SurveyedWorld:
    """Vehicles that hover at the rows' height south of the field, 40 m apart."""
    world = surveyed_world(count)
    world.asks(asked())
    world.starts(*(f"SIM-{number + 1}" for number in range(count)))
    return world


def rows(world: SurveyedWorld, *places_m: tuple[float, float]) -> MissionAssignment:
    """A mission of SIM-1 along places, in east-north metres."""
    frame = world.driver.station.airspace.airspace.frame
    waypoints = []
    for east_m, north_m in places_m:
        latitude, longitude, _ = geo_from_enu(frame, [(east_m, north_m, 0.0)])
        waypoints.append(Waypoint(float(latitude[0]), float(longitude[0]), HEIGHT_M, 5.0))
    return MissionAssignment("SIM-1", 1, Mission(tuple(waypoints)), 100.0)


def dispatched(world: SurveyedWorld, given: MissionAssignment) -> Dispatch:
    station = world.driver.station
    vehicle = station.fleet.vehicles["SIM-1"]
    return dispatch(station, world.record(), given, vehicle, world.driver.now_ns)


def mission_of(found: Dispatch) -> Mission:
    assert isinstance(found.order.body, FlyMission)
    return found.order.body.mission


FREE = ((0.0, 0.0), (0.0, 60.0))
PAST_THE_OTHER = ((20.0, -40.0), (60.0, -40.0))


class TestStraight:
    def test_near_its_row_it_goes_there_and_stays_at_its_end(self) -> None:
        world = started(2)
        given = replace(rows(world, *FREE), straight_within_m=90.0)
        assert mission_of(dispatched(world, given)) == given.mission

    @pytest.mark.parametrize(("within_m", "stays"), [(None, False), (0.0, True), (30.0, True)])
    def test_farther_off_it_goes_by_its_layer(self, within_m: float | None, stays: bool) -> None:
        world = started(2)
        given = replace(rows(world, *FREE), straight_within_m=within_m)
        flown = mission_of(dispatched(world, given))
        assert flown.waypoints[0].height_above_takeoff_m != HEIGHT_M
        assert (flown.waypoints[-1].height_above_takeoff_m == HEIGHT_M) is stays

    def test_where_the_gate_refuses_that_it_goes_by_its_layer(self) -> None:
        """Straight, it would pass the other vehicle on its way to the row."""
        world = started(2)
        behind = rows(world, (80.0, -40.0), (80.0, 30.0))
        given = replace(behind, straight_within_m=90.0)
        found = dispatched(world, given)
        assert found.in_the_way is None
        assert mission_of(found).waypoints[0].height_above_takeoff_m != HEIGHT_M


class TestInTheWay:
    def test_rows_past_a_hovering_vehicle_are_not_ordered(self) -> None:
        world = started(2)
        found = dispatched(world, rows(world, *PAST_THE_OTHER))
        assert found.in_the_way is not None
        assert found.in_the_way.rule == "separation"
        assert "SIM-2" in found.in_the_way.reason or "Drone 2" in found.in_the_way.reason

    def test_alone_the_same_rows_are(self) -> None:
        world = started(1)
        assert dispatched(world, rows(world, *PAST_THE_OTHER)).in_the_way is None

    def test_one_that_stands_by_goes_no_farther_than_above_its_row(self) -> None:
        world = started(2)
        given = replace(rows(world, (0.0, 60.0)), stands_by=True)
        waypoints = mission_of(dispatched(world, given)).waypoints
        assert len({each.height_above_takeoff_m for each in waypoints} - {HEIGHT_M}) == 1
        assert all(each.height_above_takeoff_m != HEIGHT_M for each in waypoints)

    def test_one_that_waits_among_rows_steps_aside_on_the_spot(self) -> None:
        world = started(2)
        given = replace(rows(world, (0.0, -40.0)), stands_by=True)
        level, aside = mission_of(dispatched(world, given)).waypoints
        assert level.height_above_takeoff_m == pytest.approx(HEIGHT_M)
        assert aside.height_above_takeoff_m != HEIGHT_M
        assert (level.latitude_deg, level.longitude_deg) == (
            aside.latitude_deg,
            aside.longitude_deg,
        )

    def test_without_a_place_to_wait_at_it_stays_with_its_survey(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        world = started(1)
        given = replace(rows(world, (0.0, -40.0)), number=7, stands_by=True)
        held = Dispatch(dispatched(world, given).order, in_the_way=NO_ROOM)
        monkeypatch.setattr(execution, "dispatch", lambda *_: held)
        after, sent = stepped(world, given)
        kept = after.surveys.records[SURVEY_ID].state
        assert sent == ()
        assert kept is not None
        assert (kept.phase, kept.barred) == (SurveyPhase.RUNNING, frozenset())
        assert kept.refusals["SIM-1"].reason.startswith("there is no other height")
        assert shown(after, world).waits_for is None

    def test_one_that_waits_for_another_is_shown_with_its_name(self) -> None:
        world = started(2)
        after, sent = stepped(world, replace(rows(world, *PAST_THE_OTHER), number=7))
        view = shown(after, world)
        assert sent == ()
        assert view.waits_for == world.driver.station.fleet.vehicles["SIM-2"].display_name
        assert "it must keep" in str(view.refused)


def stepped(world: SurveyedWorld, given: MissionAssignment) -> Stepped:
    """A step of the survey that asks for one mission."""
    standing = AssignedMission(given.number, (), ((0.0, -40.0),), 0.0)
    state = replace(world.state(), flights={"SIM-1": standing})
    pending = PendingStep(99, SURVEY_ID, 0, 0, 0)
    station = world.driver.station
    station = replace(station, surveys=replace(station.surveys, pending=pending))
    step = SurveyStepped(state, (given,))
    return execution.STEP_SURVEY.done(station, 99, step, world.driver.now_ns)


def shown(station: Station, world: SurveyedWorld) -> schema.SurveyingView:
    (view,) = survey_views(station, world.driver.now_ns)
    return view.vehicles[0]
