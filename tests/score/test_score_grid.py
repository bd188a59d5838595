"""The score's own ground: no map escapes it by being smaller or coarser."""

from dataclasses import replace
from math import radians, tan

import numpy as np
import pytest
from tests.score.scenes import SMALL, small

from recon.camera import ImageCircle
from recon.geo import cell_centres_m
from recon.model.geo import GroundGrid
from recon.model.shade import ShadeMap
from recon.score import Scenario
from recon.score.score_grid import (
    score_grid,
    score_radius_m,
    scored_cells,
)
from recon.score.shade_scoring import ScoredGround
from recon.sim.world import LayerSettings, Sky, SkySettings
from recon.site.site import RIM_SHARE

CLEAR = Sky(SkySettings(layers=()))


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    text = SMALL.replace("radius_m = 160.0", "radius_m = 330.0")
    return small(tmp_path_factory.mktemp("scenarios"), text)


def with_field(scenario: Scenario, degrees: float) -> Scenario:
    """The scenario with an image circle whose counted part ends at an angle."""
    imager = scenario.site.imager
    assert imager is not None
    camera = imager.camera
    ray = np.array([[np.sin(radians(degrees)), 0.0, np.cos(radians(degrees))]])
    radius_px = float(camera.project(ray)[0, 0] - camera.centre_col_px) / RIM_SHARE
    circle = ImageCircle(camera.centre_col_px, camera.centre_row_px, radius_px)
    site = scenario.site.with_imager(replace(imager, image_circle=circle))
    return replace(scenario, site=site)


def sunny_map(grid: GroundGrid) -> ShadeMap:
    ones = np.ones((grid.rows, grid.cols), dtype=np.float32)
    return ShadeMap(grid, 0, (), ones, ones > 0.0, ones, ones)


def test_the_scored_ground_ends_with_the_lens_or_with_the_scenario(scenario: Scenario) -> None:
    height_m = scenario.imager.height_m
    assert score_radius_m(with_field(scenario, 60.0)) == pytest.approx(
        height_m * tan(radians(60.0)), rel=1e-3
    )
    assert score_radius_m(with_field(scenario, 78.0)) == scenario.imager.radius_m == 330.0
    near = replace(scenario, imager=replace(scenario.imager, radius_m=100.0))
    assert score_radius_m(near) == 100.0


def test_the_scored_cells_are_a_disk_below_the_camera(scenario: Scenario) -> None:
    near = replace(scenario, imager=replace(scenario.imager, radius_m=100.0))
    grid = score_grid(near)
    counted = scored_cells(grid, near)
    assert counted.sum() * grid.cell_m**2 == pytest.approx(np.pi * 100.0**2, rel=0.01)
    east_m, north_m = cell_centres_m(grid)
    assert float((counted.sum(axis=0) * east_m).sum() / counted.sum()) == pytest.approx(
        near.imager.over_m[0]
    )
    assert float((counted.sum(axis=1) * north_m).sum() / counted.sum()) == pytest.approx(
        near.imager.over_m[1]
    )


def test_a_map_of_less_ground_is_unknown_elsewhere(scenario: Scenario) -> None:
    near = replace(scenario, imager=replace(scenario.imager, radius_m=100.0))
    grid = score_grid(near)
    ground = ScoredGround(grid, scored_cells(grid, near))
    assert ground.figures(sunny_map(grid), CLEAR, 0.0).right_share == 1.0
    assert ground.figures(None, CLEAR, 0.0).unknown == ground.counted.sum()
    western = replace(grid, cols=grid.cols // 2)
    found = ground.figures(sunny_map(western), CLEAR, 0.0)
    assert found.unknown == pytest.approx(found.cells / 2.0)
    assert found.wrong == 0


def test_coarser_cells_gain_nothing(scenario: Scenario) -> None:
    near = replace(scenario, imager=replace(scenario.imager, radius_m=100.0))
    sky = Sky(SkySettings(seed=3, layers=(LayerSettings(cover=0.5, outer_scale_m=1000.0),)))
    grid = score_grid(near)
    ground = ScoredGround(grid, scored_cells(grid, near))

    def true_map(cells: GroundGrid) -> ShadeMap:
        return replace(sunny_map(cells), transmittance=sky.on_grid(cells, 60.0))

    coarse = GroundGrid(near.frame, grid.west_m, grid.north_m, 50.0, 4, 4)
    assert ground.figures(true_map(grid), sky, 60.0).wrong == 0
    assert ground.figures(true_map(coarse), sky, 60.0).wrong > 0
