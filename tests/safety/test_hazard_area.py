"""Where a vehicle with lost telemetry may be: a circle that grows, its route home, its landing."""

from dataclasses import replace

import pytest
from tests.safety.traffic import SETTINGS, aircraft, flies, route, seen

from recon.model.control import Commanded, Intent
from recon.model.vehicle import Failsafe, VehicleState
from recon.safety.prediction import HazardArea, hazard_area_of, hazard_trajectories
from recon.safety.prediction.trajectory import (
    ALL_HEIGHTS_M,
    EAST_0,
    EAST_1,
    NORTH_0,
    NORTH_1,
    sample,
)
from recon.safety.prediction_settings import PredictionSettings

SLOWEST_0 = replace(SETTINGS, hazard_least_speed_mps=0.0)


def lost(
    state: VehicleState, intent: Intent | None = None, settings: PredictionSettings = SETTINGS
) -> HazardArea:
    found = hazard_area_of(seen(state), intent or Intent(), settings)
    assert found is not None
    return found


def test_it_begins_when_telemetry_is_older_than_3_s() -> None:
    assert hazard_area_of(seen(aircraft(age_s=3.0)), Intent(), SETTINGS) is None
    assert lost(aircraft(age_s=3.01)).age_s == pytest.approx(3.01)


@pytest.mark.parametrize(
    ("intent", "speed_mps", "growth_mps"),
    [
        (Intent(), 0.5, 0.5),
        (Intent(Commanded.MISSION), 0.5, 0.5),
        (Intent(Commanded.STICK), 0.5, 0.5),
        (Intent(Commanded.STICK, speed_mps=0.7), 0.5, 0.7),
        (flies(route((0.0, 0.0), (9.0, 0.0))), 0.5, 5.0),
        (flies(route((0.0, 0.0), (9.0, 0.0))), 6.0, 6.0),
    ],
)
def test_it_grows_with_its_last_speed_or_the_commanded_one(
    intent: Intent, speed_mps: float, growth_mps: float
) -> None:
    moving = aircraft(velocity=(speed_mps, 0.0, 0.0), age_s=5.0)
    assert lost(moving, intent, SLOWEST_0).growth_mps == growth_mps


@pytest.mark.parametrize("failsafe", [Failsafe.HOVER, Failsafe.LAND])
def test_one_that_does_not_go_home_has_a_circle_only(failsafe: Failsafe) -> None:
    found = lost(aircraft(place=(0.0, 300.0), age_s=5.0, failsafe=failsafe))
    assert found.home_m is None
    assert len(hazard_trajectories(found)) == 1


def test_its_circle_grows_and_its_route_home_and_landing_are_as_wide_as_a_corridor() -> None:
    """Lost for 5 s at 10 m/s it is within 50 m, and within 150 m after 10 s more."""
    moving = aircraft("B", (40.0, 300.0), 80.0, (10.0, 0.0, 0.0), age_s=5.0)
    circle, path, landing = trajectories = hazard_trajectories(lost(moving))
    assert [one.name for one in trajectories] == ["B"] * 3
    found = sample([one.rows for one in trajectories], [0.0, 5.0, 10.0, 900.0])
    corridor_m = [SETTINGS.corridor_m] * 4
    assert found.radius_m[0] == pytest.approx([50.0, 100.0, 150.0, 150.0])
    assert found.radius_m[1:].tolist() == [corridor_m, corridor_m]
    for one, line_m in (
        (circle, [300.0, 40.0, 300.0, 40.0]),
        (path, [300.0, 40.0, 0.0, 0.0]),
        (landing, [0.0, 0.0, 0.0, 0.0]),
    ):
        assert one.rows[-1, [EAST_0, NORTH_0, EAST_1, NORTH_1]] == pytest.approx(line_m, abs=0.1)
    assert found.low_m[:, 0].tolist() == [-ALL_HEIGHTS_M, 80.0, -ALL_HEIGHTS_M]
    assert found.high_m[:, 0].tolist() == [80.0] * 3
