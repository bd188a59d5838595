"""A scenario's conditions: the sun where they have it, the view in shade, exposure locked."""

from pathlib import Path

import numpy as np
import pytest
from tests.score.scenes import SMALL, small

from recon.score import Scenario, load_scenario
from recon.score.scenario_conditions import conditions_of, with_exposure
from recon.score.scenario_sky import sky_of
from recon.score.simulation import simulation_of
from recon.sim.camera.field import FieldRenderer
from recon.sim.conditions import Range
from recon.sim.fleet import IMAGER_SERIAL
from recon.sim.flight.estimate import FIELD_DRIFT

SCENARIOS = Path(__file__).parents[2] / "scenarios"


@pytest.fixture(scope="module")
def cumulus() -> Scenario:
    return load_scenario(SCENARIOS / "cumulus-40.toml")


def test_the_sun_starts_where_it_is_drawn(cumulus: Scenario) -> None:
    starts = []
    for seed in range(12):
        drawn, sun = conditions_of(cumulus, seed), sky_of(cumulus, seed).sun_at(0.0)
        assert sun.elevation_deg == pytest.approx(drawn.sun_elevation_deg, abs=1e-3)
        assert drawn.sun_elevation_deg is not None
        if drawn.sun_elevation_deg < 40.0:
            assert sun.azimuth_deg < 180.0, "a low sun must not set during the survey"
        starts.append(sun.azimuth_deg)
    assert min(starts) < 150.0 < 210.0 < max(starts)


def test_without_an_elevation_the_start_time_has_it(tmp_path: Path) -> None:
    scenario = small(tmp_path)
    assert sky_of(scenario, 3).settings.sun == scenario.sun


def test_the_simulation_has_the_conditions(cumulus: Scenario) -> None:
    conditions = conditions_of(cumulus, 5)
    config = simulation_of(cumulus, 5)
    source = config.imagers[IMAGER_SERIAL].source
    assert isinstance(source, FieldRenderer)
    assert (source.imager, source.light) == (conditions.camera, conditions.light)
    assert source.relief is not None
    assert source.relief.settings.height_m == conditions.relief_m
    assert config.drift == FIELD_DRIFT
    assert config.sensors.yaw_error_deg == conditions.yaw_error_deg


@pytest.mark.parametrize("seed", range(3))
def test_the_whole_view_starts_in_shade(seed: int) -> None:
    scenario = load_scenario(SCENARIOS / "starts-in-shade.toml")
    sky, imager = sky_of(scenario, seed), scenario.imager
    steps_m = np.linspace(-imager.radius_m, imager.radius_m, 41)
    east_m, north_m = np.meshgrid(steps_m, steps_m)
    is_seen = np.hypot(east_m, north_m) <= imager.radius_m
    east_m, north_m = east_m[is_seen] + imager.over_m[0], north_m[is_seen] + imager.over_m[1]
    assert (sky.transmittance(east_m, north_m, 0.0) < 0.5).mean() > 0.97
    # The sun is not moved with the clouds.
    drawn = conditions_of(scenario, seed).sun_elevation_deg
    assert sky.sun_at(0.0).elevation_deg == pytest.approx(drawn, abs=1e-3)


def test_the_station_is_informed_of_a_locked_exposure(tmp_path: Path) -> None:
    automatic = small(tmp_path)
    locked = small(tmp_path, f"{SMALL}[conditions]\nexposure_locked = true\n")
    for scenario, is_locked in (
        (automatic, False),
        (locked, True),
        (with_exposure(automatic, True), True),
        (with_exposure(locked, False), False),
    ):
        assert scenario.site.imager is not None
        assert scenario.site.imager.exposure_locked is is_locked
        assert (conditions_of(scenario, 1).camera.exposure.follows == 0.0) is is_locked


def test_a_file_states_a_range_or_one_value(tmp_path: Path) -> None:
    text = f"{SMALL}[conditions]\nhot_spot = [0.3, 0.4]\nperiod_s = 2\n"
    ranges = small(tmp_path, text).conditions
    assert (ranges.hot_spot, ranges.period_s) == (Range(0.3, 0.4), Range(2, 2))
