"""Rings with fewer corners, for showing; never for deciding."""

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

FloatArray = npt.NDArray[np.float64]


def thinned_ring(ring_m: FloatArray, within_m: float) -> FloatArray:
    """Return a ring (N, 2) with fewer corners (M, 2), M >= 3; none left out is `within_m` off.

    The first corner is not repeated, neither in nor out; no tolerance leaves the ring as it is.
    """
    if within_m <= 0.0:
        return ring_m
    area = shapely.simplify(shapely.Polygon(ring_m), within_m, preserve_topology=True)
    thin: FloatArray = np.array(area.exterior.coords, dtype=np.float64)[:-1, :2]
    return thin
