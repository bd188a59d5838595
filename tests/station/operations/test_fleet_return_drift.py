"""Fleet returns at the end of long flights, when heights have grown uncertain."""

from dataclasses import replace
from itertools import pairwise

from tests.station.returning_world import returning_world

from recon.model.units import NS_PER_S
from recon.station.state.fleet_return_record import Stage


def test_after_a_long_flight_layers_are_as_far_apart_as_the_gate_asks() -> None:
    """Fifty minutes in the air: two heights are known to 0.8 m only, ten minutes later to 1 m."""
    made = returning_world(
        [(-60.0, 40.0, 30.0), (0.0, 60.0, 50.0), (60.0, 40.0, 70.0)],
        [(-30.0, 0.0), (0.0, 0.0), (30.0, 0.0)],
    )
    station = made.world.driver.station
    long_ago_ns = made.world.driver.now_ns - 50 * 60 * NS_PER_S
    vehicles = {
        serial: replace(vehicle, airborne_since_ns=long_ago_ns)
        for serial, vehicle in station.fleet.vehicles.items()
    }
    made.world.driver.station = station.with_fleet(replace(station.fleet, vehicles=vehicles))
    made.call(*made.pads_m)
    assert made.runs_until_over(400.0)
    assert set(made.stages().values()) == {Stage.LANDED}
    running = made.world.driver.station.fleet_return
    assert running is not None
    layers_m = running.layers_up_m
    assert all(b - a > 8.45 for a, b in pairwise(layers_m))
    refused = [r for r in made.world.driver.station.orders.records.values() if r.refusal]
    assert refused == []
