"""The site's local frame: east-north-up metres, tangent to the WGS84 ellipsoid at its origin.

All heights are ellipsoidal. The frame is flat and the earth is not: a point at the origin's own
height lies d^2 / 12,756 km below the plane at distance d (5 mm at 256 m, 8 cm at 1 km).

`TangentPlane` has the same formulas on scalars: for one point they take a twentieth of the time.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from math import atan2, cos, degrees, hypot, radians, sin, sqrt
from typing import Protocol

import numpy as np
import numpy.typing as npt

from recon.model.arrays import FloatArray
from recon.model.geo import GeoPoint, LocalFrame

SEMI_MAJOR_AXIS_M = 6_378_137.0
FLATTENING = 1.0 / 298.257223563
SEMI_MINOR_AXIS_M = SEMI_MAJOR_AXIS_M * (1.0 - FLATTENING)
ECCENTRICITY_SQUARED = FLATTENING * (2.0 - FLATTENING)
SECOND_ECCENTRICITY_SQUARED = ECCENTRICITY_SQUARED / (1.0 - ECCENTRICITY_SQUARED)

LATITUDE_ITERATIONS = 3
"""Bowring's formula is off by under a nanometre near the ground after two; one to spare."""


def prime_vertical_radius_m(latitude_rad: FloatArray) -> FloatArray:
    """Return the radius of curvature in the east-west direction, any shape."""
    sine: FloatArray = np.sin(latitude_rad)
    return SEMI_MAJOR_AXIS_M / np.sqrt(1.0 - ECCENTRICITY_SQUARED * sine * sine)


def meridian_radius_m(latitude_rad: FloatArray) -> FloatArray:
    """Return the radius of curvature in the north-south direction, any shape."""
    radius = prime_vertical_radius_m(latitude_rad)
    return radius**3 * (1.0 - ECCENTRICITY_SQUARED) / SEMI_MAJOR_AXIS_M**2


def ecef_from_geodetic(
    latitude_rad: FloatArray, longitude_rad: FloatArray, height_m: FloatArray
) -> FloatArray:
    """Return earth-centred, earth-fixed metres (N, 3) of N points."""
    radius = prime_vertical_radius_m(latitude_rad)
    across = (radius + height_m) * np.cos(latitude_rad)
    return np.stack(
        [
            across * np.cos(longitude_rad),
            across * np.sin(longitude_rad),
            (radius * (1.0 - ECCENTRICITY_SQUARED) + height_m) * np.sin(latitude_rad),
        ],
        axis=-1,
    )


