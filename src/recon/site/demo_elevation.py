"""The demonstration's elevation model: flat, as the simulator's ground is.

Simulated aircraft stand on one plane, and the simulated lens looks at it: a hill in this file would
be one that nothing else in the demonstration knows of. So the file shows how a model is given, and
the rules of height work with it as with any other.
"""

import numpy as np
from rasterio.io import MemoryFile
from rasterio.transform import Affine

from recon.model.geo import LocalFrame

ELEVATION_FILE = "ground.tif"
PIXEL_DEG = 0.0005
"""56 m north, 41 m east."""
PIXELS = 64


def demo_elevation_bytes(frame: LocalFrame) -> bytes:
    """Return a GeoTIFF in degrees of WGS84 around the origin, all at its height."""
    origin = frame.origin
    half_deg = PIXELS / 2 * PIXEL_DEG
    west_deg, north_deg = origin.longitude_deg - half_deg, origin.latitude_deg + half_deg
    heights_m = np.full((1, PIXELS, PIXELS), origin.ellipsoid_height_m, np.float32)
    with MemoryFile() as memory:
        with memory.open(
            driver="GTiff",
            count=1,
            height=PIXELS,
            width=PIXELS,
            dtype="float32",
            crs="EPSG:4326",
            transform=Affine(PIXEL_DEG, 0.0, west_deg, 0.0, -PIXEL_DEG, north_deg),
            compress="deflate",
        ) as dataset:
            dataset.write(heights_m)
        return bytes(memory.read())
