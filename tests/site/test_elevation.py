"""A site's elevation model: what it becomes, and what a bad file gets."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from pyproj.network import is_network_enabled, set_network_enabled
from rasterio.io import MemoryFile
from rasterio.transform import Affine
from tests.examples import examples
from tests.site.terrain import (
    FRAME,
    HEAD,
    UTM_15N,
    FloatArray,
    Ground,
    geotiff,
    load,
    pixels_at,
    plane,
    ridge,
    square,
    written,
)

from recon.geo import geo_from_enu
from recon.model.airspace import ElevationModel
from recon.site import SiteError, load_site
from recon.site.elevation import MOST_CELLS, ground_heights_m

PLACES_M = np.random.default_rng(7).uniform(-199.0, 199.0, (500, 2))
WGS84 = 'datum = "wgs84"'
GEOID = 'datum = "geoid"\ngeoid_height_m = -31.5'
FILE = "/ground.tif: "


def error_m(model: ElevationModel | None, ground: Ground) -> FloatArray:
    """Return how much too high the model is at many places."""
    assert model is not None
    return ground_heights_m(model, PLACES_M) - ground(*PLACES_M.T)


def refusal(folder: Path, tiff: bytes, table: str = WGS84, more: str = "") -> str:
    with pytest.raises(SiteError) as caught:
        load(folder, tiff, table, more)
    message = str(caught.value)
    assert message.isprintable()
    assert message.startswith(str(folder))
    return message.replace(str(folder), "")


class TestWhatItBecomes:
    @pytest.mark.parametrize(
        ("crs", "pixel", "half_side"),
        [
            (UTM_15N, 5.0, 400.0),
            (UTM_15N, 50.0, 400.0),
            ("EPSG:4326", 5e-5, 5e-3),
            ("EPSG:26915", 4.0, 400.0),
            ("EPSG:26975", 3.0, 400.0),
            ("EPSG:3417", 20.0, 1500.0),
            ("EPSG:26715", 5.0, 400.0),
            ("EPSG:3857", 5.0, 400.0),
            ("+proj=utm +zone=15 +ellps=clrk66 +towgs84=-8,160,176 +units=m", 5.0, 400.0),
            ("+proj=laea +lat_0=41 +lon_0=-93 +datum=WGS84", 7.0, 400.0),
        ],
    )
    def test_a_plane_is_the_same_plane_in_any_reference_system(
        self, tmp_path: Path, crs: str, pixel: float, half_side: float
    ) -> None:
        site = load(tmp_path, geotiff(plane, crs, pixel, half_side))
        assert np.abs(error_m(site.elevation, plane)).max() < 1e-4
        assert site.airspace.elevation is site.elevation

    def test_a_ridge_is_off_by_its_slope_over_half_a_pixel_and_half_a_cell(
        self, tmp_path: Path
    ) -> None:
        error = error_m(load(tmp_path, geotiff(ridge, pixel=4.0)).elevation, ridge)
        assert np.abs(error).max() < 0.5 * (4.0 / 2 + 4.01 / 2)
        assert np.abs(error).mean() < 0.1

    @settings(
        max_examples=examples(15), suppress_health_check=[HealthCheck.function_scoped_fixture]
    )
    @given(st.integers(0, 2**32 - 1), st.floats(0.3, 0.95), st.floats(0.0, 90.0))
    def test_with_cells_wider_than_pixels_no_peak_is_lost(
        self, tmp_path: Path, seed: int, pixel_m: float, turned_deg: float
    ) -> None:
        random = np.random.default_rng(seed)
        side = int(150.0 / pixel_m)
        heights = 275.0 + random.uniform(-5.0, 5.0, (side, side))
        corner, _ = square(UTM_15N, pixel_m, 0.0)
        middle = Affine.translation(-side / 2, -side / 2)
        transform = corner @ Affine.rotation(turned_deg) @ middle
        tiff = written(heights, crs=UTM_15N, transform=transform)
        model = load(tmp_path, tiff, head=HEAD.replace("= 200", "= 20")).elevation
        assert model is not None
        assert model.grid.cell_m == 1.0
        places = random.uniform(-19.0, 19.0, (300, 2))
        rows, cols = pixels_at(UTM_15N, transform, places).T
        assert (ground_heights_m(model, places) >= heights[rows, cols] - 1e-9).all()

    def test_it_reaches_as_far_as_a_vehicle_may_fly(self, tmp_path: Path) -> None:
        latitude, longitude, _ = geo_from_enu(FRAME, [(30.0, -140.0, 0.0)])
        vehicle = (
            '[[vehicles]]\nserial = "A"\npad = { altitude_m = 279.8, '
            f"latitude_deg = {latitude[0]}, longitude_deg = {longitude[0]} }}\n"
        )
        model = load(tmp_path, geotiff(plane, half_side=500.0), more=vehicle).elevation
        assert model is not None
        corners = np.array([(-200.0, 200.0), (230.0, -340.0)])
        assert ground_heights_m(model, corners) == pytest.approx(plane(*corners.T))

    def test_a_wide_area_gets_wider_cells(self, tmp_path: Path) -> None:
        tiff = geotiff(plane, pixel=4.0, half_side=600.0)
        model = load(tmp_path, tiff, head=HEAD.replace("= 200", "= 8000")).elevation
        assert model is not None
        assert model.grid.cell_m == pytest.approx(16.0, abs=0.1)
        assert model.grid.rows * model.grid.cols < 1.01 * MOST_CELLS
        assert np.isfinite(ground_heights_m(model, PLACES_M)).all()

    def test_the_geoids_height_is_added_to_heights_above_it(self, tmp_path: Path) -> None:
        tiff = geotiff(lambda east, north: plane(east, north) + 31.5)
        assert np.abs(error_m(load(tmp_path, tiff, GEOID).elevation, plane)).max() < 1e-6

    def test_whole_numbers_scaled_heights_and_gaps_are_read(self, tmp_path: Path) -> None:
        tiff = geotiff(
            lambda east, north: np.where(east > 100.0, -32768.0, 275.0 + 0.0 * north),
            dtype="int16",
            nodata=-32768,
        )
        model = load(tmp_path, tiff).elevation
        assert model is not None
        is_known = np.isfinite(ground_heights_m(model, PLACES_M))
        assert is_known[PLACES_M[:, 0] < 90.0].all()
        assert not is_known[PLACES_M[:, 0] > 110.0].any()
        gaps = geotiff(lambda east, north: np.where(east > 100.0, np.nan, 275.0 + 0.0 * north))
        assert np.isnan(error_m(load(tmp_path, gaps).elevation, plane)).any()

    @pytest.mark.parametrize(
        ("crs", "table"),
        [
            ("EPSG:4979", WGS84),
            ("EPSG:32615+5773", GEOID),
            ("EPSG:26915+5703", GEOID),
        ],
    )
    def test_a_file_may_say_its_datum_itself_if_it_is_the_one_in_site_toml(
        self, tmp_path: Path, crs: str, table: str
    ) -> None:
        raised_m = 31.5 if table == GEOID else 0.0
        flat = np.full((200, 200), 275.0 + raised_m)
        is_degrees = crs == "EPSG:4979"
        transform, _ = square(
            "EPSG:4326" if is_degrees else UTM_15N,
            5e-5 if is_degrees else 5.0,
            5e-3 if is_degrees else 500.0,
        )
        tiff = written(flat, crs=crs, transform=transform)
        model = load(tmp_path, tiff, table).elevation
        assert model is not None
        assert ground_heights_m(model, PLACES_M) == pytest.approx(275.0)
        other = GEOID if table == WGS84 else WGS84
        assert "expected heights with elevation.datum = " in refusal(tmp_path, tiff, other)

    def test_nothing_is_asked_of_the_network(self, tmp_path: Path) -> None:
        set_network_enabled(True)
        try:
            load(tmp_path, geotiff())
            assert not is_network_enabled()
        finally:
            set_network_enabled(False)


def flat(side: int = 160, **profile: Any) -> bytes:
    """Return a file of flat ground with whatever else is to be wrong with it."""
    transform, _ = square(UTM_15N, 5.0, 400.0)
    bands = profile.pop("bands", np.full((side, side), 275.0, "float32"))
    return written(bands, **{"crs": UTM_15N, "transform": transform, **profile})


def test_the_files_with_faults_are_whole_otherwise(tmp_path: Path) -> None:
    assert load(tmp_path, flat()).elevation is not None


FAR_AWAY = Affine(5.0, 0.0, 100_000.0, 0.0, -5.0, 4_000_000.0)
X, Y = square(UTM_15N, 5.0, 0.0)[0] @ (0.0, 0.0)
COARSE = Affine(500.0, 0.0, 400_000.0, 0.0, -500.0, 4_700_000.0)
PICTURE = np.zeros((3, 160, 160), np.uint8)


@pytest.mark.parametrize(
    ("tiff", "message"),
    [
        (b"", "expected a GeoTIFF, got an empty file; export"),
        (b"not a picture", "expected a GeoTIFF, got a file of another kind; "),
        (b"II*\x00", "expected a whole GeoTIFF, got one cut short or damaged; export it again"),
        (
            b"<VRTDataset rasterXSize='1' rasterYSize='1'/>",
            "expected a GeoTIFF, got a file of another kind; ",
        ),
        (flat()[:2_000], "expected a whole GeoTIFF, got one cut short or damaged; export it again"),
        (flat()[:200], "expected a GeoTIFF"),
        (bytes(64 * 1024 * 1024 + 1), "expected at most 67108864 bytes, got more"),
        (flat(bands=PICTURE), "got 3 of uint8; is it a picture?"),
        (flat(bands=PICTURE[0]), "got 1 of uint8; is it a picture?"),
        (flat(bands=np.zeros((9, 9), np.complex64)), "got 1 of complex64; is it a picture?"),
        (flat(crs=None), "expected a GeoTIFF with a coordinate reference system and its place"),
        (flat(transform=None), "and its place in it, got one without"),
        (flat(crs="EPSG:4978"), "expected geographic or projected coordinates, got 'WGS 84'"),
        (
            flat(crs="+proj=utm +zone=15 +ellps=clrk66 +units=m"),
            "expected a coordinate reference system that PROJ relates to WGS84, got: ",
        ),
        (
            flat(crs="+proj=utm +zone=15 +ellps=clrk66 +nadgrids=/etc/passwd +units=m"),
            "expected a coordinate reference system without grid files of its own; export it in ",
        ),
        (flat(transform=Affine(1e-9, 0, X, 0, -1e-9, Y)), "of 0.01 to 100 m, got 1e-09 m; is its"),
        (flat(transform=FAR_AWAY), "expected heights around the site's origin, got none; does"),
        (flat(transform=COARSE), "expected pixels of 0.01 to 100 m, got 500 m"),
        (
            flat(crs="EPSG:4326"),
            "of 0.01 to 100 m, got 4.15e+05 m; is its coordinate reference sys",
        ),
        (flat(bands=np.full((160, 160), np.nan)), "around the site's origin, got none; does the"),
        (flat(nodata=275.0), "around the site's origin, got none; does the file cover the site"),
        (flat(bands=np.full((160, 160), np.inf)), "expected heights of -1000 to 10000 m, got inf"),
        (
            flat(bands=np.full((160, 160), -9999.0)),
            "expected heights of -1000 to 10000 m, got -9999; if that stands for no data, declare",
        ),
        (
            flat(bands=np.full((160, 160), 243.5)),
            "expected ground within 10 m of origin.ground_altitude_m in site.toml, 275 m above the "
            "ellipsoid, got 243.5 m; are its heights in metres, and is elevation.datum right?",
        ),
        (flat(unit="ft"), "expected heights in metres, got the unit 'ft'; convert them"),
        (flat(crs="EPSG:26915+6360"), "in metres, got the unit 'US survey foot'; convert them"),
        (
            geotiff(lambda e, n: np.where(np.hypot(e, n) < 50.0, np.nan, 275.0 + 0.0 * e)),
            "expected a height at the site's origin, got none",
        ),
    ],
)
def test_an_error_is_one_sentence_with_the_file(
    tmp_path: Path, tiff: bytes, message: str, caplog: pytest.LogCaptureFixture
) -> None:
    result = refusal(tmp_path, tiff)
    assert result.startswith(FILE)
    assert message in result
    assert caplog.records == []


def test_a_file_with_metres_and_feet_is_refused(tmp_path: Path) -> None:
    assert "expected heights in metres, got 'US survey foot'" in refusal(
        tmp_path, flat(crs="EPSG:26915+6360", unit="m"), GEOID
    )


def test_more_pixels_than_memory_should_hold_are_refused(tmp_path: Path) -> None:
    transform, _ = square(UTM_15N, 0.05, 250.0)
    huge = {"tiled": True, "blockxsize": 4096, "blockysize": 4096, "sparse_ok": True}
    tiff = sparse(10_000, transform=transform, **huge)
    assert "expected at most 16000000 pixels around the site, got " in refusal(tmp_path, tiff)


def test_a_strip_that_unpacks_to_a_flood_is_refused(tmp_path: Path) -> None:
    transform, _ = square(UTM_15N, 5.0, 400.0)
    tiff = sparse(10_000, transform=transform, blockysize=10_000, sparse_ok=True)
    assert "expected strips or tiles of at most 134217728 bytes, got 10000 x 10000" in refusal(
        tmp_path, tiff
    )


def sparse(side: int, **profile: Any) -> bytes:
    """Return a file that claims many pixels and holds none."""
    with MemoryFile() as memory:
        with memory.open(
            driver="GTiff",
            count=1,
            height=side,
            width=side,
            dtype="float32",
            crs=UTM_15N,
            compress="deflate",
            **profile,
        ):
            pass
        return bytes(memory.read())


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("", "/site.toml: elevation.datum is missing: expected 'geoid' or 'wgs84'"),
        ('datum = "msl"', "elevation.datum: expected 'geoid' or 'wgs84', got 'msl'"),
        (
            'datum = "geoid"',
            "elevation.geoid_height_m: expected one with datum = 'geoid' and none "
            "with 'wgs84', got none with 'geoid'",
        ),
        ('datum = "wgs84"\ngeoid_height_m = -31.5', "got one with 'wgs84'"),
        (
            'datum = "geoid"\ngeoid_height_m = 400',
            "geoid_height_m: expected a number of -120 to 100, got 400",
        ),
        ('datum = "geoid"\ngeoid_height_m = nan', "geoid_height_m: expected a finite number"),
        (
            'datum = "wgs84"\nunit = "ft"',
            "elevation: expected only the keys file, datum, geoid_height_m, got 'unit'",
        ),
    ],
)
def test_the_datum_is_never_guessed(tmp_path: Path, table: str, message: str) -> None:
    assert message in refusal(tmp_path, flat(), table)


def test_the_file_lies_in_the_folder(tmp_path: Path) -> None:
    (tmp_path / "site.toml").write_text(f'{HEAD}[elevation]\nfile = "../x.tif"\n{WGS84}\n')
    with pytest.raises(SiteError, match=r"elevation\.file: .* which leads out of it"):
        load_site(tmp_path)


def test_a_pad_that_lies_in_the_air_or_the_ground_is_refused(tmp_path: Path) -> None:
    pad = "pad = { latitude_deg = 41.9012, longitude_deg = -93.6034, altitude_m = 244 }"
    assert (
        "/site.toml: vehicles (entry 1).pad: expected an altitude within 10 m of the elevation "
        "model's ground, got one -31.0 m from it; altitudes count from the WGS84 ellipsoid"
    ) in refusal(tmp_path, flat(), more=f'[[vehicles]]\nserial = "A"\n{pad}\n')


WHOLE = geotiff(plane, pixel=20.0, dtype="float32", compress="deflate")


@settings(max_examples=examples(300), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, len(WHOLE)), st.binary(max_size=12), st.booleans())
@example(0, b"", False)
@example(216, b"\x00\x00\x00\x00\x00\x01", False)
@example(473, b"\x02", False)
def test_no_bytes_raise_anything_but_a_site_error(
    tmp_path: Path, at: int, noise: bytes, is_cut: bool
) -> None:
    result = outcome(tmp_path, WHOLE[:at] + noise + (b"" if is_cut else WHOLE[at + len(noise) :]))
    assert result.isprintable()
    assert result == "read" or result.startswith(str(tmp_path / "ground.tif"))


def outcome(folder: Path, tiff: bytes) -> str:
    try:
        load(folder, tiff)
    except SiteError as problem:
        return str(problem)
    return "read"
