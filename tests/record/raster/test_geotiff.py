"""A GeoTIFF read back lies where the ground image does."""

from pathlib import Path

import numpy as np
import pytest
from pyproj import Transformer
from rasterio.crs import CRS
from rasterio.enums import ColorInterp
from rasterio.io import DatasetReader, MemoryFile
from rasterio.warp import transform

from recon.geo import geo_from_enu
from recon.model.errors import RecordError
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.imagery import CameraPose, GroundImage
from recon.record.raster.geotiff import geotiff_bytes, projected_crs, write_ground_image

ORIGINS = [
    GeoPoint(45.345, -93.859, 288.0),
    GeoPoint(-33.9, 151.2, 2_000.0),
    GeoPoint(0.5, 10.0, -50.0),
]


def ground_image(rows: int = 300, cols: int = 280, origin: GeoPoint = ORIGINS[0]) -> GroundImage:
    rng = np.random.default_rng(3)
    grid = GroundGrid(LocalFrame(origin), -120.0, 170.0, 0.5, rows, cols)
    pose = CameraPose(np.eye(3), np.array([0.0, 0.0, 120.0]))
    rgb = rng.integers(0, 256, (rows, cols, 3), dtype=np.uint8)
    valid = rng.random((rows, cols)) < 0.7
    return GroundImage(grid, 17, 123_456_789, rgb, valid, pose)


@pytest.mark.parametrize("origin", ORIGINS)
def test_the_projection_is_the_local_frame_to_a_millimetre_within_a_kilometre(
    origin: GeoPoint,
) -> None:
    frame = LocalFrame(origin)
    rng = np.random.default_rng(4)
    distance = 1_000.0 * np.sqrt(rng.random(500))
    angle = rng.uniform(0, 2 * np.pi, 500)
    enu = np.stack([distance * np.cos(angle), distance * np.sin(angle), np.zeros(500)], axis=1)
    latitude, longitude, _ = geo_from_enu(frame, enu)
    to_map = Transformer.from_crs("EPSG:4326", projected_crs(frame), always_xy=True)
    east, north = to_map.transform(longitude, latitude)
    assert np.hypot(east - enu[:, 0], north - enu[:, 1]).max() < 1e-3


@pytest.mark.parametrize("origin", ORIGINS)
def test_a_marked_cell_is_found_again_at_its_latitude_and_longitude(origin: GeoPoint) -> None:
    image = ground_image(origin=origin)
    row, col = 41, 205
    image.rgb[row, col] = (250, 1, 2)
    image.valid[row, col] = True
    centre_enu = [image.grid.west_m + (col + 0.5) * 0.5, image.grid.north_m - (row + 0.5) * 0.5, 0]
    latitude, longitude, _ = geo_from_enu(image.grid.frame, [centre_enu])
    with MemoryFile(geotiff_bytes(image)) as memory, memory.open() as dataset:
        east, north = transform(CRS.from_epsg(4326), dataset.crs, longitude, latitude)
        # An affine map's own order: x = a col + b row + c, y = d col + e row + f.
        cell_m, _, west_m, _, minus_cell_m, north_edge_m, *_ = dataset.transform
        bands = dataset.read()
    found_col = (east[0] - west_m) / cell_m - 0.5
    found_row = (north[0] - north_edge_m) / minus_cell_m - 0.5
    assert (found_row, found_col) == pytest.approx((row, col), abs=0.002)
    assert bands[:, row, col].tolist() == [250, 1, 2, 255]


def read_back(dataset: DatasetReader) -> tuple[np.ndarray, dict[str, str]]:
    return dataset.read(), dataset.tags()


def test_every_pixel_and_tag_comes_back(tmp_path: Path) -> None:
    image = ground_image()
    path = tmp_path / "ground.tif"
    write_ground_image(path, image, captured_utc="2020-07-24T16:00:00Z", rms_px=3.6149)
    with MemoryFile(path.read_bytes()) as memory, memory.open() as dataset:
        bands, tags = read_back(dataset)
        assert dataset.colorinterp[3] == ColorInterp.alpha
        assert dataset.res == (0.5, 0.5)
    assert np.array_equal(np.moveaxis(bands[:3], 0, 2), image.rgb)
    assert np.array_equal(bands[3] == 255, image.valid)
    assert tags["RECON_FRAME_ID"] == "17"
    assert tags["RECON_CAPTURED_AT_NS"] == "123456789"
    assert tags["RECON_REGISTRATION"] == "unregistered"
    assert tags["RECON_CAPTURED_UTC"] == "2020-07-24T16:00:00Z"
    assert tags["RECON_MARKED_FRAME_RMS_PX"] == "3.615"
    assert [p.name for p in tmp_path.iterdir()] == ["ground.tif"]


def test_a_small_image_is_written_too() -> None:
    with MemoryFile(geotiff_bytes(ground_image(3, 5))) as memory, memory.open() as dataset:
        assert dataset.shape == (3, 5)


def test_a_missing_folder_is_one_clear_error(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match=r"No such file.*check that the folder exists"):
        write_ground_image(tmp_path / "none" / "ground.tif", ground_image())


def test_arrays_that_do_not_fit_the_grid_are_refused() -> None:
    image = ground_image()
    wrong = GroundImage(image.grid, 1, 2, image.rgb[:-1], image.valid, image.pose)
    with pytest.raises(RecordError, match="expected 300 x 280 cells"):
        geotiff_bytes(wrong)
