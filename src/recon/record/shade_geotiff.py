"""Shade maps as cloud-optimised GeoTIFF: transmittance and confidence, NaN where unknown."""

import numpy as np
from rasterio.io import MemoryFile
from rasterio.transform import Affine

from recon.model.shade import ShadeMap
from recon.record.geotiff import CAPTURED_UTC_TAG, projected_crs


def shade_cog_bytes(shade: ShadeMap, captured_utc: str | None = None) -> bytes:
    """Return a file of two float32 bands, in the local frame's projection.

    The first is the share of the clear sky's direct beam, the second the confidence, both 0 to 1.
    """
    grid = shade.grid
    bands = np.stack([shade.transmittance, shade.confidence]).astype(np.float32)
    bands[:, ~shade.valid] = np.nan
    with MemoryFile() as memory:
        with memory.open(
            driver="COG",
            height=grid.rows,
            width=grid.cols,
            count=2,
            dtype="float32",
            nodata=float("nan"),
            crs=projected_crs(grid.frame),
            transform=Affine(grid.cell_m, 0.0, grid.west_m, 0.0, -grid.cell_m, grid.north_m),
            compress="deflate",
        ) as dataset:
            dataset.write(bands)
            dataset.set_band_description(1, "transmittance")
            dataset.set_band_description(2, "confidence")
            if captured_utc is not None:
                dataset.update_tags(**{CAPTURED_UTC_TAG: captured_utc})
        return bytes(memory.read())
