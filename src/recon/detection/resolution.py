"""How much ground one pixel of the eye covers."""

import numpy as np

from recon.model.geo import GroundGrid
from recon.model.imagery import CameraPose
from recon.model.shade import FloatMap


def metres_per_pixel(grid: GroundGrid, pose: CameraPose, pixels_per_radian: float) -> FloatMap:
    """Return (R, C): the ground along a pixel's coarser side, outwards from below the camera.

    A fisheye gives every direction about as many pixels a radian, so only distance and slant count:
    d / f across the view and d^2 / (h f) along it, for a camera h above flat ground, d away.
    """
    east_m = grid.west_m + (np.arange(grid.cols) + 0.5) * grid.cell_m - pose.position_enu_m[0]
    north_m = grid.north_m - (np.arange(grid.rows) + 0.5) * grid.cell_m - pose.position_enu_m[1]
    height_m = float(pose.position_enu_m[2])
    distance2_m2 = np.add.outer(north_m**2, east_m**2) + height_m**2
    coarser: FloatMap = (distance2_m2 / (height_m * pixels_per_radian)).astype(np.float32)
    return coarser
