"""A return home states how high the vehicle climbs first."""

from dataclasses import replace

from tests.fleet.reports import core, extended
from tests.station.commanded import PROFILES, CommandedStation

from recon.fleet.state import Fleet
from recon.model.command import Hover, ReturnHome


def commanded_with(go_home_height_m: float | None) -> CommandedStation:
    scene = CommandedStation()
    profile = replace(PROFILES["A"], go_home_height_m=go_home_height_m)
    scene.station = replace(scene.station, fleet=Fleet(profiles={"A": profile}))
    return (
        scene.opens(1, core(), extended("A")).keeps_receiving(1, core(), extended("A")).passes(0.5)
    )


def test_the_note_has_the_height_of_the_sites_file() -> None:
    scene = commanded_with(48.0)
    note = scene.record(scene.order(ReturnHome())).history[0].note
    assert "48 m above its takeoff point" in note


def test_the_note_states_that_the_height_is_unknown() -> None:
    scene = commanded_with(None)
    note = scene.record(scene.order(ReturnHome())).history[0].note
    assert "go-home height, unknown here" in note


def test_other_orders_say_nothing_of_it() -> None:
    scene = commanded_with(48.0)
    assert scene.record(scene.order(Hover())).history[0].note == ""
