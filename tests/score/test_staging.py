"""The place of a scenario: a site folder or a generated site; and its simulated fleet."""

from pathlib import Path

import numpy as np
import pytest
from tests.score.scenes import SMALL, small

from recon.geo import Polygon, enu_from_point
from recon.score import Scenario, ScenarioError, load_scenario
from recon.score.score_grid import score_grid, scored_cells
from recon.score.simulation import simulation_of
from recon.sim.app.faults import FaultKind
from recon.sim.camera.field import FieldRenderer
from recon.sim.fleet import IMAGER_SERIAL, build_fleet
from recon.site import demo_site_folder

FOLDER = Path(__file__).parents[2] / "scenarios"
ON_DEMO = SMALL.replace(
    "latitude_deg = 41.9\nlongitude_deg = -93.6\nground_altitude_m = 280.0",
    f'folder = "{Path(__file__).parents[2]}/src/recon/site/demo"',
)


def every_scenario() -> list[Scenario]:
    return [load_scenario(path) for path in sorted(FOLDER.glob("*.toml"))]


@pytest.fixture(scope="module")
def scenarios() -> list[Scenario]:
    return every_scenario()


def test_a_scenario_of_the_demonstrations_site_loads_wherever_it_is(tmp_path: Path) -> None:
    copy = tmp_path / "mine.toml"
    copy.write_bytes((FOLDER / "cumulus-40.toml").read_bytes())
    scenario = load_scenario(copy)
    assert scenario.site.name == "demo field"
    assert scenario.files == (demo_site_folder(),)


def test_region_and_pads_lie_inside_the_fence_by_its_margin(scenarios: list[Scenario]) -> None:
    for scenario in scenarios:
        boundary = scenario.site.layers.boundary
        assert boundary is not None
        places = [*scenario.survey.region.outline_m.tolist(), *scenario.fleet.pads_m]
        inside_m = Polygon(boundary).distance_to_edge_m(np.array(places))
        assert inside_m.min() > scenario.site.limits.boundary_margin_m


def test_go_home_heights_are_separated_and_below_the_ceiling(scenarios: list[Scenario]) -> None:
    for scenario in scenarios:
        serials = (*scenario.fleet.serials, IMAGER_SERIAL)
        profiles = [scenario.site.profiles[serial] for serial in serials]
        heights_m = sorted(p.go_home_height_m for p in profiles if p.go_home_height_m is not None)
        assert len(heights_m) == len(serials)
        limits = scenario.site.limits
        assert np.diff(heights_m).min() >= limits.min_separation_vertical_m
        assert heights_m[-1] < limits.max_height_above_ground_m


def test_a_site_folder_defines_pads_and_imager_position(tmp_path: Path) -> None:
    scenario = small(tmp_path, ON_DEMO)
    assert scenario.fleet.pads_m[0] == pytest.approx((-24.0, -8.0), abs=0.01)
    assert scenario.imager.over_m == pytest.approx((0.0, 0.0), abs=0.2)
    assert scenario.imager.height_m == pytest.approx(120.0, abs=0.5)
    assert scenario.frame.origin.ellipsoid_height_m == 275.0


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("/demo", "/none", "small.toml:6: site.folder: expected a site that loads, got: "),
        ("[task]", "latitude_deg = 41.9\n[task]", "site: expected a folder or an origin, got both"),
        (
            "radius_m",
            "over_m = [0.0, 0.0]\nradius_m",
            "imager.over_m: expected only without a folder",
        ),
        (
            "radius_m",
            "also_over_m = [[9.0, 9.0]]\nradius_m",
            "imager.also_over_m: expected only without a folder",
        ),
        ("radius_m", "tilt_deg = 9\nradius_m", "imager.tilt_deg: expected only without a folder"),
        (
            "survey_drones = 2",
            "survey_drones = 9",
            "survey_drones: expected a pad on the site for",
        ),
        (
            "survey_drones = 2",
            "survey_drones = 2\npads_m = [[0.0, 0.0], [30.0, 0.0]]",
            "fleet.pads_m: expected only without a folder",
        ),
    ],
)
def test_keys_that_conflict_with_a_site_folder_are_errors(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    with pytest.raises(ScenarioError) as caught:
        small(tmp_path, ON_DEMO.replace(old, new))
    assert words in str(caught.value)


def test_a_generated_camera_is_tilted_and_its_maps_reach_farther(tmp_path: Path) -> None:
    keys = "[imager]\ntilt_deg = 25.0\nreach_m = 500.0\nupwind = true"
    scenario, plain = small(tmp_path, SMALL.replace("[imager]", keys)), small(tmp_path)
    assert scenario.site.imager is not None
    assert np.degrees(scenario.site.imager.outlook.tilt_rad) == pytest.approx(25.0)
    assert scenario.site.imager.outlook.off_front_deg == pytest.approx(0.0)
    assert plain.site.imager is not None
    assert plain.site.imager.outlook.tilt_rad == pytest.approx(0.0)
    grid = scenario.site.ground_grid
    assert grid is not None
    assert grid.rows * grid.cell_m == pytest.approx(1000.0)
    boundaries = [each.site.layers.boundary for each in (scenario, plain)]
    wide, narrow = (Polygon(each).area_m2 for each in boundaries if each is not None)
    assert wide > narrow + 300.0**2


TWO = "[imager]\nalso_over_m = [[400.0, 75.0]]\nreach_m = 600.0\ncell_m = 8.0"


def test_several_imaging_drones_have_lens_pad_profile_and_wobble_each(tmp_path: Path) -> None:
    scenario = small(tmp_path, SMALL.replace("[imager]", TWO))
    assert list(scenario.site.imagers) == [IMAGER_SERIAL, f"{IMAGER_SERIAL}-2"]
    second = scenario.site.imagers[f"{IMAGER_SERIAL}-2"]
    assert second.marked_pose.position_enu_m == pytest.approx([400.0, 75.0, 120.0])
    config = simulation_of(scenario, 3)
    apps = build_fleet(config, 0)
    serials = [app.settings.serial for app in apps]
    assert serials == [IMAGER_SERIAL, f"{IMAGER_SERIAL}-2", "SIM-1", "SIM-2"]
    assert apps[1].aircraft.motion.height_m == pytest.approx(120.0)
    home_m = enu_from_point(scenario.frame, apps[1].settings.home)
    assert home_m[:2] == pytest.approx((400.0, 75.0), abs=0.01)
    first, other = (each.source for each in config.imagers.values())
    assert isinstance(first, FieldRenderer)
    assert isinstance(other, FieldRenderer)
    assert first.seed == other.seed, "both see the same land"
    assert first.imager.seed != other.imager.seed
    counted = scored_cells(score_grid(scenario), scenario)
    alone = small(tmp_path, SMALL.replace("[imager]", "[imager]\ncell_m = 8.0"))
    one = scored_cells(score_grid(alone), alone)
    assert counted.sum() == pytest.approx(2 * one.sum(), rel=0.02)


def test_an_incomplete_origin_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="site: expected a folder, or latitude_deg, longitude"):
        small(tmp_path, SMALL.replace("latitude_deg = 41.9\n", ""))


