"""Imaging drone lost in flight: one alarm for the others; a site may hold them."""

from tests.fleet.reports import PLACE, core, extended
from tests.station.commanded import CommandedStation
from tests.station.failsafe.reacting import with_cell
from tests.station.imagers import with_imagers

from recon.geo.distance import moved_m
from recon.model.command import Hover
from recon.model.failsafe_matrix import Activity, FailsafeCondition, FailsafeMatrix, Reaction
from recon.model.vehicle import FlightMode
from recon.safety.failsafe import DEFAULT_MATRIX

RULE = "imaging_drone_lost"
MISSION = core(), extended("A", mode=FlightMode.GPS_WAYPOINT)
FAR = moved_m(PLACE, 600.0, 0.0)
IMAGER = core(position=FAR), extended("B")
OTHER = core(position=moved_m(PLACE, -600.0, 0.0)), extended("C")
LANDED = core(position=FAR, flying=False, height_m=0.0), extended("B")


def with_imager(matrix: FailsafeMatrix = DEFAULT_MATRIX) -> CommandedStation:
    """A flies a mission; B, far away, is the imaging drone."""
    scene = CommandedStation(matrix).opens(1, *MISSION).opens(2, *IMAGER)
    scene.keeps_receiving(1, *MISSION).keeps_receiving(2, *IMAGER)
    scene.station = with_imagers(scene.station, "B", "C")
    return scene.passes(2.0)


def text_of(scene: CommandedStation) -> str:
    alarms = scene.station.alarms.alarms.values()
    (found,) = (alarm for alarm in alarms if alarm.condition.rule == RULE)
    return found.condition.text


def test_it_is_an_alarm_and_the_others_fly_on() -> None:
    scene = with_imager()
    del scene.talk[2]
    scene.passes(2.8)
    assert RULE not in scene.alarms()
    scene.passes(0.5)
    assert "the imaging drone B is lost in flight" in text_of(scene)
    scene.passes(60.0)
    assert scene.handed == []
    scene.keeps_receiving(2, *IMAGER).passes(0.3)
    assert RULE not in scene.alarms()


def test_several_that_are_lost_are_all_named() -> None:
    scene = CommandedStation().opens(1, *MISSION).opens(2, *IMAGER).opens(3, *OTHER)
    scene.keeps_receiving(1, *MISSION).keeps_receiving(2, *IMAGER).keeps_receiving(3, *OTHER)
    scene.station = with_imagers(scene.station, "B", "C")
    scene.passes(2.0)
    del scene.talk[2]
    scene.passes(3.5)
    assert "the imaging drone B is lost in flight" in text_of(scene)
    del scene.talk[3]
    scene.passes(3.5)
    assert "the imaging drones B, C are lost in flight" in text_of(scene)


def test_a_site_may_have_missions_held() -> None:
    scene = with_imager(
        with_cell(FailsafeCondition.IMAGING_DRONE_LOST, Activity.MISSION, Reaction.HOLD, 20.0)
    )
    del scene.talk[2]
    scene.passes(19.5)
    assert scene.handed == []
    assert "A: the station holds it in " in text_of(scene)
    scene.passes(0.8)
    assert scene.bodies() == [Hover()]
    assert scene.handed[0].command.issued_by == "station: imaging drone lost"


def test_on_the_ground_nothing_is_lost() -> None:
    scene = with_imager()
    scene.lands(2, *LANDED)
    del scene.talk[2]
    scene.passes(10.0)
    assert RULE not in scene.alarms()
