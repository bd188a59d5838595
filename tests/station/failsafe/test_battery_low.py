"""Battery low: recalled after 15 s, if no operator has ordered anything else."""

import pytest
from tests.station.failsafe.reacting import (
    A,
    alarm_text,
    hovering,
    in_mission,
    issued_s,
    now_s,
    reactions,
    with_cell,
)
from tests.station.station_world import World

from recon.model.command import Hover, ReturnHome
from recon.model.failsafe_matrix import Activity, FailsafeCondition, Reaction
from recon.model.vehicle import FlightMode
from recon.sim.flight.battery import Battery

HOME = [(A, "return_home", "station: battery low")]
LOW = FailsafeCondition.BATTERY_LOW


def drains_to(w: World, fraction: float) -> float:
    """The battery falls to a level; return when telemetry shows it."""
    aircraft = w.app(A).aircraft
    aircraft.battery = Battery(fraction, aircraft.settings.endurance_s)
    assert w.run_until(lambda: (w.vehicle(A).battery_fraction.value or 1.0) <= fraction, 3.0)
    return now_s(w)


@pytest.mark.parametrize("start", [in_mission, hovering])
def test_it_is_called_home_after_15_s(start: object) -> None:
    w: World = start()  # type: ignore[operator]
    low_s = drains_to(w, 0.24)
    w.run_for(14.5)
    assert reactions(w) == []
    assert "the station recalls it in " in alarm_text(w, "battery")
    w.run_for(5.0)
    assert reactions(w) == HOME
    assert issued_s(w) - low_s == pytest.approx(15.0, abs=0.3)
    going = (FlightMode.GO_HOME, FlightMode.AUTO_LANDING)  # over its home it lands at once
    assert w.vehicle(A).flight_mode.value in going
    assert "was ordered to return" in alarm_text(w, "battery")


def test_it_lands_at_home_and_nothing_is_ordered_on_the_ground() -> None:
    w = hovering()
    drains_to(w, 0.24)
    assert w.run_until(lambda: w.app(A).aircraft.is_on_ground, 120.0)
    w.run_for(40.0)
    assert reactions(w) == HOME
    assert w.app(A).aircraft.is_on_ground


def test_an_operators_newer_order_stands_until_the_landing() -> None:
    w = hovering()
    drains_to(w, 0.24)
    w.run_for(16.0)
    assert reactions(w) == HOME
    w.order(A, Hover())
    w.run_for(60.0)
    assert reactions(w) == HOME
    assert not w.app(A).aircraft.is_on_ground


def test_an_order_in_time_leaves_the_decision_to_the_operator() -> None:
    w = in_mission()
    drains_to(w, 0.24)
    w.run_for(5.0)
    w.order(A, Hover())
    w.run_for(40.0)
    assert reactions(w) == []
    assert "an operator's order stands" in alarm_text(w, "battery")


def test_one_on_its_route_home_is_left_alone() -> None:
    w = in_mission()
    w.order(A, ReturnHome())
    w.run_for(2.0)
    drains_to(w, 0.24)
    w.run_for(20.0)
    assert reactions(w) == []


def test_a_site_may_have_it_land_or_alarm() -> None:
    for reaction, expected in (
        (Reaction.ALARM, []),
        (Reaction.LAND, [(A, "land", "station: battery low")]),
    ):
        w = hovering(matrix=with_cell(LOW, Activity.HOLDING, reaction, 2.0))
        drains_to(w, 0.24)
        w.run_for(5.0)
        assert reactions(w) == expected
