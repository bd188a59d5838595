"""What a vehicle does on the station's word follows what was sent, and what telemetry shows."""

import pytest
from tests.safety.cases import STICK, mission
from tests.station.commanded import CommandedStation
from tests.station.flown import GPS, at, flies, hovering, ordered, row, under_way

from recon.model.command import Body, FlyMission, Hover, LandNow, Phase, ReturnHome, StartCamera
from recon.model.control import Commanded, Intent
from recon.model.vehicle import FlightMode


def intent(scene: CommandedStation) -> Intent:
    return scene.station.control("A").intent


def test_nothing_is_commanded_before_the_first_order() -> None:
    assert intent(hovering()).commanded is Commanded.NOTHING


@pytest.mark.parametrize(
    ("body", "commanded"),
    [
        (Hover(), Commanded.HOLD),
        (LandNow(), Commanded.LAND),
        (ReturnHome(), Commanded.RETURN),
        (mission(), Commanded.MISSION),
        (STICK, Commanded.STICK),
        (StartCamera(1.0), Commanded.NOTHING),
    ],
)
def test_the_intent_is_the_order_that_was_sent(body: Body, commanded: Commanded) -> None:
    scene, order = ordered(body)
    assert intent(scene).commanded is commanded
    assert intent(scene).command_id == (None if commanded is Commanded.NOTHING else order)
    if isinstance(body, FlyMission):
        assert intent(scene).mission == body.mission


def test_an_unsent_order_is_no_intent() -> None:
    scene = hovering()
    scene.is_stuck = True
    scene.order(mission())
    assert intent(scene).commanded is Commanded.NOTHING


def test_a_refused_order_is_no_intent() -> None:
    scene = hovering()
    scene.order(mission(*mission().mission.waypoints[:1]))
    assert intent(scene).commanded is Commanded.NOTHING


def test_passed_waypoints_are_counted_from_telemetry_and_never_back() -> None:
    scene, _ = ordered(row(6))
    counts = []
    for north_m in (0.0, 5.0, 10.0, 22.0, 18.0, 35.0, 50.0):
        flies(scene, north_m)
        counts.append(intent(scene).passed)
    assert counts == [1, 1, 2, 3, 3, 4, 6]


def test_before_it_has_started_nothing_is_passed() -> None:
    scene, _ = ordered(row(6))
    scene.keeps_receiving(1, *at(20.0, GPS)).passes(2.0)
    assert intent(scene).passed == 0


@pytest.mark.parametrize("body", [mission(), STICK, Hover()])
def test_a_failed_order_is_no_longer_the_intent(body: Body) -> None:
    scene, order = ordered(body)
    reports = at(0.0, FlightMode.GO_HOME, velocity=(5.0, 0.0, 0.0))
    scene.keeps_receiving(1, *reports).passes(12.0)
    assert scene.phase(order) in (Phase.TIMED_OUT, Phase.FAILED)
    assert intent(scene).commanded is Commanded.NOTHING


def test_after_a_mission_it_holds_where_it_ended() -> None:
    scene, _ = under_way()
    flies(scene, 40.0, 50.0).keeps_receiving(1, *at(50.0, GPS)).passes(0.3)
    held = intent(scene)
    assert held.commanded is Commanded.HOLD
    assert held.target == scene.station.fleet.vehicles["A"].position.value


@pytest.mark.parametrize("body", [Hover(), LandNow(), ReturnHome()])
def test_after_a_landing_nothing_is_commanded(body: Body) -> None:
    scene, _ = ordered(body)
    scene.passes(1.0).lands(1, *at(0.0, GPS, flying=False)).passes(1.5)
    assert intent(scene).commanded is Commanded.NOTHING


def test_a_mission_from_the_ground_is_the_intent_during_takeoff() -> None:
    reports = at(0.0, GPS, flying=False, height_m=0.0)
    scene = CommandedStation().opens(1, *reports).keeps_receiving(1, *reports).passes(0.5)
    order = scene.order(mission(), takeoff=True)
    scene.passes(1.0)
    assert intent(scene).commanded is Commanded.MISSION
    scene.keeps_receiving(1, *at(0.0, FlightMode.AUTO_TAKEOFF, flying=False)).passes(9.0)
    assert scene.phase(order) is Phase.SENT
    flies(scene, 0.0)
    assert scene.phase(order) is Phase.STARTED
