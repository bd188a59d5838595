"""GeoTIFF as tiles: each pixel has the colour of its place; a hostile file costs an answer."""

import warnings
from io import BytesIO
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyproj
import pytest
import rasterio
from PIL import Image
from rasterio.enums import ColorInterp, Resampling
from rasterio.errors import NotGeoreferencedWarning
from rasterio.transform import Affine
from tests.basemap.made_maps import FIELD, keys_over

from recon.basemap.map_file import BaseMapError
from recon.basemap.map_reader import MapReader
from recon.basemap.web_mercator import globe_from_world

UTM = "EPSG:32615"
SIDE_PX, PIXEL_M = 1600, 0.3
WEST_M, NORTH_M = pyproj.Transformer.from_crs("EPSG:4326", UTM, always_xy=True).transform(
    -93.6045, 41.9035
)
"""North-west of the field, which the file shows whole."""
PLACED = Affine(PIXEL_M, 0.0, WEST_M, 0.0, -PIXEL_M, NORTH_M)
Colours = npt.NDArray[np.uint8]


def ramps(side_px: int = SIDE_PX) -> Colours:
    """Red grows eastwards, green southwards: the colour of a pixel states its place."""
    step = np.linspace(0.0, 255.0, side_px)
    east, south = np.meshgrid(step, step)
    return np.stack([east, south, np.full_like(east, 77.0)]).round().astype(np.uint8)


def write(
    path: Path,
    bands: npt.NDArray[np.generic],
    transform: Affine = PLACED,
    crs: str | None = UTM,
    overviews: bool = False,
    **more: object,
) -> Path:
    count, rows, cols = bands.shape
    profile = {"driver": "GTiff", "dtype": bands.dtype.name, "tiled": True, "compress": "deflate"}
    shape = {"count": count, "height": rows, "width": cols, "crs": crs, "transform": transform}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NotGeoreferencedWarning)
        with rasterio.open(path, "w", **{**profile, **shape, **more}) as file:
            file.write(bands)
            if overviews:
                file.build_overviews([2, 4, 8], Resampling.average)
    return path


def pixels_of(data: bytes) -> Colours:
    with Image.open(BytesIO(data)) as image:
        return np.asarray(image.convert("RGBA"))


def places(zoom: int, col: int, row: int) -> npt.NDArray[np.float64]:
    """Return (256, 256, 2) easting and northing in UTM of the centre of each pixel."""
    at = (np.arange(256) + 0.5) / 256.0
    east, south = np.meshgrid((col + at) / 2.0**zoom, (row + at) / 2.0**zoom)
    globe = globe_from_world(np.column_stack([east.ravel(), south.ravel()]))
    transform = pyproj.Transformer.from_crs("EPSG:4326", UTM, always_xy=True).transform
    return np.column_stack(transform(*globe.T)).reshape(256, 256, 2)


def expected(zoom: int, col: int, row: int) -> npt.NDArray[np.float64]:
    """Return red and green of each pixel of a tile by its place."""
    far_m = (SIDE_PX - 1) * PIXEL_M
    offset = places(zoom, col, row) - (WEST_M + PIXEL_M / 2.0, NORTH_M - PIXEL_M / 2.0)
    return offset * (255.0 / far_m, -255.0 / far_m)


@pytest.mark.parametrize("overviews", [False, True])
@pytest.mark.parametrize("zoom", [15, 17, 19])
def test_each_pixel_of_a_tile_has_the_colour_of_its_place(
    folder: Path, reader: MapReader, zoom: int, overviews: bool
) -> None:
    write(folder / "a.tif", ramps(), overviews=overviews)
    compared = 0
    for key in keys_over(FIELD, [zoom])[:6]:
        tile, _ = reader.tile("a.tif", *key)
        assert tile is not None
        shown, colours = pixels_of(tile.data), expected(*key)
        is_inside = ((colours > 4.0) & (colours < 251.0)).all(axis=-1) & (shown[..., 3] > 0)
        off = np.abs(shown[..., :2] - colours)[is_inside]
        # A level of colour is 1.9 m at this size; JPEG and overviews take a few.
        assert off.max() < 5.0
        assert off.mean() < 1.0
        compared += int(is_inside.sum())
    assert compared > 10_000


