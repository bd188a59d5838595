"""Short distances between positions, scalar and without an origin of the site.

The WGS84 radii of curvature at the first point make a tangent plane: within 10 km the error stays
under 0.2 % up to 60 degrees of latitude.
"""

from functools import lru_cache
from math import cos, degrees, floor, hypot, log10, radians, sin, sqrt

from recon.geo.local_frame import OnGlobe
from recon.model.geo import LatLon

SEMI_MAJOR_AXIS_M = 6_378_137.0
ECCENTRICITY_SQUARED = 6.694379990141317e-3


LATITUDES_KEPT = 256
"""Cached: distances are computed from the same few homes and waypoints again and again."""


def offset_north_east_m(origin: OnGlobe, point: OnGlobe) -> tuple[float, float]:
    """Return the offset north and east, in metres, of a point from `origin`."""
    north_m, east_m = _metres_per_radian(origin.latitude_deg)
    # Wrap around the antimeridian.
    east_deg = (point.longitude_deg - origin.longitude_deg + 180.0) % 360.0 - 180.0
    return (
        radians(point.latitude_deg - origin.latitude_deg) * north_m,
        radians(east_deg) * east_m,
    )


def moved_m(origin: LatLon, north_m: float, east_m: float) -> LatLon:
    """Return the position at this offset from `origin`: the inverse of `offset_north_east_m`.

    Not valid within metres of a pole, where east is undefined.
    """
    per_north_m, per_east_m = _metres_per_radian(origin.latitude_deg)
    longitude_deg = origin.longitude_deg + degrees(east_m / per_east_m)
    return LatLon(
        origin.latitude_deg + degrees(north_m / per_north_m),
        (longitude_deg + 180.0) % 360.0 - 180.0,
    )


def horizontal_distance_m(a: OnGlobe, b: OnGlobe) -> float:
    """Return the horizontal distance between two positions, in metres."""
    return hypot(*offset_north_east_m(a, b))


@lru_cache(maxsize=LATITUDES_KEPT)
def _metres_per_radian(latitude_deg: float) -> tuple[float, float]:
    """Return metres per radian of latitude and of longitude."""
    latitude_rad = radians(latitude_deg)
    w = sqrt(1.0 - ECCENTRICITY_SQUARED * sin(latitude_rad) ** 2)
    meridian_m = SEMI_MAJOR_AXIS_M * (1.0 - ECCENTRICITY_SQUARED) / w**3
    return meridian_m, SEMI_MAJOR_AXIS_M / w * cos(latitude_rad)


def round_length_m(most_m: float) -> float:
    """Return the longest of 1, 2, 5 times a power of ten that is no more: for a scale bar."""
    # A logarithm just under a whole number is rounded up to it: the power below is tried as well.
    exponent = floor(log10(most_m))
    lengths = (step * 10.0**power for power in (exponent, exponent - 1) for step in (5, 2, 1))
    return next(length_m for length_m in lengths if length_m <= most_m)
