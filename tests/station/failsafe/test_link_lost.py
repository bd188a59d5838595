"""Link lost: nothing can be sent; the reaction comes with the link, if it was away for long."""

from tests.station.failsafe.reacting import (
    OWNER,
    A,
    alarm_text,
    fly,
    holds,
    in_mission,
    own_orders,
    reactions,
    steered,
)
from tests.station.station_world import World

from recon.model.command import Phase
from recon.model.vehicle import FlightMode

HELD = [(A, "hover", "station: link lost")]


def loses_link(w: World, seconds: float) -> None:
    """The app's connection ends, and comes back after a while."""
    app = w.app(A)
    w.driver.disconnect(w.connected[A].link_id)
    app.disconnected()
    w.run_for(seconds)
    assert own_orders(w) == []
    w.connect(app)
    w.run_for(3.0)


class TestInAMission:
    def test_a_mission_that_ran_on_unwatched_for_half_a_minute_is_held_when_the_link_is_back(
        self,
    ) -> None:
        w = in_mission()
        loses_link(w, 31.0)
        assert reactions(w) == HELD
        w.run_for(6.0)
        assert own_orders(w)[0].phase is Phase.DONE
        assert holds(w)

    def test_one_that_is_back_before_flies_on(self) -> None:
        w = in_mission()
        loses_link(w, 25.0)
        w.run_for(10.0)
        assert reactions(w) == []
        assert w.vehicle(A).flight_mode.value is FlightMode.GPS_WAYPOINT

    def test_two_short_gaps_are_no_long_one(self) -> None:
        w = in_mission()
        loses_link(w, 20.0)
        loses_link(w, 20.0)
        assert reactions(w) == []

    def test_the_alarm_states_it_while_the_link_is_lost(self) -> None:
        w = in_mission()
        w.driver.disconnect(w.connected[A].link_id)
        w.run_for(5.0)
        text = alarm_text(w, "link_lost")
        assert "the station holds it when the link is back after 30 s or more" in text

    def test_one_that_the_aircraft_brings_home_is_left_alone(self) -> None:
        w = in_mission()
        app = w.app(A)
        w.driver.disconnect(w.connected[A].link_id)
        app.disconnected()
        w.run_for(5.0)
        app.aircraft.go_home()
        w.run_for(26.5)
        w.connect(app)
        w.run_for(5.0)
        assert reactions(w) == []


class TestSteered:
    def test_it_is_held_as_soon_as_the_link_is_back(self) -> None:
        w = steered()
        assert OWNER in w.driver.station.owners
        loses_link(w, 4.0)
        assert reactions(w) == HELD
        w.run_for(5.0)
        assert holds(w)


def test_a_newer_order_of_the_operator_stands() -> None:
    w = in_mission()
    loses_link(w, 31.0)
    fly(w)
    w.run_for(15.0)
    assert reactions(w) == HELD
    assert w.vehicle(A).flight_mode.value is FlightMode.GPS_WAYPOINT
