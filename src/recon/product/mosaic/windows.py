"""Finished windows on disk, each a small GeoTIFF, and the cloud-optimised raster made of them.

A killed run leaves whole windows only; the next run with the same inputs goes on from them. Another
run's windows are deleted.
"""

import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import numpy as np
import numpy.typing as npt
import rasterio
import rasterio.shutil
from rasterio.errors import RasterioError
from rasterio.io import MemoryFile
from rasterio.transform import Affine

from recon.model.geo import GroundGrid
from recon.product.mosaic.choice import OUTSIDE, Light, PixelChoice
from recon.product.mosaic.plan import WINDOW_CELLS, WINDOW_PX, MosaicPlan, MosaicWindow
from recon.product.photos.card import begin_own
from recon.record.files.atomic_file import replace_file
from recon.record.raster.geotiff import projected_crs

FOLDER = "windows-"
FILE_MODE = 0o644
CACHE_BYTES = 16 * 1024 * 1024
"""GDAL's, which rasterio sets in bytes: windows are read once, in order."""
GDAL_OPTIONS = {
    "GDAL_CACHEMAX": CACHE_BYTES,
    # A second thread would take 20 MB, and a tenth off the time.
    "GDAL_NUM_THREADS": "1",
    # Files of windows that are open at once: each holds its last block.
    "GDAL_MAX_DATASET_POOL_SIZE": "16",
}
BLOCK_PX = 512
DEFLATE_LEVEL = 6
TYPES = {"uint8": "Byte", "uint16": "UInt16", "float32": "Float32"}
"""GDAL's names."""


@dataclass(frozen=True, slots=True)
class RasterBand:
    """A band of a raster: what it is, its unit, and its colour for GDAL."""

    description: str
    unit: str = ""
    colour: str = "Gray"


@dataclass(frozen=True, slots=True)
class Raster:
    """One raster of a mosaic: its bands, their type, and the value of no data if one is."""

    name: str
    bands: Sequence[RasterBand]
    dtype: str
    nodata: float | None = None
    window_px: int = WINDOW_PX
    overviews: str = "average"
    """How smaller ones are made of it."""


PROVENANCE_BANDS = (
    RasterBand("photo: number in photos.csv"),
    RasterBand("time of the photo, seconds after RECON_START_UTC", "s"),
    RasterBand("transmittance of the direct beam at that time, 0 to 1"),
    RasterBand("confidence of the transmittance, 0 to 1"),
    RasterBand("angle of the ray from nadir", "degree"),
    RasterBand(", ".join(f"{each.value} {each.name.lower()}" for each in Light)),
)
PROVENANCE = Raster(
    "provenance", PROVENANCE_BANDS, "float32", float("nan"), WINDOW_CELLS, overviews="nearest"
)


@dataclass(frozen=True, slots=True)
class WindowStore:
    """A run's windows in the folder of its result. Its methods raise OSError."""

    folder: Path
    plan: MosaicPlan

    @classmethod
    def begin(cls, out: Path, plan: MosaicPlan, key: str) -> "WindowStore":
        """Return the windows of a run, with those that it finished before."""
        begin_own(out)
        folder = out / f"{FOLDER}{key}"
        for other in out.glob(f"{FOLDER}*"):
            if other != folder:
                shutil.rmtree(other)
        folder.mkdir(exist_ok=True)
        return cls(folder, plan)

    def path(self, window: MosaicWindow, raster: str) -> Path:
        """Return the file of a window."""
        return self.folder / f"{window.row:05d}-{window.col:05d}-{raster}.tif"

    def has(self, window: MosaicWindow, raster: str) -> bool:
        """Return whether a window is finished, with something in it or without."""
        path = self.path(window, raster)
        return path.exists() or path.with_suffix(".empty").exists()

    def drop(self, window: MosaicWindow) -> None:
        """Forget all that was made of a window."""
        for path in self.folder.glob(f"{window.row:05d}-{window.col:05d}-*"):
            path.unlink()

    def save(self, window: MosaicWindow, raster: str, values: npt.NDArray[Any] | None) -> None:
        """Keep a window's values (bands, rows, cols), whole or not at all; None: it is empty."""
        path = self.path(window, raster)
        if values is None:
            path.with_suffix(".empty").touch()
            return
        cell_m = self.plan.grid.cell_m * WINDOW_PX / values.shape[1]
        west_m, _south_m, _east_m, north_m = self.plan.box(window).bounds
        place = Affine(cell_m, 0.0, west_m, 0.0, -cell_m, north_m)
        predictor = 3 if values.dtype.kind == "f" else 2
        count, rows, cols = values.shape
        profile = {"count": count, "height": rows, "width": cols, "dtype": values.dtype.name}
        with MemoryFile() as memory:
            with memory.open(
                driver="GTiff", compress="deflate", predictor=predictor, zlevel=1, tiled=True,
                blockxsize=min(BLOCK_PX, cols), blockysize=min(BLOCK_PX, rows),
                transform=place, **profile,
            ) as dataset:  # fmt: skip
                dataset.write(values)
            data = bytes(memory.read())
        replace_file(path, data, FILE_MODE)

    def save_choice(
        self, window: MosaicWindow, choice: PixelChoice, seconds: Sequence[float]
    ) -> None:
        """Keep a window's choice; `seconds` are the photos' times."""
        none = choice.photo < 0
        at_s = np.where(none, np.nan, np.append(seconds, np.nan)[choice.photo])
        index = np.where(none, np.nan, choice.photo)
        bands = (index, at_s, choice.transmittance, choice.confidence, choice.off_nadir_deg)
        light = np.where(choice.light == OUTSIDE, np.nan, choice.light)
        values = np.stack([*bands, light]).astype(np.float32)
        self.save(window, "provenance", None if np.isnan(light).all() else values)

    def choice(self, window: MosaicWindow) -> PixelChoice:
        """Return a window's choice."""
        path = self.path(window, "provenance")
        if not path.exists():
            return PixelChoice.empty((WINDOW_CELLS, WINDOW_CELLS))
        with rasterio.open(path) as dataset:
            index, _at_s, sun, sure, off_deg, light = dataset.read()
        return PixelChoice(
            np.where(np.isnan(index), -1, index).astype(np.int32),
            sun,
            sure,
            off_deg,
            np.where(np.isnan(light), OUTSIDE, light).astype(np.uint8),
        )

    def choices(
        self, windows: Iterable[MosaicWindow]
    ) -> Iterator[tuple[MosaicWindow, PixelChoice]]:
        """Yield windows with their choices."""
        for window in windows:
            yield window, self.choice(window)

    def write_cog(
        self, raster: Raster, windows: Iterable[MosaicWindow], tags: Mapping[str, str]
    ) -> Path:
        """Write the raster of all windows into their folder and return it."""
        files = [(each, self.path(each, raster.name)) for each in windows]
        there = [(each, path.name) for each, path in files if path.exists()]
        source, target = (self.folder / f"{raster.name}{suffix}" for suffix in (".vrt", ".tif"))
        replace_file(source, _vrt(self.plan.grid, raster, there, tags).encode(), FILE_MODE)
        try:
            with rasterio.Env(**GDAL_OPTIONS):
                rasterio.shutil.copy(
                    source,
                    target,
                    driver="COG",
                    compress="deflate",
                    predictor="yes",
                    level=DEFLATE_LEVEL,
                    blocksize=BLOCK_PX,
                    bigtiff="if_safer",
                    overview_resampling=raster.overviews,
                )
                _read_back(target)
        except RasterioError as problem:
            raise OSError(None, str(problem.__cause__ or problem), str(target)) from problem
        return target

    def finish(self) -> None:
        """Delete the windows: their rasters are in place."""
        shutil.rmtree(self.folder)


