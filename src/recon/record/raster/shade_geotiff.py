"""Maps of a site's ground as cloud-optimised GeoTIFF, and shade maps as such ones."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from rasterio.io import MemoryFile
from rasterio.transform import Affine

from recon.model.geo import GroundGrid
from recon.model.shade import FloatMap, ShadeMap
from recon.record.raster.geotiff import CAPTURED_UTC_TAG, projected_crs


@dataclass(frozen=True, slots=True, eq=False)
class CogBand:
    """Values (R, C), NaN where unknown; what they are, and their unit if they have one."""

    values: FloatMap
    description: str
    unit: str = ""


def cog_bytes(grid: GroundGrid, bands: Sequence[CogBand], tags: Mapping[str, str]) -> bytes:
    """Return a file of float32 bands in the local frame's projection; no data is NaN."""
    with MemoryFile() as memory:
        with memory.open(
            driver="COG",
            height=grid.rows,
            width=grid.cols,
            count=len(bands),
            dtype="float32",
            nodata=float("nan"),
            crs=projected_crs(grid.frame),
            transform=Affine(grid.cell_m, 0.0, grid.west_m, 0.0, -grid.cell_m, grid.north_m),
            compress="deflate",
        ) as dataset:
            dataset.write(np.stack([band.values for band in bands]).astype(np.float32))
            dataset.descriptions = tuple(band.description for band in bands)
            dataset.units = tuple(band.unit for band in bands)
            dataset.update_tags(**tags)
        return bytes(memory.read())


def shade_cog_bytes(shade: ShadeMap, captured_utc: str | None = None) -> bytes:
    """Return a file of two bands.

    The first is the share of the clear sky's direct beam, the second the confidence, both 0 to 1.
    """
    bands = [
        CogBand(np.where(shade.valid, values, np.float32(np.nan)), description)
        for values, description in (
            (shade.transmittance, "transmittance"),
            (shade.confidence, "confidence"),
        )
    ]
    return cog_bytes(
        shade.grid, bands, {} if captured_utc is None else {CAPTURED_UTC_TAG: captured_utc}
    )
