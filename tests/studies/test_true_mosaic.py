"""The measures of mosaics, on mosaics made by construction."""

import csv
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import rasterio
from rasterio.transform import Affine
from studies.true_mosaic import drawn, lights_of, places_off_m

from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.sim.camera.field import FieldRenderer
from recon.sim.photos.cameras import pinhole
from recon.sim.photos.card import CardSettings, PhotoShot
from recon.sim.world import LayerSettings, Sky, SkySettings

CELL_M = 0.25
WORLD = FieldRenderer(pinhole(60.0, 32, 24), seed=5)


def written(path: Path, bands: np.ndarray, cell_m: float, west_m: float, north_m: float) -> None:
    count, rows, cols = bands.shape
    place = Affine(cell_m, 0.0, west_m, 0.0, -cell_m, north_m)
    with rasterio.open(
        path, "w", driver="GTiff", count=count, height=rows, width=cols,
        dtype=bands.dtype.name, transform=place,
    ) as raster:  # fmt: skip
        raster.write(bands)


@pytest.mark.parametrize("off_m", [(0.0, 0.0), (1.2, -0.5)])
def test_places_are_off_by_as_much_as_the_picture_was_moved(tmp_path, off_m) -> None:
    east_m = 10.0 + CELL_M * (np.arange(300) + 0.5)
    north_m = 60.0 - CELL_M * (np.arange(300) + 0.5)
    land = drawn(WORLD, east_m, north_m, CELL_M)
    # Half as bright: a mosaic's light is its own.
    picture = np.concatenate([land // 2, np.full_like(land[..., :1], 255)], axis=-1)
    moved = np.moveaxis(picture, -1, 0)
    written(tmp_path / "mosaic.tif", moved, CELL_M, 10.0 + off_m[0], 60.0 + off_m[1])
    found = places_off_m(tmp_path, SimpleNamespace(world=WORLD))
    assert len(found) >= 2
    assert found == pytest.approx([np.hypot(*off_m)] * len(found), abs=0.05)


def test_light_is_counted_at_the_time_of_each_pieces_photo(tmp_path) -> None:
    sky = Sky(SkySettings(3, layers=(LayerSettings(cover=0.5),)))
    names, times_s = ("shaded.jpg", "sunlit.jpg"), (600.0, 1140.0)
    place_m = np.array([0.0, 0.0, 60.0])
    shots = {
        name: PhotoShot(name, "SIM-1", at_s, 0, place_m, 60.0, 0.0)
        for name, at_s in zip(names, times_s, strict=True)
    }
    flown = SimpleNamespace(
        shots=shots, truth=SimpleNamespace(sky=sky), relief=None, settings=CardSettings()
    )
    photo = np.zeros((12, 12), dtype=np.float32)
    photo[:, 6:] = 1.0
    photo[0] = np.nan
    bands = np.stack([photo] + [np.zeros_like(photo)] * 5)
    written(tmp_path / "provenance.tif", bands, 2.0, -12.0, 12.0)
    with (tmp_path / "photos.csv").open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([("number", "name"), *enumerate(names)])
    found = lights_of(tmp_path, flown)
    steps_m = np.arange(-11.0, 12.0, 2.0)
    easts, norths = np.meshgrid(steps_m, -steps_m)
    lit = [sky.transmittance(easts, norths, at_s) >= SUNLIT_TRANSMITTANCE for at_s in times_s]
    assert not lit[0].any()
    assert lit[1].all()
    assert (found.taken, found.shaded, found.sunlit, found.empty) == (132, 66, 144, 12)
    # Both are as much from above: the first one is taken.
    assert (found.shown, found.plain_shaded) == (144, 144)
