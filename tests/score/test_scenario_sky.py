"""Clouds of a scenario: their velocity is drawn by the seed, all else is the file's."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.score.scenes import SMALL, small, written

from recon.model.geo import GroundGrid
from recon.score import Scenario, ScenarioError, load_scenario
from recon.score.scenario_sky import drawn_layers, sky_of
from recon.sim.world import Sky

SCENARIOS = Path(__file__).parents[2] / "scenarios"
CLOUDS = "[[clouds]]\ncover = 0.4\nouter_scale_m = 2000.0\n"


def with_clouds(folder: Path, text: str) -> Scenario:
    assert CLOUDS in SMALL
    return small(folder, SMALL.replace(CLOUDS, text))


def test_speed_and_heading_differ_from_seed_to_seed(tmp_path: Path) -> None:
    scenario = small(tmp_path)
    layers = [drawn_layers(scenario.clouds, seed)[0] for seed in range(200)]
    speeds = np.array([layer.speed_mps for layer in layers])
    headings = np.array([layer.heading_deg for layer in layers])
    assert 5.0 <= speeds.min() < 5.2 < 10.8 < speeds.max() <= 11.0
    assert np.histogram(headings, bins=4, range=(0.0, 360.0))[0].min() > 30
    assert layers[7] == drawn_layers(scenario.clouds, 7)[0]
    assert {layer.cover for layer in layers} == {0.4}


def test_a_file_states_a_velocity_or_its_range(tmp_path: Path) -> None:
    fixed = with_clouds(tmp_path, "[[clouds]]\ncover = 0.4\nspeed_mps = 7\nheading_deg = 0\n")
    for seed in range(9):
        (layer,) = drawn_layers(fixed.clouds, seed)
        assert (layer.speed_mps, layer.heading_deg) == (7.0, 0.0)
    some = with_clouds(tmp_path, "[[clouds]]\ncover = 0.4\nheading_deg = [-10, 10]\n")
    headings = [drawn_layers(some.clouds, seed)[0].heading_deg for seed in range(20)]
    assert all(heading >= 350.0 or heading <= 10.0 for heading in headings)


def test_a_higher_layer_veers_from_the_lower_one() -> None:
    scenario = load_scenario(SCENARIOS / "two-layers.toml")
    for seed in range(30):
        low, high = drawn_layers(scenario.clouds, seed)
        assert 25.0 <= (high.heading_deg - low.heading_deg) % 360.0 <= 70.0
        assert 10.0 <= high.speed_mps <= 18.0


def test_a_shift_turns_the_clouds_from_where_they_went() -> None:
    scenario = load_scenario(SCENARIOS / "wind-shift.toml")
    for seed in range(5):
        (layer,) = drawn_layers(scenario.clouds, seed)
        assert (layer.shifts[0].heading_deg - layer.heading_deg) % 360.0 == pytest.approx(80.0)


@pytest.mark.parametrize(
    ("clouds", "words"),
    [
        ("cover = 0.4\nveer_deg = 30", "expected heading_deg in this layer, got veer_deg"),
        ("cover = 0.4\nspeed_mps = [9, 5]", "expected the lower value first, got [9, 5]"),
        ("cover = 0.4\nspeed_mps = [9]", "speed_mps: expected a number or [lowest, highest]"),
        ("cover = 0.4\nspeed_mps = [5, 99]", "speed_mps: expected 0 to 60, got 99"),
        ("cover = 0.4\nheading_deg = true", "heading_deg: expected a number or [lowest, highest]"),
        (
            "cover = 0.4\n[[clouds]]\ncover = 0.2\nheading_deg = 3",
            "clouds[1].heading_deg: expected veer_deg in this layer, got heading_deg",
        ),
        (
            "cover = 0.4\nshifts = [{start_s = 1, duration_s = 9, speed_mps = 9, turn_deg = 200}]",
            "turn_deg: expected a number of -180 to 180, got 200",
        ),
    ],
)
def test_errors_name_file_and_line(tmp_path: Path, clouds: str, words: str) -> None:
    path = written(tmp_path, SMALL.replace(CLOUDS, f"[[clouds]]\n{clouds}\n"))
    with pytest.raises(ScenarioError) as caught:
        load_scenario(path)
    assert words in str(caught.value)
    assert str(caught.value).startswith(f"{path}:2")


@pytest.mark.parametrize("name", ["cumulus-40", "two-layers", "wind-shift"])
def test_frozen_clouds_moved_are_the_later_sky(name: str) -> None:
    """The true motion is exact where clouds keep their shape: layers, shifts and sun included."""
    scenario = load_scenario(SCENARIOS / f"{name}.toml")
    grid = GroundGrid(scenario.frame, -1500.0, 1500.0, 50.0, 60, 60)
    sky = frozen(scenario, 4)
    later = sky.on_grid(grid, 460.0)
    assert np.abs(sky.drifted(grid, 400.0, 460.0) - later).max() < 0.005
    assert np.abs(sky.on_grid(grid, 400.0) - later).mean() > 0.02
    assert sky.drifted(grid, 400.0, 400.0).tolist() == sky.on_grid(grid, 400.0).tolist()


def frozen(scenario: Scenario, seed: int) -> Sky:
    sky = sky_of(scenario, seed)
    layers = tuple(
        replace(layer, lifetime_s=float("inf"), modulation=0.0) for layer in sky.settings.layers
    )
    return replace(sky, settings=replace(sky.settings, layers=layers))
