"""Geometry on the ground: the site's east-north-up frame, WGS84, regions, surfaces, paths, the sun.

Lengths are metres; local coordinates are east, north, up of the site's origin. Array functions take
and return (N, 2) or (N, 3) float64; NaN or infinity gives the safe answer, never an exception.
"""

from recon.geo.distance import round_length_m
from recon.geo.grid_cells import cell_at, cell_centres_m, cells_of, nearest_cells, read_at
from recon.geo.local_frame import (
    OnGlobe,
    TangentPlane,
    enu_from_geo,
    enu_from_point,
    enu_from_points,
    geo_from_enu,
    point_from_enu,
    shift_east_north_m,
    tangent_plane,
)
from recon.geo.path import DEFAULT_CHORD_ERROR_M, Path, corner_hulls, rounded_path, straight_path
from recon.geo.polygon import (
    Box,
    Footprints,
    Polygon,
    geojson_geometry,
    region_fault,
    shape_of,
    thinned_ring,
)
from recon.geo.sun import SunPosition, sun_position, utc_at_elevation
from recon.geo.surface import Surface
