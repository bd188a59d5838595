"""Geometry on the ground: the site's east-north-up frame and the globe."""

from recon.geo.local_frame import (
    enu_from_geo,
    enu_from_point,
    enu_from_points,
    geo_from_enu,
    point_from_enu,
    shift_east_north_m,
)

__all__ = [
    "enu_from_geo",
    "enu_from_point",
    "enu_from_points",
    "geo_from_enu",
    "point_from_enu",
    "shift_east_north_m",
]
