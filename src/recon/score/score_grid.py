"""The ground on which shade maps and forecasts are scored: fixed by scenario and lens.

Maps come on grids of their own. They are resampled, nearest cell, onto the score's grid, so that a
map of less ground or of coarser cells gains nothing: where it has no cell it is unknown.
"""

from functools import lru_cache
from math import radians, tan

import numpy as np
import numpy.typing as npt

from recon.model.geo import GroundGrid
from recon.model.shade import MaskMap
from recon.score.scenario import Scenario
from recon.site import Imager

CELL_M = 4.0
MOST_FIELD_DEG = 70.0
"""From the vertical: 330 m around a camera at 120 m. Beyond, a pixel is more than 4 m long."""
RIM_SHARE = 0.98
"""Of the image circle's radius: its rim is dark, and leaves the view when the camera wobbles."""

FloatArray = npt.NDArray[np.float64]
IndexArray = npt.NDArray[np.intp]


def score_radius_m(scenario: Scenario) -> float:
    """Return the radius of the scored ground: the scenario's, within the lens's field."""
    imager = scenario.site.imager
    assert imager is not None  # or it would not have been read
    field_rad = min(field_angle_rad(imager), radians(MOST_FIELD_DEG))
    return min(scenario.imager.radius_m, scenario.imager.height_m * tan(field_rad))


def field_angle_rad(imager: Imager) -> float:
    """Return the angle from a lens's axis that all its frames show."""
    camera, circle = imager.camera, imager.image_circle
    if circle is None:
        return camera.largest_angle_rad
    rim = [circle.centre_col_px + RIM_SHARE * circle.radius_px, circle.centre_row_px]
    (ray,) = camera.unproject([rim])
    angle_rad = float(np.arccos(np.clip(ray[2], -1.0, 1.0)))
    return angle_rad if np.isfinite(angle_rad) else camera.largest_angle_rad


def score_grid(scenario: Scenario, cell_m: float = CELL_M) -> GroundGrid:
    """Return the grid around the scored ground."""
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
    east_m, north_m = cell_centres(grid)
    over_east_m, over_north_m = scenario.imager.over_m
    across_m = np.hypot.outer(north_m - over_north_m, east_m - over_east_m)
    inside: MaskMap = across_m <= score_radius_m(scenario)
    return inside


def cell_centres(grid: GroundGrid) -> tuple[FloatArray, FloatArray]:
    """Return easts (cols,) and norths (rows,) of the centres of a grid's cells."""
    east_m = grid.west_m + (np.arange(grid.cols, dtype=np.float64) + 0.5) * grid.cell_m
    north_m = grid.north_m - (np.arange(grid.rows, dtype=np.float64) + 0.5) * grid.cell_m
    return east_m, north_m


@lru_cache(maxsize=8)
def nearest_cells(source: GroundGrid, target: GroundGrid) -> tuple[IndexArray, IndexArray, MaskMap]:
    """Return the source's row and column (R, 1), (1, C) of each target cell, and where it has one.

    Rows and columns are clipped to the source. Both grids are in one local frame.
    """
    east_m, north_m = cell_centres(target)
    rows = np.floor((source.north_m - north_m) / source.cell_m).astype(np.intp)
    cols = np.floor((east_m - source.west_m) / source.cell_m).astype(np.intp)
    inside = np.logical_and.outer(
        (rows >= 0) & (rows < source.rows), (cols >= 0) & (cols < source.cols)
    )
    clipped = np.clip(rows, 0, source.rows - 1), np.clip(cols, 0, source.cols - 1)
    return clipped[0][:, np.newaxis], clipped[1][np.newaxis, :], inside