def test_the_simulated_fleet_starts_on_the_pads(tmp_path: Path) -> None:
    scenario = small(tmp_path)
    apps = build_fleet(simulation_of(scenario, 3), 0)
    assert [app.settings.serial for app in apps] == [IMAGER_SERIAL, "SIM-1", "SIM-2"]
    for app, pad_m in zip(apps[1:], scenario.fleet.pads_m, strict=True):
        home_m = enu_from_point(scenario.frame, app.settings.home)
        assert home_m[:2] == pytest.approx(pad_m, abs=0.01)
        assert app.aircraft.is_on_ground
    assert apps[0].aircraft.motion.height_m == pytest.approx(120.0)


def test_a_fault_of_drone_1_does_not_strike_the_imager(tmp_path: Path) -> None:
    apps = build_fleet(simulation_of(small(tmp_path), 0), 0)
    assert [len(app.settings.faults) for app in apps] == [0, 1, 0]


STORM = """[[fault]]
name = "gusts"
vehicle = "2"
start_s = 60.0

[[chance]]
name = "telemetry-dropout"
vehicle = "*"
per_hour = 30.0
duration_s = [2.0, 8.0]
"""


def with_storm(folder: Path, storm: str) -> Scenario:
    (folder / "storm.toml").write_text(storm, encoding="utf-8")
    return small(folder, SMALL.replace("[site]", 'fault_file = "storm.toml"\n\n[site]', 1))


def test_a_fault_file_adds_to_the_scenarios_faults(tmp_path: Path) -> None:
    scenario = with_storm(tmp_path, STORM)
    assert [fault.kind.value for fault in scenario.faults] == ["pilot-takes", "gusts"]
    imager, first, second = build_fleet(simulation_of(scenario, 5), 0)
    assert "gusts" in [fault.kind.value for fault in second.settings.faults]
    assert "gusts" not in [fault.kind.value for fault in first.settings.faults]
    assert "telemetry-dropout" in [fault.kind.value for fault in imager.settings.faults]


def test_random_faults_repeat_for_a_seed_and_differ_between_seeds(tmp_path: Path) -> None:
    scenario = with_storm(tmp_path, STORM)

    def starts_s(seed: int) -> dict[str, list[float]]:
        apps = build_fleet(simulation_of(scenario, seed), 0)
        return {
            app.settings.serial: [
                fault.start_s
                for fault in app.settings.faults
                if fault.kind is FaultKind.TELEMETRY_DROPOUT
            ]
            for app in apps
        }

    assert starts_s(5) == starts_s(5)
    assert starts_s(6) != starts_s(5)
    assert all(len(found) > 0 for found in starts_s(5).values())


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"gusts"', '"gremlins"', "storm.toml: line 2"),
        (
            'vehicle = "2"',
            'vehicle = "7"',
            "expected a vehicle of SIM-1, SIM-2, SIM-IMAGER, its numb",
        ),
        ("per_hour = 30.0", "per_hour = -1.0", "storm.toml: line 9"),
    ],
)
def test_errors_in_a_fault_file_name_its_line(
    tmp_path: Path, old: str, new: str, words: str
) -> None:
    with pytest.raises(ScenarioError) as caught:
        with_storm(tmp_path, STORM.replace(old, new))
    assert words in str(caught.value)
    assert "small.toml:5: fault_file" in str(caught.value)


def test_a_fault_can_strike_the_imager_alone(tmp_path: Path) -> None:
    scenario = small(tmp_path, SMALL.replace("pilot-takes:1:40:30", "frames-black:SIM-IMAGER:5:5"))
    imager, first, _second = build_fleet(simulation_of(scenario, 0), 0)
    assert (len(imager.settings.faults), len(first.settings.faults)) == (1, 0)


def test_relief_is_rendered_only_where_the_scenario_has_it(tmp_path: Path) -> None:
    flat, rolling = (
        simulation_of(small(tmp_path, f"{SMALL}[conditions]\nrelief_m = {height_m}\n"), 1)
        for height_m in (0.0, 6.0)
    )
    sources = [config.imagers[IMAGER_SERIAL].source for config in (flat, rolling)]
    assert [getattr(source, "relief", None) is None for source in sources] == [True, False]