def test_a_file_states_what_it_is_and_covers(folder: Path, reader: MapReader) -> None:
    path = write(folder / "orthophoto 2025.tif", ramps())
    with rasterio.open(path, "r+") as file:
        file.update_tags(TIFFTAG_COPYRIGHT="© survey")
    known = reader.facts(path.name, FIELD)
    info = known.info
    assert info is not None
    assert (info.kind, info.title, info.attribution) == ("GeoTIFF", "orthophoto 2025", "© survey")
    # 0.3 m: zoom 19 has 0.22 m there, zoom 18 has 0.44 m.
    assert (info.min_zoom, info.max_zoom) == (0, 19)
    west, south, east, north = info.bounds_deg
    assert west == pytest.approx(-93.6045, abs=1e-5)
    assert north == pytest.approx(41.9035, abs=5e-5)
    assert east - west == pytest.approx(480.0 / 82_900.0, rel=0.03)
    assert north - south == pytest.approx(480.0 / 111_070.0, rel=0.03)
    assert {level.share for level in known.coverage} == {1.0}
    assert len(known.coverage) == 20


def test_half_a_file_covers_half_the_site(folder: Path, reader: MapReader) -> None:
    middle_m = pyproj.Transformer.from_crs("EPSG:4326", UTM, always_xy=True).transform(
        -93.602, 41.9015
    )[0]
    cols = round((middle_m - WEST_M) / PIXEL_M)
    write(folder / "a.tif", ramps()[:, :, :cols])
    shares = {level.share for level in reader.facts("a.tif", FIELD).coverage}
    assert len(shares) == 1
    assert shares.pop() == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize("kind", ["alpha", "nodata"])
