"""The ground on which shade maps and forecasts are scored: fixed by scenario and lens.

Maps come on grids of their own. They are resampled, nearest cell, onto the score's grid, so that a
map of less ground or of coarser cells gains nothing: where it has no cell it is unknown.
"""

from math import tan

import numpy as np
import numpy.typing as npt

from recon.geo import cell_centres_m
from recon.model.geo import GroundGrid
from recon.model.shade import MaskMap
from recon.score.scenario import Scenario

IndexArray = npt.NDArray[np.intp]


def score_radius_m(scenario: Scenario) -> float:
    """Return the radius of the scored ground: the scenario's, within the lens's field."""
    imager = scenario.site.imager
    assert imager is not None  # or it would not have been read
    return min(scenario.imager.radius_m, scenario.imager.height_m * tan(imager.outlook.field_rad))


def score_grid(scenario: Scenario, least_cell_m: float = 0.0) -> GroundGrid:
    """Return the grid around the scored ground."""
    cell_m, radius_m = max(scenario.imager.cell_m, least_cell_m), score_radius_m(scenario)
    east_m, north_m = zip(*scenario.imager.places_m.values(), strict=True)
    half = int(np.ceil(radius_m / cell_m))
    cols = 2 * half + int(np.ceil((max(east_m) - min(east_m)) / cell_m))
    rows = 2 * half + int(np.ceil((max(north_m) - min(north_m)) / cell_m))
    west_m, top_m = min(east_m) - half * cell_m, max(north_m) + half * cell_m
    return GroundGrid(scenario.frame, west_m, top_m, cell_m, rows, cols)


def scored_cells(grid: GroundGrid, scenario: Scenario) -> MaskMap:
    """Return the cells of a grid that are scored (rows, cols): those near an imaging drone."""
    east_m, north_m = cell_centres_m(grid)
    inside: MaskMap = np.zeros((grid.rows, grid.cols), dtype=np.bool_)
    for over_east_m, over_north_m in scenario.imager.places_m.values():
        away_m = np.hypot.outer(north_m - over_north_m, east_m - over_east_m)
        inside |= away_m <= score_radius_m(scenario)
    return inside
