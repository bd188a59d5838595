"""What a survey is estimated to take, against what the whole station then flies in virtual time."""

import numpy as np
import pytest
from tests.station.operations.test_survey_return_to_home import is_home
from tests.station.surveyed_world import asked, field, surveyed_world

from recon.model.airspace import Region
from recon.station.api_views.survey_preview import survey_preview

APART = ((0.0, -40.0), (120.0, -40.0))


@pytest.mark.flight
def test_the_estimate_is_within_a_tenth_of_the_flight_from_start_to_landing() -> None:
    world = surveyed_world(2, height_m=0.0, pads=APART)
    world.asks(asked(field(200.0, 120.0)))
    serials = ("SIM-1", "SIM-2")
    preview = survey_preview(world.driver.station, world.state().plan, serials)
    estimate = preview()
    assert estimate.refusal is None
    assert estimate.batteries == 2
    world.starts(*serials, takeoff=True)
    landed_s: dict[str, int] = {}
    world.runs(30.0)
    for second in range(31, 600):
        world.runs(1.0)
        landed_s |= {s: second for s in serials if s not in landed_s and is_home(world, s)}
        if len(landed_s) == len(serials):
            break
    assert {drone.serial for drone in estimate.drones} == set(landed_s)
    assert estimate.time_s == pytest.approx(max(landed_s.values()), rel=0.10)


def test_a_vehicle_that_cannot_join_is_a_sentence() -> None:
    world = surveyed_world(1)
    world.asks(asked())
    preview = survey_preview(world.driver.station, world.state().plan, ("SIM-9",))
    assert preview().refusal == "Vehicle 'SIM-9' not found"
    assert preview().time_s is None


def test_area_and_rows_are_those_that_a_plan_without_a_station_has() -> None:
    """A hole cuts rows into parts, and cells are larger than the region's edge is exact."""
    west, east, south, north = 0.0, 201.0, 0.0, 121.0
    ring = [(west, south), (east, south), (east, north), (west, north)]
    hole = [(80.0, 40.0), (120.0, 40.0), (120.0, 80.0), (80.0, 80.0)]
    world = surveyed_world(1)
    world.asks(asked(Region(np.array(ring), (np.array(hole),)), side_overlap=0.6))
    preview = survey_preview(world.driver.station, world.state().plan, ())
    plan = world.record().state.plan
    assert len({piece.row for piece in plan.pieces}) < len(plan.pieces)
    assert preview().rows == len({piece.row for piece in plan.pieces})
    assert preview().region_m2 == pytest.approx(201.0 * 121.0 - 40.0 * 40.0)


def test_a_drone_that_is_named_twice_counts_once() -> None:
    world = surveyed_world()
    world.asks(asked(field(120.0, 60.0)))
    once, twice = (
        survey_preview(world.driver.station, world.state().plan, serials)
        for serials in (("SIM-1",), ("SIM-1", "SIM-1"))
    )
    assert once() == twice()
