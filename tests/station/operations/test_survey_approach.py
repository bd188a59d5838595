"""The approach to a survey's rows and the exit from them: in layers."""

from itertools import pairwise

import pytest
from tests.station.station_world import HOME, square_mission

from recon.geo.distance import moved_m
from recon.model.airspace import FlightLimits
from recon.model.geo import LatLon
from recon.model.mission import Mission
from recon.model.units import Stamped
from recon.model.vehicle import VehicleState
from recon.station.operations.survey.approach_layers import layers_above_takeoff_m
from recon.station.operations.survey.mission_dispatch import standing_by, with_approaches

LIMITS = FlightLimits()
ROWS = square_mission(height_m=60.0)


def standing(east_m: float, height_m: float = 0.0) -> VehicleState:
    at = moved_m(LatLon(HOME.latitude_deg, HOME.longitude_deg), -50.0, east_m)
    return VehicleState(None, position=Stamped(at), height_above_takeoff_m=Stamped(height_m))


def heights_m(mission: Mission) -> list[float]:
    return [each.height_above_takeoff_m for each in mission.waypoints]


def own_layers_m(
    mission: Mission, number: int, count: int, limits: FlightLimits = LIMITS
) -> list[float]:
    return layers_above_takeoff_m(heights_m(mission)[0], number, count, limits)


@pytest.mark.parametrize("count", [2, 3, 8])
def test_each_of_several_approaches_and_waits_in_a_layer_of_its_own(count: int) -> None:
    flown = [
        with_approaches(ROWS, standing(20.0 * n), own_layers_m(ROWS, n, count))[0]
        for n in range(count)
    ]
    for mission in flown:
        assert heights_m(mission)[:2] == [heights_m(mission)[-1]] * 2
        assert heights_m(mission)[2:-1] == heights_m(ROWS)
    layers_m = sorted({heights_m(mission)[-1] for mission in flown} | {60.0})
    assert len(layers_m) == count + 1
    assert min(b - a for a, b in pairwise(layers_m)) >= 8.0


def test_the_end_is_straight_up_or_down_from_the_last_row() -> None:
    last, end = with_approaches(ROWS, standing(0.0), own_layers_m(ROWS, 0, 2))[0].waypoints[-2:]
    assert (last.latitude_deg, last.longitude_deg) == (end.latitude_deg, end.longitude_deg)
    assert last.height_above_takeoff_m != end.height_above_takeoff_m
    assert end.gimbal_pitch_deg is None


def test_a_lone_vehicle_stays_where_its_rows_end() -> None:
    assert (
        heights_m(
            with_approaches(ROWS, standing(0.0), own_layers_m(ROWS, 0, 1), ends_in_layer=False)[0]
        )[-1]
        == 60.0
    )


def test_one_that_begins_at_its_first_row_still_ends_in_its_layer() -> None:
    first = ROWS.waypoints[0]
    there = LatLon(first.latitude_deg, first.longitude_deg)
    level = VehicleState(None, position=Stamped(there), height_above_takeoff_m=Stamped(60.0))
    flown = with_approaches(ROWS, level, own_layers_m(ROWS, 1, 2))[0]
    assert flown.waypoints[:-1] == ROWS.waypoints
    assert heights_m(flown)[-1] != 60.0


def test_one_that_stands_by_waits_in_its_layer_above_its_first_row() -> None:
    for number in range(2):
        flown = standing_by(ROWS, standing(-80.0), own_layers_m(ROWS, number, 2))[0]
        first = ROWS.waypoints[0]
        assert heights_m(flown) == heights_m(flown)[:1] * 2
        approached = with_approaches(ROWS, standing(-80.0), own_layers_m(ROWS, number, 2))[0]
        assert heights_m(flown)[0] == heights_m(approached)[0]
        last = flown.waypoints[-1]
        assert (last.latitude_deg, last.longitude_deg) == (first.latitude_deg, first.longitude_deg)
        assert all(each.gimbal_pitch_deg is None for each in flown.waypoints)


def test_without_room_for_layers_all_stay_at_the_rows_height() -> None:
    low = FlightLimits(max_height_above_ground_m=26.0)
    mission = square_mission(height_m=21.0)
    for flown in with_approaches(mission, standing(0.0), own_layers_m(mission, 0, 2, low)):
        assert set(heights_m(flown)) == {21.0}
    first = mission.waypoints[0]
    there = LatLon(first.latitude_deg, first.longitude_deg)
    level = VehicleState(None, position=Stamped(there), height_above_takeoff_m=Stamped(21.0))
    assert standing_by(mission, level, own_layers_m(mission, 0, 2, low)) == ()