def geodetic_from_ecef(ecef_m: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return latitude, longitude (radians) and ellipsoidal height (metres) of (N, 3) points.

    Bowring (1976), iterated; for points within some hundred kilometres of the surface.
    """
    x, y, z = ecef_m[..., 0], ecef_m[..., 1], ecef_m[..., 2]
    across = np.hypot(x, y)
    # The parametric latitude, as sine and cosine so that the poles need no special case.
    sine, cosine = _unit(z * SEMI_MAJOR_AXIS_M, across * SEMI_MINOR_AXIS_M)
    for _ in range(LATITUDE_ITERATIONS):
        rise = z + SECOND_ECCENTRICITY_SQUARED * SEMI_MINOR_AXIS_M * sine**3
        run = across - ECCENTRICITY_SQUARED * SEMI_MAJOR_AXIS_M * cosine**3
        sine, cosine = _unit((1.0 - FLATTENING) * rise, run)
    latitude = np.arctan2(rise, run)
    # Height along the normal: no division by cos(latitude), so it works at the poles.
    foot_across = across - SEMI_MAJOR_AXIS_M * cosine
    foot_z = z - SEMI_MINOR_AXIS_M * sine
    height = foot_across * np.cos(latitude) + foot_z * np.sin(latitude)
    return latitude, np.arctan2(y, x), height


def _unit(rise: FloatArray, run: FloatArray) -> tuple[FloatArray, FloatArray]:
    length = np.hypot(rise, run)
    return rise / length, run / length


FRAMES_KEPT = 64
"""A site has one frame; without a site each vehicle temporarily has its own."""


class OnGlobe(Protocol):
    """Anything with latitude and longitude."""

    @property
    def latitude_deg(self) -> float:
        """WGS84 latitude."""

    @property
    def longitude_deg(self) -> float:
        """WGS84 longitude."""


def enu_from_geo(
    frame: LocalFrame,
    latitude_deg: npt.ArrayLike,
    longitude_deg: npt.ArrayLike,
    height_m: npt.ArrayLike,
) -> FloatArray:
    """Return east-north-up metres (N, 3) of N points; scalars give (1, 3).

    The three inputs broadcast against each other. NaN in gives NaN out.
    """
    latitude, longitude, height = np.broadcast_arrays(
        np.atleast_1d(np.asarray(latitude_deg, dtype=np.float64)),
        np.atleast_1d(np.asarray(longitude_deg, dtype=np.float64)),
        np.atleast_1d(np.asarray(height_m, dtype=np.float64)),
    )
    ecef = ecef_from_geodetic(np.deg2rad(latitude), np.deg2rad(longitude), height)
    offset: FloatArray = ecef - _origin_ecef(frame)
    return offset @ _rotation_enu_ecef(frame).T


def geo_from_enu(
    frame: LocalFrame, enu_m: npt.ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return latitude_deg, longitude_deg, ellipsoidal height_m, each (N,), of (N, 3) points."""
    enu = np.atleast_2d(np.asarray(enu_m, dtype=np.float64))
    ecef: FloatArray = enu @ _rotation_enu_ecef(frame) + _origin_ecef(frame)
    latitude, longitude, height = geodetic_from_ecef(ecef)
    return np.rad2deg(latitude), np.rad2deg(longitude), height


def enu_from_point(frame: LocalFrame, point: GeoPoint) -> FloatArray:
    """Return east-north-up metres (3,) of one point."""
    enu = enu_from_geo(frame, point.latitude_deg, point.longitude_deg, point.ellipsoid_height_m)
    first: FloatArray = enu[0]
    return first


def enu_from_points(frame: LocalFrame, points: Iterable[GeoPoint]) -> FloatArray:
    """Return east-north-up metres (N, 3) of N points; (0, 3) for none."""
    rows = [(p.latitude_deg, p.longitude_deg, p.ellipsoid_height_m) for p in points]
    latitude, longitude, height = np.array(rows, dtype=np.float64).reshape(-1, 3).T
    return enu_from_geo(frame, latitude, longitude, height)


def shift_east_north_m(frame: LocalFrame, start: OnGlobe, end: OnGlobe) -> FloatArray:
    """Return the displacement east and north (2,) from `start` to `end`, at the origin's height."""
    enu = enu_from_geo(
        frame,
        [start.latitude_deg, end.latitude_deg],
        [start.longitude_deg, end.longitude_deg],
        frame.origin.ellipsoid_height_m,
    )
    shift: FloatArray = enu[1, :2] - enu[0, :2]
    return shift


def point_from_enu(frame: LocalFrame, enu_m: npt.ArrayLike) -> GeoPoint:
    """Return the WGS84 point of one (3,) east-north-up position."""
    latitude, longitude, height = geo_from_enu(frame, enu_m)
    return GeoPoint(float(latitude[0]), float(longitude[0]), float(height[0]))


@lru_cache(maxsize=FRAMES_KEPT)
def _origin_ecef(frame: LocalFrame) -> FloatArray:
    origin = frame.origin
    return ecef_from_geodetic(
        np.deg2rad(np.asarray(origin.latitude_deg)),
        np.deg2rad(np.asarray(origin.longitude_deg)),
        np.asarray(origin.ellipsoid_height_m),
    )


@lru_cache(maxsize=FRAMES_KEPT)
def _rotation_enu_ecef(frame: LocalFrame) -> FloatArray:
    """Rows: east, north and up at the origin, in earth-centred axes."""
    latitude = np.deg2rad(frame.origin.latitude_deg)
    longitude = np.deg2rad(frame.origin.longitude_deg)
    sin_lat, cos_lat = np.sin(latitude), np.cos(latitude)
    sin_lon, cos_lon = np.sin(longitude), np.cos(longitude)
    return np.array(
        [
            [-sin_lon, cos_lon, 0.0],
            [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
            [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
        ]
    )


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
        origin_m, east, north, up = self.origin_m, self.east, self.north, self.up
        return _geodetic(
            origin_m[0] + east_m * east[0] + north_m * north[0] + up_m * up[0],
            origin_m[1] + east_m * east[1] + north_m * north[1] + up_m * up[1],
            origin_m[2] + east_m * east[2] + north_m * north[2] + up_m * up[2],
        )


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
    sine, cosine = _unit_of_two(z * SEMI_MAJOR_AXIS_M, across * SEMI_MINOR_AXIS_M)
    rise = run = 0.0
    for _ in range(LATITUDE_ITERATIONS):
        rise = z + SECOND_ECCENTRICITY_SQUARED * SEMI_MINOR_AXIS_M * sine**3
        run = across - ECCENTRICITY_SQUARED * SEMI_MAJOR_AXIS_M * cosine**3
        sine, cosine = _unit_of_two((1.0 - FLATTENING) * rise, run)
    latitude = atan2(rise, run)
    foot_across = across - SEMI_MAJOR_AXIS_M * cosine
    foot_z = z - SEMI_MINOR_AXIS_M * sine
    height_m = foot_across * cos(latitude) + foot_z * sin(latitude)
    return degrees(latitude), degrees(atan2(y, x)), height_m


def _unit_of_two(rise: float, run: float) -> tuple[float, float]:
    length = hypot(rise, run)
    return rise / length, run / length
