"""An order that is answered late shows a slow link: the only sign of it in the protocol."""

import pytest
from tests.fleet.reports import core, extended
from tests.station.commanded import CommandedStation, flying

from recon.model.command import Hover, StartCamera
from recon.model.vehicle import FlightMode

GROUND = (core(flying=False, height_m=0.0), extended(mode=FlightMode.GPS_ATTI))


def answered_after(seconds: float, positive: bool | None = True) -> CommandedStation:
    scene = flying()
    order = scene.order(StartCamera(1.0))
    return scene.passes(seconds).answered(order, positive).passes(0.1)


def test_an_answer_within_a_second_is_none() -> None:
    assert "latency" not in answered_after(0.9).alarms()


@pytest.mark.parametrize("positive", [True, False])
def test_a_late_answer_is_an_alarm_with_its_time(positive: bool) -> None:
    scene = answered_after(1.4, positive)
    (text,) = [
        alarm.condition.text
        for alarm in scene.station.alarms.alarms.values()
        if alarm.condition.rule == "latency"
    ]
    assert "answered an order after 1.4 s" in text


def test_an_answer_that_never_came_shows_no_time() -> None:
    assert "latency" not in answered_after(2.5, None).alarms()


def test_the_answer_to_a_repeated_stop_shows_none_either() -> None:
    scene = flying()
    order = scene.order(Hover())
    scene.passes(1.4).answered(order, True).passes(0.1)
    assert len(scene.times_s(order)) > 1
    assert "latency" not in scene.alarms()


def test_on_the_ground_it_does_not_matter() -> None:
    scene = CommandedStation().opens(1, *GROUND).keeps_receiving(1, *GROUND).passes(0.5)
    order = scene.order(StartCamera(1.0))
    assert "latency" not in scene.passes(1.4).answered(order, True).passes(0.1).alarms()