def _read_back(path: Path) -> None:
    """Raise `RasterioError` for a raster that is not whole: of a full disk GDAL only prints."""
    with rasterio.open(path) as dataset:
        levels = range(-1, len(dataset.overviews(1)))
    for level in levels:
        options = {} if level < 0 else {"overview_level": level}
        with rasterio.open(path, **options) as dataset:
            for _place, block in dataset.block_windows(1):
                dataset.read(window=block)


def _vrt(
    grid: GroundGrid,
    raster: Raster,
    files: Sequence[tuple[MosaicWindow, str]],
    tags: Mapping[str, str],
) -> str:
    """Return GDAL's virtual raster of windows on a grid of pixels."""
    side = raster.window_px
    cell_m = grid.cell_m * WINDOW_PX / side
    place = f"{grid.west_m!r}, {cell_m!r}, 0, {grid.north_m!r}, 0, {-cell_m!r}"
    facts = "".join(f"<MDI key={quoteattr(k)}>{escape(v)}</MDI>" for k, v in tags.items())
    cols, rows = (count * side // WINDOW_PX for count in (grid.cols, grid.rows))
    parts = [
        f'<VRTDataset rasterXSize="{cols}" rasterYSize="{rows}">'
        f"<SRS>{escape(projected_crs(grid.frame))}</SRS><GeoTransform>{place}</GeoTransform>"
        f"<Metadata>{facts}</Metadata>"
    ]
    block = min(BLOCK_PX, side)
    size, kind = f'xSize="{side}" ySize="{side}"', f'ataType="{TYPES[raster.dtype]}"'
    nodata = "" if raster.nodata is None else f"<NoDataValue>{raster.nodata}</NoDataValue>"
    for number, band in enumerate(raster.bands, start=1):
        parts.append(
            f'<VRTRasterBand d{kind} band="{number}">'
            f"<Description>{escape(band.description)}</Description>{nodata}"
            f"<UnitType>{escape(band.unit)}</UnitType><ColorInterp>{band.colour}</ColorInterp>"
        )
        # With a source's size stated GDAL opens its file only when it is read.
        parts += (
            f'<SimpleSource><SourceFilename relativeToVRT="1">{escape(name)}</SourceFilename>'
            f'<SourceBand>{number}</SourceBand><SourceProperties RasterXSize="{side}" '
            f'RasterYSize="{side}" D{kind} BlockXSize="{block}" BlockYSize="{block}"/>'
            f'<SrcRect xOff="0" yOff="0" {size}/>'
            f'<DstRect xOff="{window.col * side}" yOff="{window.row * side}" {size}/>'
            "</SimpleSource>"
            for window, name in files
        )
        parts.append("</VRTRasterBand>")
    return "".join(parts) + "</VRTDataset>"
