"""Predicted sun as a GeoTIFF beside the map it was made from, with its place and cells."""

import warnings
from pathlib import Path

import numpy as np
import rasterio
from rasterio.errors import NotGeoreferencedWarning, RasterioError

from recon.model.errors import RecordError
from recon.model.shade import FloatMap, MaskMap


def write_sun(path: Path, like: Path, probability: FloatMap, is_seen_coming: MaskMap) -> None:
    """Write two float32 bands (R, C): the probability of sun, and 1 where its clouds are in view.

    Place and cells are those of the raster `like`. Raises `RecordError`.
    """
    bands = np.stack([probability, is_seen_coming.astype(np.float32)]).astype(np.float32)
    try:
        with warnings.catch_warnings(action="ignore", category=NotGeoreferencedWarning):
            with rasterio.open(like) as source:
                crs, transform = source.crs, source.transform
            with rasterio.open(
                path,
                "w",
                driver="GTiff",
                height=bands.shape[1],
                width=bands.shape[2],
                count=2,
                dtype="float32",
                nodata=float("nan"),
                crs=crs,
                transform=transform,
                compress="deflate",
            ) as dataset:
                dataset.write(bands)
                dataset.set_band_description(1, "probability of sun")
                dataset.set_band_description(2, "its clouds are in view")
    except (RasterioError, OSError) as problem:
        raise RecordError(f"{path}: expected to write a GeoTIFF, got: {problem}") from problem
