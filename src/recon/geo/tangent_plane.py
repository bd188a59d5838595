"""The site's local frame for one point at a time: `local_frame` without arrays.

The same formulas on scalars: for one point they take a twentieth of the time.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import atan2, cos, degrees, hypot, radians, sin, sqrt

from recon.geo.local_frame import (
    ECCENTRICITY_SQUARED,
    FLATTENING,
    LATITUDE_ITERATIONS,
    SECOND_ECCENTRICITY_SQUARED,
    SEMI_MAJOR_AXIS_M,
    SEMI_MINOR_AXIS_M,
)
from recon.model.geo import LocalFrame

Three = tuple[float, float, float]

PLANES_KEPT = 64


@dataclass(frozen=True, slots=True)
class TangentPlane:
    """A local frame's axes and origin in earth-centred metres; see `tangent_plane`."""

    origin_m: Three
    east: Three
    north: Three
    up: Three

    def enu_m(self, latitude_deg: float, longitude_deg: float, height_m: float) -> Three:
        """Return east, north and up metres of a point at an ellipsoidal height."""
        x, y, z = _ecef_m(latitude_deg, longitude_deg, height_m)
        dx, dy, dz = x - self.origin_m[0], y - self.origin_m[1], z - self.origin_m[2]
        east, north, up = self.east, self.north, self.up
        return (
            east[0] * dx + east[1] * dy + east[2] * dz,
            north[0] * dx + north[1] * dy + north[2] * dz,
            up[0] * dx + up[1] * dy + up[2] * dz,
        )

    def place(self, east_m: float, north_m: float, up_m: float) -> Three:
        """Return latitude_deg, longitude_deg and ellipsoidal height_m of a point."""
        x, y, z = (
            origin + east_m * east + north_m * north + up_m * up
            for origin, east, north, up in zip(
                self.origin_m, self.east, self.north, self.up, strict=True
            )
        )
        return _geodetic(x, y, z)


@lru_cache(maxsize=PLANES_KEPT)
def tangent_plane(frame: LocalFrame) -> TangentPlane:
    """Return a frame's tangent plane."""
    origin = frame.origin
    latitude, longitude = radians(origin.latitude_deg), radians(origin.longitude_deg)
    sin_lat, cos_lat = sin(latitude), cos(latitude)
    sin_lon, cos_lon = sin(longitude), cos(longitude)
    return TangentPlane(
        _ecef_m(origin.latitude_deg, origin.longitude_deg, origin.ellipsoid_height_m),
        (-sin_lon, cos_lon, 0.0),
        (-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat),
        (cos_lat * cos_lon, cos_lat * sin_lon, sin_lat),
    )


def _ecef_m(latitude_deg: float, longitude_deg: float, height_m: float) -> Three:
    latitude, longitude = radians(latitude_deg), radians(longitude_deg)
    sine = sin(latitude)
    radius_m = SEMI_MAJOR_AXIS_M / sqrt(1.0 - ECCENTRICITY_SQUARED * sine * sine)
    across_m = (radius_m + height_m) * cos(latitude)
    up_m = (radius_m * (1.0 - ECCENTRICITY_SQUARED) + height_m) * sine
    return across_m * cos(longitude), across_m * sin(longitude), up_m


def _geodetic(x: float, y: float, z: float) -> Three:
    """Bowring (1976), iterated, as `ellipsoid.geodetic_from_ecef`."""
    across = hypot(x, y)
    sine, cosine = _unit(z * SEMI_MAJOR_AXIS_M, across * SEMI_MINOR_AXIS_M)
    rise = run = 0.0
    for _ in range(LATITUDE_ITERATIONS):
        rise = z + SECOND_ECCENTRICITY_SQUARED * SEMI_MINOR_AXIS_M * sine**3
        run = across - ECCENTRICITY_SQUARED * SEMI_MAJOR_AXIS_M * cosine**3
        sine, cosine = _unit((1.0 - FLATTENING) * rise, run)
    latitude = atan2(rise, run)
    foot_across = across - SEMI_MAJOR_AXIS_M * cosine
    foot_z = z - SEMI_MINOR_AXIS_M * sine
    height_m = foot_across * cos(latitude) + foot_z * sin(latitude)
    return degrees(latitude), degrees(atan2(y, x)), height_m


def _unit(rise: float, run: float) -> tuple[float, float]:
    length = hypot(rise, run)
    return rise / length, run / length
