"""An order is judged again at the moment of sending: the situation may have changed."""

from dataclasses import replace

import pytest
from tests.fleet.reports import core, extended
from tests.safety.cases import STICK, mission
from tests.station.commanded import CommandedStation
from tests.station.station_world import square_mission, world

from recon.model.command import Body, FlyMission, Hover, Phase, Refusal, StartCamera
from recon.model.control import AuthorityHolder, StopLatch
from recon.model.event import CommandDropped
from recon.model.vehicle import FlightMode
from recon.station.control import dispatch
from recon.station.state.station import Station

HOVERING = (core(), extended(mode=FlightMode.GPS_ATTI))
GROUND = (core(flying=False, height_m=0.0), extended(mode=FlightMode.GPS_ATTI))
LATER_NS = 200_000_000


def waiting(body: Body) -> CommandedStation:
    """A vehicle that hovers, and an approved order to it that is not sent."""
    scene = CommandedStation().opens(1, *HOVERING).keeps_receiving(1, *HOVERING).passes(0.5)
    scene.is_stuck = True
    scene.order(body)
    return scene


def objection(scene: CommandedStation, station: Station | None = None) -> Refusal | None:
    """Why the first order may not leave 0.2 s after its approval."""
    now_ns = scene.handed[0].approved_at_ns + LATER_NS
    return dispatch.objection(station or scene.station, scene.handed[0], now_ns)


@pytest.mark.parametrize("body", [Hover(), mission(), STICK])
def test_in_the_same_situation_it_is_sent(body: Body) -> None:
    assert objection(waiting(body)) is None


@pytest.mark.parametrize("body", [mission(), STICK])
def test_a_latch_or_another_holder_keeps_it_back(body: Body) -> None:
    scene = waiting(body)
    latched = replace(scene.station, stop_latch=StopLatch("Ann", 0))
    assert "all stop of Ann" in str(objection(scene, latched))
    held = scene.station.control("A")
    pilots = replace(held.authority, holder=AuthorityHolder.PILOT)
    other = replace(scene.station, controls={"A": replace(held, authority=pilots)})
    assert "controlled by pilot" in str(objection(scene, other))


def test_a_hover_is_not_sent_to_a_vehicle_that_has_landed_meanwhile() -> None:
    scene = waiting(Hover()).keeps_receiving(1, *GROUND).passes(3.0)
    assert "on the ground" in str(objection(scene))


def test_an_order_that_has_ended_never_leaves_even_at_once() -> None:
    scene = waiting(mission())
    scene.order(Hover())
    at_once_ns = scene.handed[0].approved_at_ns
    refusal = dispatch.objection(scene.station, scene.handed[0], at_once_ns)
    assert refusal is not None
    assert "its order has ended" in refusal.reason


def test_what_leaves_within_a_tick_is_not_judged_twice() -> None:
    scene = waiting(mission())
    latched = replace(scene.station, stop_latch=StopLatch("Ann", 0))
    soon_ns = scene.handed[0].approved_at_ns + 50_000_000
    assert dispatch.objection(latched, scene.handed[0], soon_ns) is None


@pytest.mark.parametrize(("body", "is_sent"), [(Hover(), True), (mission(), False)])
def test_a_fault_in_judging_again_holds_back_what_moves_and_no_stop(
    body: Body, is_sent: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> None:
        raise RuntimeError("broken")

    scene = waiting(body)
    monkeypatch.setattr(dispatch, "situation", fails)
    assert (objection(scene) is None) is is_sent


def test_a_stop_that_was_refused_at_its_sending_is_judged_again() -> None:
    scene = waiting(Hover())
    scene.happens(CommandDropped(1, 1, Phase.REFUSED_BY_STATION, "on the ground"))
    assert scene.phase(1) is Phase.QUEUED
    scene.is_stuck = False
    scene.passes(1.0)
    assert scene.phase(1) is not Phase.QUEUED
    assert len(scene.times_s(1)) == 1


def test_a_mission_in_a_queue_is_dropped_when_the_vehicle_has_landed() -> None:
    here = world()
    here.run_for(3.0)
    here.order("SIM-1", StartCamera(1.0))
    order = here.order("SIM-1", FlyMission(square_mission()))
    assert here.record(order).times_sent == 0
    station = here.driver.station
    here.driver.station = replace(station, stop_latch=StopLatch("Ann", 0))
    here.run_for(1.0)
    assert here.record(order).phase is Phase.REFUSED_BY_STATION
    assert here.record(order).times_sent == 0
    refusal = here.record(order).refusal
    assert refusal is not None
    assert refusal.rule == "stop_latch"
