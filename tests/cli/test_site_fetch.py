"""`recon site fetch`: what a site needs at the field is brought into its folder, and dated."""

import json
from pathlib import Path

import numpy as np
import pytest
from rasterio.transform import Affine
from tests.fetching.file_server import file_server, send
from tests.site.terrain import written
from typer.testing import CliRunner, Result

from recon.cli.site import site_app
from recon.geo import cell_centres_m, geo_from_enu
from recon.geo.geoid import geoid_height_m
from recon.model.errors import ReconError
from recon.site import Site, load_site

AT = 50.0004, 13.9990
"""Near a corner of four tiles, where those of the north have wider pixels."""
SEA_LEVEL_M = geoid_height_m(*AT)
RING = [[13.998, 49.999], [14.001, 49.999], [14.001, 50.0015], [13.998, 50.0015]]
NAME = "Copernicus_DSM_COG_10_{NS}{lat:02}_00_{EW}{lon:03}_00_DEM"
NAMES = {
    (lat, lon): NAME.replace("{NS}{lat:02}", f"N{lat}").replace("{EW}{lon:03}", f"E{lon:03}")
    for lat in (49, 50)
    for lon in (13, 14)
}
SECOND_DEG = 1.0 / 3600.0


def height_m(latitude_deg, longitude_deg):
    return 250.0 + 900.0 * (latitude_deg - 50.0) + 400.0 * (longitude_deg - 14.0)


def tile(lat: int, lon: int) -> bytes:
    """The part of a tile of GLO-30 that lies around the corner of the four."""
    width_deg, side = SECOND_DEG * (1.0 if lat < 50 else 1.5), 100
    west = 14.0 - (side if lon < 14 else 0) * width_deg - width_deg / 2.0
    north = 50.0 + (side if lat >= 50 else 0) * SECOND_DEG + SECOND_DEG / 2.0
    transform = Affine(width_deg, 0.0, west, 0.0, -SECOND_DEG, north)
    longitude, latitude = transform @ np.meshgrid(np.arange(side) + 0.5, np.arange(side) + 0.5)
    heights = height_m(latitude, longitude).astype("float32")
    return written(heights, crs="EPSG:4326", transform=transform)


TILES = {f"/{name}/{name}.tif": tile(*key) for key, name in NAMES.items()}


def run(*words: str) -> Result:
    return CliRunner().invoke(site_app, words, catch_exceptions=False)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "field"
    place = f"{AT[0]},{AT[1]}"
    run("new", str(made), "--at", place, "--ground-above-sea-level", "250m")
    layer = tmp_path / "boundary.json"
    shape = {"type": "Polygon", "coordinates": [[*RING, RING[0]]]}
    layer.write_text(json.dumps({"type": "Feature", "properties": {}, "geometry": shape}))
    run("import", str(made), str(layer), "--as", "boundary")
    return made


def template(address: str) -> str:
    return f"{address}/{NAME}/{NAME}.tif"


def off_m(site: Site) -> float:
    """Largest difference between the site's model and the made ground, above sea level."""
    assert site.elevation is not None
    grid = site.elevation.grid
    east, north = np.meshgrid(*cell_centres_m(grid))
    points = np.column_stack([east.ravel(), north.ravel(), np.zeros(east.size)])
    latitude, longitude, _ = geo_from_enu(grid.frame, points)
    found = site.elevation.ellipsoid_height_m.ravel() - SEA_LEVEL_M
    return float(np.nanmax(np.abs(found - height_m(latitude, longitude))))


def test_tiles_become_the_sites_elevation_model(folder: Path) -> None:
    before = (folder / "site.toml").read_text()
    with file_server(TILES) as server:
        found = run("fetch", str(folder), "--elevation", template(server.address))
    assert found.exit_code == 0, found.output
    assert sorted(server.asked) == sorted(TILES)
    for sentence in (
        "4 tiles from 127.0.0.1: N49E013, N49E014, N50E013, N50E014",
        "heights of 100 % of the boundary and 100 % of the ",
        "pixels from Copernicus GLO-30 (127.0.0.1)",
        f"heights above EGM2008, taken as sea level, which is {SEA_LEVEL_M:.2f} m above the WGS84",
        "a surface model: trees and buildings are part of its ground",
        "source: © DLR e.V. 2010-2014 and © Airbus",
    ):
        assert sentence in found.output
    site = load_site(folder)
    # A cell is as high as the highest pixel near it: slopes of 1 % over two pixels.
    assert off_m(site) < 1.5
    assert (folder / "site.toml").read_text().startswith(before)
    assert (folder / "elevation-fetched.tif").stat().st_size < 100_000
    assert not (folder / ".fetching").exists()
    assert (
        "a surface model, with trees and buildings, heights above EGM2008, fetched just now"
        in run("check", str(folder)).output
    )


def test_an_interrupted_fetch_asks_only_for_what_is_missing(folder: Path) -> None:
    def few(handler, data: bytes) -> None:
        send(handler, data) if len(server.asked) < 3 else send(handler, b"", 403)

    with file_server(TILES, few) as server:
        with pytest.raises(ReconError, match=r"127\.0\.0\.1: expected tiles, got status 403"):
            run("fetch", str(folder), "--elevation", template(server.address))
        assert load_site(folder).elevation is None
        server.answer, server.asked = send, []
        assert run("fetch", str(folder), "--elevation", template(server.address)).exit_code == 0
    assert len(server.asked) == 2


