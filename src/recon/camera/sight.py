"""Lines of sight from a camera to level ground, and how much ground a pixel shows there.

A fisheye has about the same number of pixels per radian p in every direction, so only distance d
and height h count: a pixel shows d / p of the ground across the view, and d^2 / (h p) along it.
"""

from math import sqrt

import numpy as np

from recon.model.arrays import FloatArray
from recon.model.geo import GroundGrid

COARSEST_M = 12.0
"""Ground that a pixel may show along its longer side; a tilted camera sees to the horizon. Of shade
read in pixels of 10 to 12 m one cell in nine is wrong, of coarser ones more and more."""


def sight2_m2(grid: GroundGrid, camera_enu_m: FloatArray) -> FloatArray:
    """Return (R, C): the square of the distance from a camera to each cell of level ground."""
    east, north, up = camera_enu_m.tolist()
    east_m = grid.west_m + (np.arange(grid.cols) + 0.5) * grid.cell_m - east
    north_m = grid.north_m - (np.arange(grid.rows) + 0.5) * grid.cell_m - north
    away_m2 = np.add.outer(north_m**2, east_m**2)
    sight2: FloatArray = away_m2 + up**2
    return sight2


def farthest_sight_m(
    height_m: float, pixels_per_radian: float, most_metres_per_pixel: float
) -> float:
    """Return the line of sight at which a pixel shows this much ground along its longer side."""
    return sqrt(most_metres_per_pixel * height_m * pixels_per_radian)
