"""A failure that an app reports is noted at its order, with DJI's code."""

from dataclasses import replace

from tests.station.returning_world import ReturningWorld, returning_world

from recon.model.app_report import AppAction, OutcomeReport
from recon.model.command import FlyMission, Phase
from recon.model.event import OperatorOrder, PacketReceived
from recon.model.mission import Mission, Waypoint
from recon.station.control.app_outcomes import MOST_CHANGES

FAILED = OutcomeReport(AppAction.MISSION_UPLOAD, False, "-10", "Mission upload failed.")


def ordered() -> ReturningWorld:
    world = returning_world([(0.0, 0.0, 40.0)], [(0.0, -40.0)], faults=("ignored-missions:SIM-1",))
    driver = world.world.driver
    here = driver.station.fleet.vehicles["SIM-1"].position.value
    assert here is not None
    places = [waypoint(here.latitude_deg + 0.0002 * k, here.longitude_deg) for k in (1, 2)]
    driver.handle(OperatorOrder(500, FlyMission(Mission(tuple(places))), "ann", serial="SIM-1"))
    world.runs(1.0)
    return world


def waypoint(latitude_deg: float, longitude_deg: float) -> Waypoint:
    return Waypoint(latitude_deg, longitude_deg, 40.0, 5.0)


def reports(world: ReturningWorld, report: OutcomeReport) -> None:
    driver = world.world.driver
    link_id = driver.station.fleet.vehicles["SIM-1"].link_id
    assert link_id is not None
    driver.handle(PacketReceived(link_id, report))


def test_a_failed_upload_is_noted_once_and_ends_nothing() -> None:
    world = ordered()
    for _ in range(3):
        reports(world, FAILED)
    record = world.world.driver.station.orders.records[500]
    assert record.phase is Phase.ACKNOWLEDGED
    assert record.note == "its app: Mission upload failed. (DJI's code -10)"
    assert [change.phase for change in record.history].count(Phase.ACKNOWLEDGED) == 2


def test_successes_and_other_actions_are_not_noted() -> None:
    world = ordered()
    before = world.world.driver.station.orders.records[500]
    reports(world, replace(FAILED, ok=True))
    reports(world, replace(FAILED, action=AppAction.HOVER))
    assert world.world.driver.station.orders.records[500] == before


def test_any_number_of_outcomes_leaves_a_bounded_history() -> None:
    world = ordered()
    for number in range(60):
        reports(world, replace(FAILED, code=str(number), text=None))
    record = world.world.driver.station.orders.records[500]
    assert len(record.history) == MOST_CHANGES
    assert "mission upload failed (DJI's code" in record.note
