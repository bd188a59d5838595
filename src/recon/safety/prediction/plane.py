"""Positions in one plane, fast enough for every vehicle ten times a second.

East and north are linear in longitude and latitude about the origin, by the radii of curvature
there. Within 10 km that scales every distance by less than 0.2 %: 3 cm in 15 m.
"""

from recon.geo import OnGlobe
from recon.geo.distance import offset_north_east_m
from recon.model.geo import LatLon


class Plane:
    """The tangent plane at a position."""

    def __init__(self, origin: OnGlobe) -> None:
        self._latitude_deg = origin.latitude_deg
        self._longitude_deg = origin.longitude_deg
        here = LatLon(origin.latitude_deg, origin.longitude_deg)
        there = LatLon(origin.latitude_deg + 1.0, origin.longitude_deg + 1.0)
        self._north_m_per_deg, self._east_m_per_deg = offset_north_east_m(here, there)

    def east_north_m(self, place: OnGlobe) -> tuple[float, float]:
        """Return how far east and north of the origin a place lies."""
        east_deg = (place.longitude_deg - self._longitude_deg + 180.0) % 360.0 - 180.0
        north_deg = place.latitude_deg - self._latitude_deg
        return east_deg * self._east_m_per_deg, north_deg * self._north_m_per_deg
