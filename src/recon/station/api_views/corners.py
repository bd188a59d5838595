"""Where a ground grid's corners lie on the globe."""

import numpy as np

from recon.geo import geo_from_enu
from recon.model.geo import GroundGrid


def corners_lon_lat(grid: GroundGrid) -> list[tuple[float, float]]:
    """Return (longitude, latitude) of the outer corners NW, NE, SE, SW."""
    corners_enu_m = np.array(
        [
            (grid.west_m, grid.north_m, 0.0),
            (grid.east_m, grid.north_m, 0.0),
            (grid.east_m, grid.south_m, 0.0),
            (grid.west_m, grid.south_m, 0.0),
        ]
    )
    latitude_deg, longitude_deg, _height_m = geo_from_enu(grid.frame, corners_enu_m)
    return [(float(lon), float(lat)) for lon, lat in zip(longitude_deg, latitude_deg, strict=True)]
