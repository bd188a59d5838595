"""Two missions ordered at once are separated before telemetry shows either vehicle flying."""

from tests.fleet.reports import PLACE, core, extended
from tests.station.commanded import CommandedStation

from recon.geo.distance import moved_m
from recon.model.command import FlyMission, Phase
from recon.model.mission import Mission, Waypoint


def over_the_field(north_m: float, start_east_m: float) -> FlyMission:
    """Straight up from a pad and then 80 m along a line east at this distance north."""
    places = ((0.0, start_east_m), (north_m, 0.0), (north_m, 80.0))
    points = (moved_m(PLACE, north, east) for north, east in places)
    return FlyMission(
        Mission(tuple(Waypoint(p.latitude_deg, p.longitude_deg, 30.0, 5.0) for p in points))
    )


def two_on_the_ground() -> CommandedStation:
    """A stands at the place and B 40 m east of it."""
    scene = CommandedStation()
    for link_id, serial, east_m in ((1, "A", 0.0), (2, "B", 40.0)):
        on_ground = core(flying=False, height_m=0.0, position=moved_m(PLACE, 0.0, east_m))
        reports = (on_ground, extended(serial, gnss_level=5))
        scene.opens(link_id, *reports).keeps_receiving(link_id, *reports)
    return scene.passes(1.0)


def refused(scene: CommandedStation, order: int) -> bool:
    record = scene.record(order)
    is_refused = record.phase is Phase.REFUSED_BY_STATION
    assert not is_refused or scene.refusal_rule(order) == "separation"
    return is_refused


def test_a_queued_mission_counts() -> None:
    scene = two_on_the_ground()
    scene.is_stuck = True
    assert not refused(scene, scene.order(over_the_field(20.0, 0.0), "A", takeoff=True))
    assert refused(scene, scene.order(over_the_field(20.0, 40.0), "B", takeoff=True))
    assert not refused(scene, scene.order(over_the_field(-60.0, 40.0), "B", takeoff=True))


def test_a_sent_mission_counts_while_its_vehicle_may_be_taking_off() -> None:
    scene = two_on_the_ground()
    assert not refused(scene, scene.order(over_the_field(20.0, 0.0), "A", takeoff=True))
    scene.passes(3.0)
    assert refused(scene, scene.order(over_the_field(20.0, 40.0), "B", takeoff=True))
    scene.passes(10.0)
    assert not refused(scene, scene.order(over_the_field(20.0, 40.0), "B", takeoff=True))


def test_a_vehicles_earlier_mission_is_no_traffic_to_itself() -> None:
    scene = two_on_the_ground()
    for _ in range(2):
        assert not refused(scene, scene.order(over_the_field(20.0, 0.0), "A", takeoff=True))
