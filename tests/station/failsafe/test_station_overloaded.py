"""Station overloaded or suspended: a steered vehicle is held, others are an alarm."""

from tests.fleet.reports import PLACE, S, core, extended
from tests.station.commanded import CommandedStation
from tests.station.failsafe.reacting import with_cell

from recon.geo.distance import moved_m
from recon.model.command import Body, GoTo, Hover
from recon.model.event import Tick
from recon.model.failsafe_matrix import Activity, FailsafeCondition, FailsafeMatrix, Reaction
from recon.model.vehicle import FlightMode
from recon.safety.failsafe import DEFAULT_MATRIX

RULE = "station_overloaded"
STANDING = core(), extended()
STICKS = core(), extended(mode=FlightMode.JOYSTICK)
MISSION = core(), extended(mode=FlightMode.GPS_WAYPOINT)


def steered() -> CommandedStation:
    scene = CommandedStation(DEFAULT_MATRIX).opens(1, *STANDING)
    scene.keeps_receiving(1, *STANDING).passes(1.0)
    scene.order(GoTo(moved_m(PLACE, 200.0, 0.0), 40.0, 5.0))
    return scene.keeps_receiving(1, *STICKS).passes(1.0)


def comes_late(scene: CommandedStation, seconds: float) -> CommandedStation:
    """The next tick comes so late; telemetry that waited in the socket comes first."""
    scene.now_ns += round(seconds * S)
    for link_id, reports in scene.talk.items():
        scene.receives(link_id, *reports)
    return scene.happens(Tick())


def held_by(scene: CommandedStation) -> list[str]:
    orders = (approved.command for approved in scene.handed)
    return [one.issued_by for one in orders if isinstance(one.body, Hover)]


def test_two_late_steps_within_10_s_hold_what_is_steered() -> None:
    scene = steered()
    comes_late(scene, 0.7).passes(2.0)
    assert held_by(scene) == []
    assert RULE not in scene.alarms()
    comes_late(scene, 0.7)
    assert held_by(scene) == ["station: station overloaded"]
    assert RULE in scene.alarms()


def test_late_steps_far_apart_are_no_overload() -> None:
    scene = steered()
    comes_late(scene, 0.7).passes(10.5)
    comes_late(scene, 0.7).passes(0.3)
    assert "station: station overloaded" not in held_by(scene)
    assert RULE not in scene.alarms()


def test_a_gap_of_a_second_counts_by_itself_and_its_alarm_ends() -> None:
    scene = steered()
    comes_late(scene, 1.2)
    assert held_by(scene) == ["station: station overloaded"]
    scene.keeps_receiving(1, *STANDING).passes(4.5)
    assert RULE in scene.alarms()
    scene.passes(1.5)
    assert RULE not in scene.alarms()


def in_mission(matrix: FailsafeMatrix) -> set[Body]:
    scene = CommandedStation(matrix).opens(1, *MISSION).keeps_receiving(1, *MISSION).passes(1.0)
    comes_late(scene, 1.5).passes(1.0)
    assert RULE in scene.alarms()
    return set(scene.bodies())


def test_a_mission_is_an_alarm_unless_the_site_says_otherwise() -> None:
    assert in_mission(DEFAULT_MATRIX) == set()
    overloaded = FailsafeCondition.STATION_OVERLOADED
    matrix = with_cell(overloaded, Activity.MISSION, Reaction.HOLD)
    assert in_mission(matrix) == {Hover()}
