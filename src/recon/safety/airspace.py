"""A site's air made ready for many questions."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from recon.geo import Polygon, Surface
from recon.model.airspace import Airspace
from recon.model.zone import Zone

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class PreparedZone:
    """A zone and its polygon."""

    zone: Zone
    polygon: Polygon


class PreparedAirspace:
    """An airspace whose polygons and ground are prepared once; build one for each site, keep it.

    Heights of the ground are up_m: ellipsoidal, minus that of the frame's origin. Without an
    elevation model the ground is flat at 0; with one, ground that it does not tell is NaN, the
    highest of it +inf and the lowest -inf.
    Raises `ValueError` for a polygon that is none, or an elevation model that is no surface.
    """

    def __init__(self, airspace: Airspace) -> None:
        self.airspace = airspace
        boundary = airspace.boundary
        self.boundary = None if boundary is None else Polygon(boundary)
        self.zones = tuple(PreparedZone(zone, Polygon(zone.region)) for zone in airspace.zones)
        self._ground = _ground(airspace)

    def ground_up_m(self, points_m: npt.ArrayLike) -> FloatArray:
        """Return the ground's heights (N,) at (N, 2) east-north points."""
        points = np.asarray(points_m, dtype=np.float64).reshape(-1, 2)
        return np.zeros(len(points)) if self._ground is None else self._ground.heights_m(points)

    def highest_ground_up_m(self, starts_m: FloatArray, ends_m: FloatArray) -> FloatArray:
        """Return the highest ground (N,) under straight legs from (N, 2) to (N, 2), exactly."""
        if self._ground is None:
            return np.zeros(len(starts_m))
        return self._ground.highest_along_m(starts_m, ends_m)

    def lowest_ground_up_m(self, starts_m: FloatArray, ends_m: FloatArray) -> FloatArray:
        """Return the lowest ground (N,) under straight legs from (N, 2) to (N, 2), exactly."""
        if self._ground is None:
            return np.zeros(len(starts_m))
        return self._ground.lowest_along_m(starts_m, ends_m)

    def highest_ground_within_up_m(self, triangles_m: FloatArray) -> FloatArray:
        """Return the highest ground (N,) under (N, 3, 2) triangles, exactly."""
        if self._ground is None:
            return np.zeros(len(triangles_m))
        return self._ground.highest_within_m(triangles_m)

    def lowest_ground_within_up_m(self, triangles_m: FloatArray) -> FloatArray:
        """Return the lowest ground (N,) under (N, 3, 2) triangles, exactly."""
        if self._ground is None:
            return np.zeros(len(triangles_m))
        return self._ground.lowest_within_m(triangles_m)


def _ground(airspace: Airspace) -> Surface | None:
    model, frame = airspace.elevation, airspace.frame
    if model is None or frame is None:
        return None
    return Surface(model.grid, model.ellipsoid_height_m - frame.origin.ellipsoid_height_m)


OPEN_AIRSPACE = PreparedAirspace(Airspace())
"""No site: no fence is known, the limits' defaults hold."""