def test_what_the_file_does_not_show_is_transparent_and_not_covered(
    folder: Path, reader: MapReader, kind: str
) -> None:
    bands = ramps() // 2 + 1
    lower = slice(SIDE_PX // 2, None)
    if kind == "alpha":
        alpha = np.full((1, SIDE_PX, SIDE_PX), 255, np.uint8)
        alpha[:, lower] = 0
        bands = np.concatenate([bands, alpha])
        meanings = (ColorInterp.red, ColorInterp.green, ColorInterp.blue, ColorInterp.alpha)
        path = write(folder / "a.tif", bands, photometric="RGB")
        with rasterio.open(path, "r+") as file:
            file.colorinterp = meanings
    else:
        bands[:, lower] = 0
        write(folder / "a.tif", bands, nodata=0)
    levels = reader.facts("a.tif", FIELD).coverage
    assert 0.4 < levels[-1].share < 0.9
    seen = set()
    for key in keys_over(FIELD, [17]):
        tile, _ = reader.tile("a.tif", *key)
        if tile is None:
            continue
        shown = pixels_of(tile.data)[..., 3]
        is_lower = places(*key)[..., 1] < NORTH_M - SIDE_PX / 2 * PIXEL_M
        is_near_edge = np.abs(places(*key)[..., 1] - (NORTH_M - SIDE_PX / 2 * PIXEL_M)) < 2.0
        assert (shown[is_lower & ~is_near_edge] == 0).all()
        seen |= {tile.media_type}
    assert "image/png" in seen


def test_alpha_counts_and_not_a_colour_that_means_no_data(folder: Path, reader: MapReader) -> None:
    """As OpenDroneMap and others write grey pictures: white is a colour, and transparent too."""
    bands = np.full((2, SIDE_PX, SIDE_PX), 255, np.uint8)
    bands[1, SIDE_PX // 2 :] = 0
    path = write(folder / "a.tif", bands, nodata=255)
    with rasterio.open(path, "r+") as file:
        file.colorinterp = (ColorInterp.gray, ColorInterp.alpha)
    assert 0.4 < reader.facts("a.tif", FIELD).coverage[-1].share < 0.9


@pytest.mark.parametrize("crs", ["EPSG:4547", "+proj=utm +zone=15 +ellps=WGS84 +units=m"])
def test_systems_that_are_wgs84_within_decimetres_are_placed(
    folder: Path, reader: MapReader, crs: str
) -> None:
    path = folder / "a.tif"
    profile = {"driver": "GTiff", "width": 50, "height": 50, "count": 3, "dtype": "uint8"}
    with rasterio.open(path, "w", crs=crs, transform=Affine(1, 0, 5e5, 0, -1, 4e6), **profile) as f:
        f.write(ramps()[:, :50, :50])
    facts = reader.facts("a.tif", FIELD)
    assert facts.info is not None, facts.problem


def test_grey_and_palette_pictures_have_their_colours(folder: Path, reader: MapReader) -> None:
    grey = np.full((1, 400, 400), 90, np.uint8)
    write(folder / "grey.tif", grey)
    path = write(folder / "palette.tif", np.full((1, 400, 400), 7, np.uint8))
    with rasterio.open(path, "r+") as file:
        file.write_colormap(1, {7: (200, 30, 60, 255)})
    key = keys_over(FIELD, [19])[0]
    for name, colour in [("grey.tif", (90, 90, 90)), ("palette.tif", (200, 30, 60))]:
        tile, _ = reader.tile(name, *key)
        assert tile is not None
        shown = pixels_of(tile.data)
        assert np.abs(shown[shown[..., 3] > 0][:, :3].astype(int) - colour).max() <= 4


@pytest.mark.parametrize("crs", ["EPSG:4326", "EPSG:3857", "EPSG:32615+5703", "turned"])
def test_other_projections_and_turned_files_lie_at_the_same_place(
    folder: Path, reader: MapReader, crs: str
) -> None:
    bands = np.zeros((3, 400, 400), np.uint8)
    bands[0, 195:205, 195:205] = 250
    target = pyproj.Transformer.from_crs("EPSG:4326", UTM, always_xy=True)
    if crs in ("EPSG:4326", "EPSG:3857"):
        target = pyproj.Transformer.from_crs("EPSG:4326", crs, always_xy=True)
    x, y = target.transform(-93.602, 41.9015)
    step = 2e-6 if crs == "EPSG:4326" else 0.25
    turn = Affine.rotation(30.0) if crs == "turned" else Affine.identity()
    about = Affine.translation(x, y) @ turn @ Affine.scale(step, -step)
    transform = about @ Affine.translation(-200.0, -200.0)
    write(folder / "a.tif", bands, transform, UTM if crs == "turned" else crs)
    tile, _ = reader.tile("a.tif", 19, *tile_at(-93.602, 41.9015, 19))
    assert tile is not None
    rows, cols = np.nonzero(pixels_of(tile.data)[..., 0] > 120)
    at = np.array([cols.mean() + 0.5, rows.mean() + 0.5]) / 256.0
    world = (np.array(tile_at(-93.602, 41.9015, 19)) + at) / 2.0**19
    (longitude, latitude), *_ = globe_from_world(world[None])
    assert (longitude - -93.602) * 82_900.0 == pytest.approx(0.0, abs=0.25)
    assert (latitude - 41.9015) * 111_070.0 == pytest.approx(0.0, abs=0.25)


def tile_at(longitude_deg: float, latitude_deg: float, zoom: int) -> tuple[int, int]:
    from recon.basemap.web_mercator import world_from_globe

    ((east, south),) = world_from_globe([longitude_deg], [latitude_deg]) * 2.0**zoom
    return int(east), int(south)


def broken(path: Path, kind: str) -> None:
    small = ramps(300)
    match kind:
        case "another kind":
            path.write_bytes(b"no map")
        case "cut short":
            write(path, small)
            path.write_bytes(path.read_bytes()[:200])
        case "heights":
            write(path, np.zeros((1, 300, 300), np.float32))
        case "reflectances":
            write(path, np.zeros((5, 300, 300), np.uint16))
        case "no projection":
            write(path, small, crs=None)
        case "no place":
            write(path, small, transform=Affine.identity())
        case "grid files":
            proj = "+proj=tmerc +lat_0=42 +lon_0=-93 +ellps=GRS80 +nadgrids=other.gsb +no_defs"
            write(path, small, crs=proj)
        case "not on earth":
            write(path, small, Affine(1e7, 0.0, 0.0, 0.0, -1e7, 0.0))
        case "giant strip":
            # Two strips of 150 MB each.
            size = {"height": 10_000, "width": 10_000, "count": 3, "dtype": "uint8"}
            layout = {"tiled": False, "blockysize": 5_000, "compress": "deflate"}
            where = {"crs": UTM, "transform": PLACED, "SPARSE_OK": True}
            with rasterio.open(path, "w", driver="GTiff", **size, **layout, **where):
                pass
        case "no overviews":
            size = {"height": 20_000, "width": 20_000, "count": 3, "dtype": "uint8"}
            where = {"crs": UTM, "transform": PLACED, "SPARSE_OK": True, "tiled": True}
            with rasterio.open(path, "w", driver="GTiff", **size, **where):
                pass
        case "foreign overviews":
            write(path, small)
            with rasterio.open(path, "r+") as file:
                file.update_tags(ns="OVERVIEWS", OVERVIEW_FILE="/etc/passwd")


@pytest.mark.parametrize(
    ("kind", "sentence"),
    [
        ("another kind", "expected a GeoTIFF, got another kind of file"),
        ("cut short", "expected"),
        ("heights", "expected a picture of 8 bits a colour, got float32"),
        ("reflectances", "expected a picture of 8 bits a colour, got uint16"),
        ("no projection", "without; export it from QGIS with its CRS"),
        ("no place", "without; export it from QGIS with its CRS"),
        ("grid files", "without grid files of its own"),
        ("not on earth", "whose pixels are on earth"),
        ("giant strip", "expected strips or tiles of at most"),
        ("no overviews", "expected overviews in a file of 20000 x 20000 pixels"),
        ("foreign overviews", "expected overviews inside the file"),
    ],
)
def test_what_is_no_map_is_refused_with_a_sentence_and_disturbs_no_other(
    folder: Path, reader: MapReader, kind: str, sentence: str
) -> None:
    broken(folder / "bad.tif", kind)
    write(folder / "good.tif", ramps(300))
    problem = reader.facts("bad.tif", FIELD).problem
    assert sentence in problem
    assert str(folder) not in problem
    with pytest.raises(BaseMapError):
        reader.tile("bad.tif", *keys_over(FIELD, [17])[0])
    assert reader.facts("good.tif", FIELD).problem == ""


def test_a_large_file_without_overviews_is_shown_from_near(folder: Path, reader: MapReader) -> None:
    path = folder / "a.tif"
    size = {"height": 12_000, "width": 12_000, "count": 3, "dtype": "uint8"}
    fine = Affine(0.05, 0.0, WEST_M, 0.0, -0.05, NORTH_M)
    where = {"crs": UTM, "transform": fine, "SPARSE_OK": True, "tiled": True}
    with rasterio.open(path, "w", driver="GTiff", **size, **where) as file:
        file.write(np.full((3, 512, 512), 90, np.uint8), window=((0, 512), (0, 512)))
    info = reader.facts("a.tif", FIELD).info
    assert info is not None
    assert 16 <= info.min_zoom <= 19
    assert info.max_zoom == 21
    for zoom in (info.min_zoom, info.max_zoom):
        tile, _ = reader.tile("a.tif", zoom, *tile_at(-93.6044, 41.9034, zoom))
        assert tile is not None
        assert pixels_of(tile.data)[..., 0].max() >= 80
    assert reader.tile("a.tif", 12, *tile_at(-93.6044, 41.9034, 12))[0] is None


def test_outside_the_file_nothing_is_shown(folder: Path, reader: MapReader) -> None:
    write(folder / "a.tif", ramps(300))
    for key in [(19, 0, 0), (19, *tile_at(-93.59, 41.9, 19)), (2, 3, 3)]:
        assert reader.tile("a.tif", *key)[0] is None


def test_no_file_beside_it_is_read(folder: Path, reader: MapReader) -> None:
    write(folder / "a.tif", ramps(300))
    other = write(folder / "other.tif", np.full((3, 300, 300), 255, np.uint8), overviews=True)
    # What GDAL would take for its overviews, its mask and its place.
    for name in ("a.tif.ovr", "a.tif.msk"):
        (folder / name).write_bytes(other.read_bytes())
    aux = "<PAMDataset><GeoTransform>0, 1, 0, 0, 0, -1</GeoTransform></PAMDataset>"
    (folder / "a.tif.aux.xml").write_text(aux)
    info = reader.facts("a.tif", FIELD).info
    assert info is not None
    assert info.bounds_deg[0] == pytest.approx(-93.6045, abs=1e-5)
    tile, _ = reader.tile("a.tif", 16, *tile_at(-93.604, 41.903, 16))
    assert tile is not None
    shown = pixels_of(tile.data)
    assert shown[shown[..., 3] > 0][:, 2].max() <= 77 + 4
