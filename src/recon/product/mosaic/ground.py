"""The ground that a mosaic lies on: level, a site's elevation model, or a surface model.

Heights are metres above the tangent plane at the site's origin, so that rays are straight in them.
"""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from recon.geo import Surface
from recon.model.airspace import ElevationModel
from recon.model.arrays import FloatArray

EARTH_RADIUS_M = 6_371_000.0


class MosaicGround(Protocol):
    """Heights of the ground; several threads may ask at once."""

    @property
    def is_rough(self) -> bool:
        """Whether it has plants and houses: then heights change within decimetres."""

    def up_m(self, east_m: FloatArray, north_m: FloatArray) -> FloatArray:
        """Return the heights (rows, cols) at easts (cols,) and norths (rows,); NaN if unknown."""

    @property
    def bounds_m(self) -> tuple[float, float]:
        """The lowest and the highest ground."""


def fall_m(east_m: FloatArray, north_m: FloatArray) -> FloatArray:
    """Return how far the ellipsoid has fallen below the tangent plane at (...) places."""
    return np.asarray((east_m**2 + north_m**2) / (2.0 * EARTH_RADIUS_M))


@dataclass(frozen=True, slots=True)
class LevelGround:
    """Ground as high as the place that photos' heights are above."""

    is_rough: bool = False

    def up_m(self, east_m: FloatArray, north_m: FloatArray) -> FloatArray:
        """Return zeros."""
        return np.zeros((len(north_m), len(east_m)))

    @property
    def bounds_m(self) -> tuple[float, float]:
        """Zero."""
        return 0.0, 0.0


@dataclass(slots=True)
class SiteGround:
    """A site's elevation model."""

    model: ElevationModel
    is_rough: bool = False
    _surface: Surface = field(init=False)

    def __post_init__(self) -> None:
        grid = self.model.grid
        self._surface = Surface(grid, self.model.ellipsoid_height_m)

    def up_m(self, east_m: FloatArray, north_m: FloatArray) -> FloatArray:
        """Return the heights (rows, cols) at easts (cols,) and norths (rows,)."""
        easts, norths = np.meshgrid(east_m, north_m)
        origin_m = self.model.grid.frame.origin.ellipsoid_height_m
        heights = self._surface.heights_m(np.column_stack([easts.ravel(), norths.ravel()]))
        return heights.reshape(easts.shape) - origin_m - fall_m(easts, norths)

    @property
    def bounds_m(self) -> tuple[float, float]:
        """The model's extremes."""
        heights = self.model.ellipsoid_height_m - self.model.grid.frame.origin.ellipsoid_height_m
        return float(np.nanmin(heights)), float(np.nanmax(heights))
