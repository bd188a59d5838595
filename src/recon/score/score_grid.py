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

FloatArray = npt.NDArray[np.float64]
IndexArray = npt.NDArray[np.intp]


def score_radius_m(scenario: Scenario) -> float:
    """Return the radius of the scored ground: the scenario's, within the lens's field."""
    imager = scenario.site.imager
    assert imager is not None  # or it would not have been read
    return min(scenario.imager.radius_m, scenario.imager.height_m * tan(imager.outlook.field_rad))


def score_grid(scenario: Scenario, least_cell_m: float = 0.0) -> GroundGrid:
    """Return the grid around the scored ground."""
    cell_m = max(scenario.imager.cell_m, least_cell_m)
    half = int(np.ceil(score_radius_m(scenario) / cell_m))
    east_m, north_m = scenario.imager.over_m
    return GroundGrid(
        scenario.frame,
        east_m - half * cell_m,
        north_m + half * cell_m,
        cell_m,
        2 * half,
        2 * half,
    )


def scored_cells(grid: GroundGrid, scenario: Scenario) -> MaskMap:
    """Return the cells of a grid that are scored (rows, cols)."""
    east_m, north_m = cell_centres_m(grid)
    over_east_m, over_north_m = scenario.imager.over_m
    across_m = np.hypot.outer(north_m - over_north_m, east_m - over_east_m)
    inside: MaskMap = across_m <= score_radius_m(scenario)
    return inside
