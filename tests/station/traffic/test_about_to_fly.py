"""Two missions ordered at once are separated before telemetry shows either vehicle flying."""

from dataclasses import replace

from tests.fleet.reports import PLACE, core, extended
from tests.station.commanded import CommandedStation

from recon.geo.distance import moved_m
from recon.model.command import FlyMission, Hover, Phase
from recon.model.event import CommandSent
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


def test_a_takeoff_into_a_hover_counts_while_it_is_queued_and_while_it_may_happen() -> None:
    scene = two_on_the_ground()
    scene.is_stuck = True
    over_a = over_the_field(0.0, 40.0)
    assert not refused(scene, scene.order(over_a, "B", takeoff=True))
    takeoff = scene.order(Hover(), "A", takeoff=True)
    assert refused(scene, takeoff)  # B's waits, and comes over A


def test_a_mission_past_a_vehicle_that_takes_off_into_a_hover_is_refused() -> None:
    scene = two_on_the_ground()
    low = over_the_field(0.0, 40.0)
    low = FlyMission(
        Mission(tuple(replace(p, height_above_takeoff_m=5.0) for p in low.mission.waypoints))
    )
    scene.is_stuck = True
    takeoff = scene.order(Hover(), "A", takeoff=True)
    assert refused(scene, scene.order(low, "B", takeoff=True))
    scene.is_stuck = False
    scene.happens(CommandSent(1, takeoff)).passes(3.0)
    assert refused(scene, scene.order(low, "B", takeoff=True))
    scene.passes(10.0)
    assert not refused(scene, scene.order(low, "B", takeoff=True))
