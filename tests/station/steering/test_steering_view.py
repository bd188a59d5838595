"""The goal of a steered vehicle in the API."""

from tests.station.steered_world import SERIAL, steered

from recon.model.command import Hover
from recon.station.api_views.vehicle_views import steering_view


class TestSteeringView:
    def test_tells_the_target_while_it_is_steered_and_when_it_has_arrived(self) -> None:
        s = steered()
        assert steering_view(s.w.driver.station, SERIAL) is None
        order = s.goto(60.0, 0.0, height_m=55.0)
        s.run_for(2.0)
        view = steering_view(s.w.driver.station, SERIAL)
        assert view is not None
        assert (view.command_id, view.height_above_takeoff_m) == (order, 55.0)
        assert (view.has_arrived, view.is_ending) == (False, False)
        s.run_for(40.0)
        view = steering_view(s.w.driver.station, SERIAL)
        assert view is not None
        assert view.has_arrived

    def test_a_stop_ends_it(self) -> None:
        s = steered()
        s.goto(60.0)
        s.run_for(2.0)
        s.order(Hover())
        s.run_for(1.0)
        assert steering_view(s.w.driver.station, SERIAL) is None
        assert steering_view(s.w.driver.station, None) is None
