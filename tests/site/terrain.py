"""GeoTIFFs of made-up ground, for sites around one origin."""

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from pyproj import Transformer
from rasterio.errors import NotGeoreferencedWarning
from rasterio.io import MemoryFile
from rasterio.transform import Affine

from recon.geo import enu_from_geo, geo_from_enu
from recon.model.geo import GeoPoint, LocalFrame
from recon.site import Site, load_site

FloatArray = npt.NDArray[np.float64]
Ground = Callable[[FloatArray, FloatArray], FloatArray]
"""Ellipsoidal heights of the ground at east and north metres."""

ORIGIN = GeoPoint(41.9012, -93.6034, 275.0)
FRAME = LocalFrame(ORIGIN)
UTM_15N = "EPSG:32615"
HEAD = """name = "a field"
[origin]
latitude_deg = 41.9012
longitude_deg = -93.6034
ground_altitude_m = 275.0
[limits]
max_distance_from_home_m = 200
"""


def plane(east_m: FloatArray, north_m: FloatArray) -> FloatArray:
    return 275.0 + 0.02 * east_m - 0.03 * north_m


def ridge(east_m: FloatArray, north_m: FloatArray) -> FloatArray:
    return 275.0 + np.maximum(0.0, 30.0 - 0.5 * np.abs(east_m - 80.0)) + 0.0 * north_m


def geotiff(
    ground: Ground = plane,
    crs: str = UTM_15N,
    pixel: float = 5.0,
    half_side: float = 400.0,
    dtype: str = "float64",
    change: Callable[[FloatArray], FloatArray] = lambda heights: heights,
    **more: Any,
) -> bytes:
    """Return a file whose pixels hold the ground's height in their middles; pixel in crs units."""
    transform, side = square(crs, pixel, half_side)
    heights = change(ground(*middles_m(crs, transform, side)))
    return written(heights.astype(dtype), crs=crs, transform=transform, **more)


def square(crs: str, pixel: float, half_side: float) -> tuple[Affine, int]:
    """Return the transform and the side in pixels of a square around the origin."""
    x, y = Transformer.from_crs("EPSG:4326", crs, always_xy=True).transform(
        ORIGIN.longitude_deg, ORIGIN.latitude_deg
    )
    side = int(2 * half_side / pixel)
    return Affine(pixel, 0.0, x - half_side + pixel / 3, 0.0, -pixel, y + half_side), side


def middles_m(crs: str, transform: Affine, side: int) -> tuple[FloatArray, FloatArray]:
    """Return the east and north metres of the pixels' middles, each (side, side)."""
    cols, rows = np.meshgrid(np.arange(side) + 0.5, np.arange(side) + 0.5)
    x, y = transform @ (cols.ravel(), rows.ravel())
    longitude, latitude = Transformer.from_crs(crs, "EPSG:4326", always_xy=True).transform(x, y)
    enu = enu_from_geo(FRAME, latitude, longitude, ORIGIN.ellipsoid_height_m)
    return enu[:, 0].reshape(side, side), enu[:, 1].reshape(side, side)


def pixels_at(crs: str, transform: Affine, places_m: FloatArray) -> npt.NDArray[np.int64]:
    """Return the row and column (N, 2) of the pixel around each east-north place."""
    points = np.column_stack([places_m, np.zeros(len(places_m))])
    latitude, longitude, _ = geo_from_enu(FRAME, points)
    x, y = Transformer.from_crs("EPSG:4326", crs, always_xy=True).transform(longitude, latitude)
    cols, rows = ~transform @ (x, y)
    return np.floor(np.column_stack([rows, cols])).astype(np.int64)


def written(bands: npt.NDArray[Any], **profile: Any) -> bytes:
    """Return a GeoTIFF of one band (R, C) or several (N, R, C)."""
    stack = bands[np.newaxis] if bands.ndim == 2 else bands
    profile = {"driver": "GTiff", "dtype": stack.dtype.name, **profile}
    profile = {key: value for key, value in profile.items() if value is not None}
    unit = profile.pop("unit", None)
    with warnings.catch_warnings(), MemoryFile() as memory:
        # Some tests need a file without georeferencing.
        warnings.simplefilter("ignore", NotGeoreferencedWarning)
        count, height, width = stack.shape
        with memory.open(count=count, height=height, width=width, **profile) as dataset:
            dataset.write(stack)
            if unit is not None:
                dataset.units = [unit] * count
        return bytes(memory.read())


def load(
    folder: Path, tiff: bytes, table: str = 'datum = "wgs84"', more: str = "", head: str = HEAD
) -> Site:
    """Return the site of a folder with this elevation model."""
    (folder / "ground.tif").write_bytes(tiff)
    (folder / "site.toml").write_text(
        f'{head}[elevation]\nfile = "ground.tif"\n{table}\n{more}', encoding="utf-8"
    )
    return load_site(folder)
