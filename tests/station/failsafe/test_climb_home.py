"""A return that the station gives automatically does not climb into another vehicle."""

import pytest
from tests.fleet.reports import PLACE, core, extended
from tests.station.commanded import CommandedStation

from recon.geo.distance import moved_m
from recon.model.command import Hover, ReturnHome
from recon.safety.failsafe import DEFAULT_MATRIX

AWAY = moved_m(PLACE, 100.0, 0.0)
LOW, CRITICAL = 0.24, 0.09


def at(height_m: float, north_m: float = 0.0) -> object:
    place = moved_m(AWAY, north_m, 0.0)
    return core(position=place, height_m=height_m, altitude_m=260.0 + height_m)


def one_above_the_other(battery: float, above_m: float = 12.0) -> CommandedStation:
    """A hovers at 25 m, goes home at 40 m, and has this battery; B hovers above it."""
    scene = CommandedStation(DEFAULT_MATRIX)
    for link_id, serial, height_m, left in ((1, "A", 25.0, battery), (2, "B", 25.0 + above_m, 0.8)):
        reports = at(height_m), extended(serial, battery=left)
        scene.opens(link_id, *reports).keeps_receiving(link_id, *reports)  # type: ignore[arg-type]
    return scene


def returned(scene: CommandedStation) -> set[str | None]:
    return {a.command.serial for a in scene.handed if isinstance(a.command.body, ReturnHome)}


def words(scene: CommandedStation) -> str:
    book = scene.station.alarms.alarms.values()
    return " ".join(a.condition.text for a in book if a.condition.rule == "battery" and a.is_active)


def test_it_waits_under_another_one_and_says_why() -> None:
    scene = one_above_the_other(LOW).passes(60.0)
    assert returned(scene) == set()
    assert "could not be ordered to return (B is in the way of its climb" in words(scene)


def test_it_goes_when_the_other_has_left() -> None:
    scene = one_above_the_other(LOW).passes(30.0)
    for metres in range(2, 60, 2):  # at 10 m/s, and then it stands
        aside = core(
            position=moved_m(AWAY, metres, 0.0),
            height_m=37.0,
            altitude_m=297.0,
            velocity=(10.0 if metres < 58 else 0.0, 0.0, 0.0),
        )
        scene.keeps_receiving(2, aside, extended("B")).passes(0.2)
    scene.passes(3.0)
    assert returned(scene) == {"A"}
    assert "was ordered to return" in words(scene)


@pytest.mark.parametrize("above_m", [-12.0, 45.0])
def test_one_below_or_far_above_is_not_in_its_way(above_m: float) -> None:
    assert returned(one_above_the_other(LOW, above_m).passes(17.0)) == {"A"}


def test_a_critical_battery_has_no_time() -> None:
    assert returned(one_above_the_other(CRITICAL).passes(2.0)) == {"A"}


def test_a_persons_return_is_not_delayed() -> None:
    scene = one_above_the_other(0.8).passes(1.0)
    scene.order(ReturnHome())
    assert returned(scene) == {"A"}


def test_a_persons_newer_order_ends_the_wait() -> None:
    scene = one_above_the_other(LOW).passes(20.0)
    scene.order(Hover())
    scene.passes(20.0)
    assert returned(scene) == set()
    assert "an operator's order stands" in words(scene)


def test_a_lost_vehicle_delays_nothing() -> None:
    scene = one_above_the_other(LOW).passes(5.0)
    scene.talk.pop(2)
    assert returned(scene.passes(25.0)) == {"A"}


def test_where_the_place_is_unknown_it_goes() -> None:
    scene = one_above_the_other(LOW)
    blind = core(position=None, height_m=25.0, altitude_m=285.0)
    scene.keeps_receiving(1, blind, extended(battery=LOW)).passes(40.0)
    assert returned(scene) == {"A"}
