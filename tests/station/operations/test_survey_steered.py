"""Vehicles whose aircraft take no missions fly a survey: the station steers them on their rows."""

import pytest
from tests.station.operations.test_survey_return_to_home import runs_until_home
from tests.station.surveyed_world import SurveyedWorld, asked, field, surveyed_world

from recon.model.app_report import AppFacts
from recon.model.command import FlyMission, FollowPath, Hover, LandNow, Phase
from recon.model.control import Commanded
from recon.model.event import OperatorOrder
from recon.model.survey import SurveyPhase
from recon.model.units import Stamped
from recon.model.vehicle import VehicleProfile, VehicleState
from recon.station.state.fleet_return_record import Stage
from recon.station.state.orders import OrderRecord

NO_MISSIONS = {"takes_missions": False}


def bodies(world: SurveyedWorld, serial: str) -> list[type]:
    orders = world.driver.station.orders.records.values()
    return [type(each.command.body) for each in orders if each.command.serial == serial]


def newest_path(world: SurveyedWorld, serial: str = "SIM-1") -> OrderRecord:
    orders: list[OrderRecord] = list(world.driver.station.orders.records.values())
    is_path = (each for each in reversed(orders) if isinstance(each.command.body, FollowPath))
    return next(each for each in is_path if each.command.serial == serial)


@pytest.mark.flight
def test_they_take_off_fly_their_rows_come_home_and_land_without_a_mission() -> None:
    world = surveyed_world(2, height_m=0.0, **NO_MISSIONS)
    world.asks(asked(field(160.0)))
    world.starts("SIM-1", "SIM-2", takeoff=True)
    assert world.runs_until(SurveyPhase.DONE, 300.0), world.record()
    assert world.figures().reached_m2 == world.figures().sun_unknown_m2
    assert runs_until_home(world, ("SIM-1", "SIM-2"), 200.0), world.fleet.stages()
    assert set(world.fleet.stages().values()) == {Stage.LANDED}
    assert world.fleet.nearest.level_m >= 15.0
    for serial in ("SIM-1", "SIM-2"):
        flown = bodies(world, serial)
        assert flown[:2] == [Hover, FollowPath]
        assert flown[-2:] == [FollowPath, LandNow]
        assert FlyMission not in flown


@pytest.fixture
def on_its_rows() -> SurveyedWorld:
    """One flies its first rows."""
    world = surveyed_world(1, **NO_MISSIONS)
    world.asks(asked(field(160.0)))
    world.starts("SIM-1")
    world.runs(25.0)
    intent = world.driver.station.control("SIM-1").intent
    assert (intent.commanded, intent.passed >= 2) == (Commanded.STICK, True)
    assert newest_path(world).phase is Phase.STARTED
    return world


def test_a_hold_stops_it_and_nothing_flies_it_on(on_its_rows: SurveyedWorld) -> None:
    world = on_its_rows
    world.driver.handle(OperatorOrder(900, Hover(), "bob", serial="SIM-1"))
    world.runs(5.0)
    here = world.fleet.place_m("SIM-1")
    world.runs(10.0)
    assert newest_path(world).phase is Phase.SUPERSEDED
    assert world.fleet.place_m("SIM-1") == pytest.approx(here, abs=1.0)
    why = "mission stopped: hover, ordered by bob"
    assert world.record().members["SIM-1"].stop_reason == why


def test_the_whole_path_ahead_is_known_to_others(on_its_rows: SurveyedWorld) -> None:
    intent = on_its_rows.driver.station.control("SIM-1").intent
    body = newest_path(on_its_rows).command.body
    assert isinstance(body, FollowPath)
    assert intent.mission == body.mission


@pytest.mark.parametrize(
    ("told", "most", "flies"),
    [(None, 99, True), (None, 0, False), (True, 0, True), (False, 99, False)],
)
def test_what_the_app_tells_counts_before_the_profile(
    told: bool | None, most: int, flies: bool
) -> None:
    vehicle = VehicleState(
        "A",
        profile=VehicleProfile("A", max_waypoints=most),
        app_facts=Stamped(AppFacts(can_fly_missions=told), 1),
    )
    assert vehicle.flies_missions is flies
