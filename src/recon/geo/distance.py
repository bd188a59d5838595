"""Short distances between positions, scalar and without an origin of the site.

The WGS84 radii of curvature at the first point make a tangent plane: within 10 km the error stays
under 0.2 % up to 60 degrees of latitude.
"""

from math import cos, hypot, radians, sin, sqrt

from recon.model.geo import LatLon

SEMI_MAJOR_AXIS_M = 6_378_137.0
ECCENTRICITY_SQUARED = 6.694379990141317e-3


def offset_north_east_m(origin: LatLon, point: LatLon) -> tuple[float, float]:
    """Return how far north and east of `origin` a point lies, in metres."""
    sine = sin(radians(origin.latitude_deg))
    w = sqrt(1.0 - ECCENTRICITY_SQUARED * sine * sine)
    meridian_m = SEMI_MAJOR_AXIS_M * (1.0 - ECCENTRICITY_SQUARED) / w**3
    prime_vertical_m = SEMI_MAJOR_AXIS_M / w
    east_deg = (point.longitude_deg - origin.longitude_deg + 180.0) % 360.0 - 180.0
    return (
        radians(point.latitude_deg - origin.latitude_deg) * meridian_m,
        radians(east_deg) * prime_vertical_m * cos(radians(origin.latitude_deg)),
    )


def horizontal_distance_m(a: LatLon, b: LatLon) -> float:
    """Return the horizontal distance between two positions, in metres."""
    return hypot(*offset_north_east_m(a, b))
