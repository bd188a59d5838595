"""Where drawn scenes lie on the globe: metres east and north of one origin, and back to degrees."""

import numpy as np
import numpy.typing as npt

from recon.model.geo import GeoPoint, LatLon

FloatArray = npt.NDArray[np.float64]

ORIGIN = GeoPoint(41.9, -93.6, 275.0)
METRES_PER_LATITUDE = 111_076.2
METRES_PER_LONGITUDE = 82_983.9
"""At 41.9 degrees north, to a centimetre within the scene: the WGS84 radii of curvature there."""
NOW_NS = 10**11


def degrees(point_m: FloatArray) -> tuple[float, float]:
    """Return latitude and longitude of a point's first two metres, east and north."""
    return (
        ORIGIN.latitude_deg + float(point_m[1]) / METRES_PER_LATITUDE,
        ORIGIN.longitude_deg + float(point_m[0]) / METRES_PER_LONGITUDE,
    )


def lat_lon(point_m: FloatArray) -> LatLon:
    """Return the position of a point."""
    return LatLon(*degrees(point_m))
