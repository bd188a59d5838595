"""Penumbra: the sun is a disk, so the edge of a cloud shades the ground gradually.

From a point on the ground the disk covers an ellipse of the cloud layer. The transmittance is the
extinction averaged over that ellipse. The field that determines the extinction is taken as linear
across the ellipse, so only its slope matters: a straight edge comes out exact.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import cos, log, radians, sin, tan

import cv2
import numpy as np
import numpy.typing as npt

from recon.geo.sun import SunPosition
from recon.model.arrays import FloatArray
from recon.sim.world.fractal_field import FieldSample
from recon.sim.world.keyframes import FloatImage

SUN_DIAMETER_RAD = 0.0093
LOWEST_ELEVATION_DEG = 5.0
"""Lowest elevation used; with lower ones shadows would reach to the horizon."""

MOST_EXCESS = 18.0
EXCESS_STEP = 0.05
MOST_SPREAD = 12.0
SPREAD_STEP = 0.1
DISK_POINTS = 33


@dataclass(frozen=True, slots=True, eq=False)
class Penumbra:
    """The ellipse that the sun's disk covers on a layer, and its offset; (N,) or (1,) each."""

    across_m: FloatArray
    """Width across the sun's azimuth."""
    along_m: FloatArray
    toward_east: FloatArray
    toward_north: FloatArray
    """The unit vector to the sun's azimuth."""
    offset_m: FloatArray
    """Distance from a point on the ground to the cloud shading it, towards the sun's azimuth."""

    def at(self, numbers: npt.NDArray[np.intp]) -> "Penumbra":
        """Return the penumbrae of these numbers."""
        parts = (getattr(self, name)[numbers] for name in self.__slots__)
        return Penumbra(*parts)


def penumbra(suns: Sequence[SunPosition], height_m: float) -> Penumbra:
    """Return the penumbrae of clouds at a height, one for each sun."""
    columns = np.array([_ellipse(sun, height_m) for sun in suns], dtype=np.float64)
    return Penumbra(*columns.T)


def _ellipse(sun: SunPosition, height_m: float) -> tuple[float, ...]:
    elevation = radians(max(sun.elevation_deg, LOWEST_ELEVATION_DEG))
    azimuth = radians(sun.azimuth_deg)
    across_m = SUN_DIAMETER_RAD * height_m / sin(elevation)
    along_m = across_m / sin(elevation)
    return across_m, along_m, sin(azimuth), cos(azimuth), height_m / tan(elevation)


def spread(edge: Penumbra, axes_rad: float, field: FieldSample) -> FloatImage:
    """Return the field's rise from the ellipse's middle to its end, (N,).

    The field's y axis points to azimuth `axes_rad`, its x axis to the right of it.
    """
    x_east, y_east = cos(axes_rad), sin(axes_rad)
    toward_x = (edge.toward_east * x_east - edge.toward_north * y_east).astype(np.float32)
    toward_y = (edge.toward_east * y_east + edge.toward_north * x_east).astype(np.float32)
    along = field.slope_x_per_m * toward_x + field.slope_y_per_m * toward_y
    along *= edge.along_m.astype(np.float32)
    across = field.slope_x_per_m * toward_y - field.slope_y_per_m * toward_x
    across *= edge.across_m.astype(np.float32)
    half: FloatImage = np.float32(0.5) * np.sqrt(along * along + across * across)
    return half


def extinction(excess: FloatArray, largest_depth: float) -> FloatArray:
    """Return the beam's share behind a cloud whose field is `excess` softnesses over the threshold.

    The optical depth grows e-fold per softness up to about `largest_depth`. At the threshold half
    of the beam passes; if the layer never dims so much, half of its depth applies there.
    """
    half = log(2.0)
    # Chosen such that the transmittance at the threshold (excess 0) is one half.
    start = half * largest_depth / (largest_depth - half) if largest_depth > half else largest_depth
    free = start * np.exp(excess)
    share: FloatArray = np.exp(-free * largest_depth / (free + largest_depth))
    return share


@lru_cache(maxsize=8)
def extinction_table(largest_depth: float) -> FloatImage:
    """Return the extinction averaged over the sun's disk: a row per excess, a column per spread.

    Along a slope the disk weighs like a half circle: Gauss's points for that weight.
    """
    rows = round(2.0 * MOST_EXCESS / EXCESS_STEP) + 1
    cols = round(MOST_SPREAD / SPREAD_STEP) + 1
    # Gauss-Chebyshev quadrature of the second kind: exact weights for a half circle.
    angles = np.arange(1, DISK_POINTS + 1) * np.pi / (DISK_POINTS + 1)
    weights = np.sin(angles) ** 2 / np.sum(np.sin(angles) ** 2)
    excess = np.linspace(-MOST_EXCESS, MOST_EXCESS, rows)[:, np.newaxis, np.newaxis]
    spreads = np.linspace(0.0, MOST_SPREAD, cols)[np.newaxis, :, np.newaxis]
    # The table is not extended for lookups beyond it: there the share is practically 0 or 1.
    shares = extinction(excess + spreads * np.cos(angles), largest_depth)
    table: FloatImage = (shares @ weights).astype(np.float32)
    return table


def look_up(table: FloatImage, excess: FloatImage, spreads: FloatImage) -> FloatImage:
    """Return the beam's share at (R, C) points; beyond the table's edges as at them."""
    rows = (excess + np.float32(MOST_EXCESS)) * np.float32(1.0 / EXCESS_STEP)
    cols = spreads * np.float32(1.0 / SPREAD_STEP)
    found = cv2.remap(table, cols, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return found.astype(np.float32, copy=False)
