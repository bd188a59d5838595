"""Ground of known shape under the fields: a site's elevation model by construction."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from tests.guidance.survey.fields import FRAME

from recon.geo import cell_centres_m
from recon.model.airspace import ElevationModel
from recon.model.geo import GroundGrid, LocalFrame

FloatArray = npt.NDArray[np.float64]
Ground = Callable[[FloatArray, FloatArray], FloatArray]
"""Heights up of the frame at easts and norths of one shape."""


def flat(east_m: FloatArray, north_m: FloatArray) -> FloatArray:
    return np.zeros(np.broadcast(east_m, north_m).shape)


def slope(east_m: FloatArray, north_m: FloatArray) -> FloatArray:
    """A plane that rises by a tenth eastwards."""
    return 0.1 * east_m + 0.0 * north_m


def ridge(east_m: FloatArray, north_m: FloatArray) -> FloatArray:
    """A roof along north at 150 m east, 15 m above what lies 150 m beside it."""
    return 15.0 - 0.1 * np.abs(east_m - 150.0) + 0.0 * north_m


def hills(seed: int, steepest: float = 0.25) -> Ground:
    """Waves in random directions, nowhere steeper than that."""
    rng = np.random.default_rng(seed)
    waves = [
        (rng.uniform(0.0, 2.0 * np.pi), rng.uniform(80.0, 400.0), rng.uniform(0.0, 6.3))
        for _ in range(4)
    ]

    def ground(east_m: FloatArray, north_m: FloatArray) -> FloatArray:
        up_m = np.zeros(np.broadcast(east_m, north_m).shape)
        for bearing, length_m, phase in waves:
            along_m = east_m * np.sin(bearing) + north_m * np.cos(bearing)
            # A wave of this height is as steep as its share.
            up_m += (
                steepest
                / len(waves)
                * length_m
                / 6.283
                * np.sin(6.283 * along_m / length_m + phase)
            )
        return up_m

    return ground


def model(
    ground: Ground,
    cell_m: float = 5.0,
    reach_m: float = 600.0,
    frame: LocalFrame = FRAME,
) -> ElevationModel:
    """A model of the ground so far around the frame's origin."""
    count = round(2.0 * reach_m / cell_m)
    grid = GroundGrid(frame, -reach_m, reach_m, cell_m, count, count)
    east_m, north_m = np.meshgrid(*cell_centres_m(grid))
    return ElevationModel(grid, ground(east_m, north_m) + frame.origin.ellipsoid_height_m)
