"""The site's local frame: east-north-up metres, tangent to the WGS84 ellipsoid at its origin.

All heights are ellipsoidal. The frame is flat and the earth is not: a point at the origin's own
height lies d^2 / 12,756 km below the plane at distance d (5 mm at 256 m, 8 cm at 1 km).
"""

from collections.abc import Iterable
from functools import lru_cache
from typing import Protocol

import numpy as np
import numpy.typing as npt

from recon.geo.ellipsoid import ecef_from_geodetic, geodetic_from_ecef
from recon.model.geo import GeoPoint, LocalFrame

FloatArray = npt.NDArray[np.float64]


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