def test_missing_tiles_are_named_with_the_share_that_lacks_heights(folder: Path) -> None:
    files = {path: data for path, data in TILES.items() if "E014" not in path}
    with file_server(files) as server:
        found = run("fetch", str(folder), "--elevation", template(server.address))
    assert found.exit_code == 1
    assert "no tile at the source: N49E014, N50E014: sea, or no coverage" in found.output
    # Columns of 1.5 seconds have their middles at whole ones from 14 degrees, whose own is in the
    # eastern tile: of the boundary's seven, four are west of it.
    assert "heights of 57.1 % of the boundary" in found.output
    assert "the elevation model has no ground under" in run("check", str(folder)).output
    with file_server({}) as server, pytest.raises(ReconError, match="expected heights over the"):
        run("fetch", str(folder), "--elevation", template(server.address))


def test_files_of_this_computer_and_the_sites_own_table(folder: Path, tmp_path: Path) -> None:
    for (lat, lon), name in NAMES.items():
        (tmp_path / f"{name}.tif").write_bytes(tile(lat, lon))
    assert run("fetch", str(folder), "--elevation", f"{tmp_path}/{NAME}.tif").exit_code == 0
    site_file = folder / "site.toml"
    text = site_file.read_text().replace("fetched.tif", "old.tif")
    (folder / "elevation-old.tif").write_bytes((folder / "elevation-fetched.tif").read_bytes())
    site_file.write_text(f'{text}\n[fetch]\nelevation = "file://{tmp_path}/{NAME}.tif"\n')
    with pytest.raises(ReconError, match=r"no elevation[.]file of your own"):
        run("fetch", str(folder))
    assert run("fetch", str(folder), "--replace").exit_code == 0
    words = [word for name in NAMES.values() for word in ("--elevation", f"{tmp_path}/{name}.tif")]
    assert run("fetch", str(folder), *words).exit_code == 0
    assert load_site(folder).elevation_file == "elevation-fetched.tif"


@pytest.mark.parametrize(
    ("address", "sentence"),
    [
        ("http://x/{lat}.tif", "an address with {lat} or {north}, and {lon}"),
        ("http://x/{lat}{lon}{z}.tif", "expected the placeholders {NS}, {ns}"),
        ("http://x/{lat:999}{lon}.tif", "expected the placeholders {NS}, {ns}"),
        ("ftp://x/USGS_1_{lat}{lon}.tif", "expected a path, or an address"),
        ("/nowhere/{lat}{lon}.tif", "--datum: expected geoid (heights above sea level) or wgs84"),
        ("/nowhere/USGS_1_{lat}{lon}.tif", "expected heights over the site, got none: N49E013"),
    ],
)
def test_what_cannot_be_fetched_is_refused(folder: Path, address: str, sentence: str) -> None:
    words = ("--datum", "geoid") if address.startswith("http") else ()
    with pytest.raises(ReconError) as found:
        run("fetch", str(folder), "--elevation", address, *words)
    assert sentence in str(found.value)


def far_away(_: bytes) -> bytes:
    transform = Affine(SECOND_DEG, 0.0, 20.0, 0.0, -SECOND_DEG, 50.5)
    return written(np.zeros((50, 50), "float32"), crs="EPSG:4326", transform=transform)


def ellipsoidal(_: bytes) -> bytes:
    transform = Affine(SECOND_DEG, 0.0, 13.99, 0.0, -SECOND_DEG, 50.01)
    heights = np.full((100, 100), 250.0, "float32")
    return written(heights, crs="EPSG:4979", transform=transform)


def fine_beyond_reason(_: bytes) -> bytes:
    transform = Affine(1e-8, 0.0, AT[1] - 2.5e-7, 0.0, -1e-8, AT[0] + 2.5e-7)
    return written(np.zeros((50, 50), "float32"), crs="EPSG:4326", transform=transform)


def blind_around_the_site(_: bytes) -> bytes:
    """A projection of half the globe whose rim is beside the origin."""
    crs = f"+proj=ortho +lat_0={AT[0]} +lon_0={AT[1] - 89.9999}"
    transform = Affine(100.0, 0.0, 6_375_000.0, 0.0, -100.0, 5_000.0)
    return written(np.zeros((100, 100), "float32"), crs=crs, transform=transform)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda _: b"<html>log in</html>", "expected a GeoTIFF, got a file of another kind"),
        (lambda _: b"", "expected a GeoTIFF, got an empty file"),
        (lambda data: data[:200], "expected a whole GeoTIFF"),
        (far_away, "expected heights at the site's origin, got none there"),
        (fine_beyond_reason, "expected at most 16000000 pixels around the site"),
        (blind_around_the_site, "expected"),
        (ellipsoidal, "expected heights with elevation.datum = 'geoid'"),
    ],
)
def test_hostile_tiles_are_refused_and_change_nothing(folder: Path, change, sentence: str) -> None:
    before = (folder / "site.toml").read_bytes()
    files = {path: change(data) for path, data in TILES.items()}
    with file_server(files) as server, pytest.raises(ReconError) as found:
        run("fetch", str(folder), "--elevation", template(server.address))
    assert sentence in str(found.value)
    assert "\n" not in str(found.value)
    assert (folder / "site.toml").read_bytes() == before
    assert not (folder / "elevation-fetched.tif").exists()
