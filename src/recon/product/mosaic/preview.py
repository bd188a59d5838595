"""A mosaic's picture for a page: small, and transparent where the mosaic is empty."""

from io import BytesIO
from pathlib import Path

import numpy as np
import rasterio
from PIL import Image
from rasterio.enums import Resampling

LONGEST_SIDE_PX = 1_200
DARKEST, BRIGHTEST = 1.0, 99.0
"""Percentiles that become black and white, where a band is no picture."""


def preview_png(raster: Path) -> bytes:
    """Return a PNG of a band's raster, read from its overviews."""
    with rasterio.open(raster) as dataset:
        shrunk = max(1.0, max(dataset.width, dataset.height) / LONGEST_SIDE_PX)
        size = max(1, round(dataset.height / shrunk)), max(1, round(dataset.width / shrunk))
        shape = (dataset.count, *size)
        values = dataset.read(out_shape=shape, resampling=Resampling.nearest)
        # By alpha, or by the value of no data.
        alpha = dataset.dataset_mask(out_shape=size)
    alpha = np.where(alpha > 0, np.uint8(255), np.uint8(0))
    colours = values[:3] if values.shape[0] > 3 else np.repeat(values[:1], 3, axis=0)
    if colours.dtype != np.uint8 and alpha.any():
        low, high = np.percentile(colours[:, alpha > 0], [DARKEST, BRIGHTEST])
        colours = np.clip((colours - low) * (255.0 / max(high - low, 1.0)), 0.0, 255.0)
    picture = np.concatenate([colours[:3].astype(np.uint8), alpha[np.newaxis]])
    used = np.flatnonzero(alpha.any(axis=0)), np.flatnonzero(alpha.any(axis=1))
    if len(used[0]):
        picture = picture[:, used[1][0] : used[1][-1] + 1, used[0][0] : used[0][-1] + 1]
    out = BytesIO()
    Image.fromarray(np.ascontiguousarray(np.moveaxis(picture, 0, -1))).save(out, "PNG")
    return out.getvalue()
