"""The mosaic of a made flight: what each pixel shows, where it lies, and what the files state."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
import rasterio
from tests.product.made_flight import FRAME, HEIGHT_M, sun
from tests.product.mosaic.made_mosaic import (
    BRIGHT,
    SWING,
    WAVE_M,
    MadeMosaic,
    ground_of_pixels,
    wave,
)

from recon.geo import geo_from_enu
from recon.product.mosaic import Light, MosaicBand, MosaicReport
from recon.product.mosaic.band_rasters import band_rasters
from recon.product.mosaic.choice import STEP_PX
from recon.product.mosaic.pixels import Box
from recon.product.photos.band import PhotoBand as CameraBand
from recon.product.photos.shots import CameraShot


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> MadeMosaic:
    return MadeMosaic(tmp_path_factory.mktemp("made"))


@pytest.fixture(scope="module")
def report(made: MadeMosaic) -> MosaicReport:
    return made.build(made.folder / "out").run()


def pixels(path: Path, band: str = "mosaic"):
    """The bands, and the easts (C,) and norths (R,) of the pixels' middles."""
    with rasterio.open(path / f"{band}.tif") as dataset:
        values, place = dataset.read(), dataset.transform
    east = place.c + place.a * (np.arange(values.shape[2]) + 0.5)
    north = place.f + place.e * (np.arange(values.shape[1]) + 0.5)
    return values, east, north


def off_m(values: np.ndarray, place_m: np.ndarray) -> float:
    """Return how far a wave of colours lies off where it should."""
    phase = 2.0 * np.pi * place_m / WAVE_M
    sine, cosine = (float((values * part(phase)).mean()) for part in (np.sin, np.cos))
    return float(np.arctan2(cosine, sine)) / (2.0 * np.pi) * WAVE_M


def test_every_pixel_was_in_sun(made: MadeMosaic, report: MosaicReport) -> None:
    values, _east, _north = pixels(made.folder / "out")
    is_there = values[3] == 255
    in_shade = values[2][is_there] < 0.5 * BRIGHT
    assert is_there.sum() * 0.2**2 > 0.9 * 180.0**2
    assert in_shade.mean() < 0.005


def test_what_was_photographed_in_sun_is_there(made: MadeMosaic, report: MosaicReport) -> None:
    values, east, north = pixels(made.folder / "out", "provenance")
    is_lit = np.zeros(values.shape[1:], dtype=bool)
    easts, norths = np.meshgrid(east, north)
    for index, timed in enumerate(made.photos):
        aim = timed.view.aim
        half_m = HEIGHT_M * np.tan(np.deg2rad(33.0))
        shown = (abs(easts - aim.east_m) < half_m) & (abs(norths - aim.north_m) < 0.75 * half_m)
        is_lit |= shown & (sun(easts, norths, made.at_s(index)) > 0.5)
    in_area = np.isfinite(values[5])
    assert (np.isnan(values[0]) & is_lit & in_area).sum() < 0.03 * (is_lit & in_area).sum()


def test_it_lies_where_it_should(made: MadeMosaic, report: MosaicReport) -> None:
    values, east, north = pixels(made.folder / "out")
    rows, cols = np.nonzero(values[3])
    assert abs(off_m(values[0][rows, cols] - 128.0, east[cols])) < 0.005
    assert abs(off_m(values[1][rows, cols] - 128.0, north[rows])) < 0.005
    wrong = np.abs(values[0][rows, cols] - wave(east[cols]))
    # A tenth of a metre is this much where the wave is steepest.
    assert np.quantile(wrong, 0.999) < SWING * 2.0 * np.pi / WAVE_M * 0.1


def test_gis_programs_find_its_place(made: MadeMosaic, report: MosaicReport) -> None:
    with rasterio.open(made.folder / "out" / "mosaic.tif") as dataset:
        from rasterio.warp import transform

        found = transform(dataset.crs, "EPSG:4326", [50.0], [-60.0])
        assert dataset.tags(ns="IMAGE_STRUCTURE")["LAYOUT"] == "COG"
        assert dataset.overviews(1)
    latitude, longitude, _height = geo_from_enu(FRAME, (50.0, -60.0, 0.0))
    assert np.allclose(np.ravel(found), [longitude[0], latitude[0]], atol=1e-8)


def test_provenance_states_each_pixels_photo(made: MadeMosaic, report: MosaicReport) -> None:
    colours, _east, _north = pixels(made.folder / "out")
    (index, at_s, transmittance, confidence, off_deg, light), east, north = pixels(
        made.folder / "out", "provenance"
    )
    taken = np.isfinite(index)
    by_pixel = np.repeat(np.repeat(taken, STEP_PX, axis=0), STEP_PX, axis=1)
    assert np.array_equal(by_pixel, colours[3] == 255)
    assert (light[taken] == Light.SUN).all()
    assert (transmittance[taken] >= 0.6).all()
    assert (confidence[taken] > 0.5).all()
    row, col = np.argwhere(taken)[len(np.argwhere(taken)) // 2]
    number = int(index[row, col])
    aim = made.photos[number].view.aim
    across_m = np.hypot(east[col] - aim.east_m, north[row] - aim.north_m)
    assert off_deg[row, col] == pytest.approx(np.rad2deg(np.arctan(across_m / HEIGHT_M)), abs=0.01)
    assert at_s[row, col] == pytest.approx(made.at_s(number), abs=0.001)
    with (made.folder / "out" / "photos.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert rows[number]["name"] == made.photos[number].photo.name
    total_m2 = sum(float(each["taken_m2"]) for each in rows)
    assert total_m2 == pytest.approx(taken.sum() * (0.2 * STEP_PX) ** 2, rel=0.01)


def test_cells_at_the_edges_of_photos_are_whole(tmp_path: Path) -> None:
    """With few photos many cells lie across an edge: part of them would be missing, or mirrored."""
    made = MadeMosaic(tmp_path, every=12, size=(320, 240))
    made.build(tmp_path / "out", resolution_m=0.5, fills=True).run()
    colours, _east, north = pixels(tmp_path / "out")
    index, _east, _north = pixels(tmp_path / "out", "provenance")
    taken = np.repeat(np.repeat(np.isfinite(index[0]), STEP_PX, axis=0), STEP_PX, axis=1)
    assert np.array_equal(taken, colours[3] == 255)
    rows, cols = np.nonzero(taken)
    wrong = np.abs(colours[1][rows, cols] - wave(north[rows]))
    assert (wrong < 0.5 * SWING).all()


def test_report_counts_what_the_raster_shows(made: MadeMosaic, report: MosaicReport) -> None:
    stated = json.loads((made.folder / "out" / "mosaic.json").read_text())
    values, _east, _north = pixels(made.folder / "out", "provenance")
    for light in Light:
        area_m2 = (values[5] == light).sum() * (0.2 * STEP_PX) ** 2
        assert stated["areas_m2"][light.name.lower()] == pytest.approx(area_m2, abs=0.1)
        assert report.areas_m2[light] == pytest.approx(area_m2)
    assert stated["RECON_BRIGHTNESS".lower()] == "as photographed"
    assert (made.folder / "out" / "preview.png").read_bytes().startswith(b"\x89PNG")
    assert not list((made.folder / "out").glob("windows-*"))


def test_no_photo_is_read_twice(made: MadeMosaic, report: MosaicReport) -> None:
    assert report.decoded == report.used
    assert report.used < report.photos


def test_shade_is_filled_when_asked(tmp_path: Path) -> None:
    made = MadeMosaic(tmp_path, every=12)
    empty = made.build(tmp_path / "empty", resolution_m=0.4).run()
    filled = made.build(tmp_path / "filled", resolution_m=0.4, fills=True).run()
    assert empty.areas_m2[Light.SHADE] > 0.0
    assert empty.filled_m2 == 0.0
    assert filled.filled_m2 == pytest.approx(empty.areas_m2[Light.SHADE], rel=1e-6)
    assert filled.areas_m2 == empty.areas_m2
    values, _east, _north = pixels(tmp_path / "filled", "provenance")
    in_shade = np.isfinite(values[0]) & (values[5] == Light.SHADE)
    assert (values[2][in_shade] < 0.6).all()


def test_brightness_is_evened_to_full_sun(tmp_path: Path) -> None:
    made = MadeMosaic(tmp_path, every=12)
    grey = MosaicBand(
        "mosaic", ("grey",), lambda i, s, b: half_bright(made, i, s, b), is_picture=False
    )
    made.build(tmp_path / "out", fills=True, is_evened=True, bands=[grey], resolution_m=0.4).run()
    values, _east, _north = pixels(tmp_path / "out")
    found = values[0][values[0] > 0]
    # Level 100 in full sun; in shade a fifth of the beam and all of the diffuse light: 40.
    assert np.median(found) == 100
    assert np.abs(found.astype(float) - 100.0).mean() < 6.0


def half_bright(made: MadeMosaic, index: int, shrink: int, box: Box) -> np.ndarray:
    blue = made.read(index, shrink, box)[..., 2] / BRIGHT
    return np.rint(100.0 * (0.25 + 0.75 * blue)).astype(np.uint8)[..., np.newaxis]


def test_bands_lie_on_one_grid(tmp_path: Path) -> None:
    made = MadeMosaic(tmp_path, every=12)

    def near_infrared(index: int, shrink: int, box: Box) -> np.ndarray:
        return made.read(index, shrink, box)[..., :1].astype(np.uint16) * 200

    bands = [
        MosaicBand("mosaic", ("red", "green", "blue"), made.read),
        MosaicBand("nir", ("near infrared",), near_infrared, "uint16", is_picture=False),
    ]
    made.build(tmp_path / "out", bands=bands, resolution_m=0.4).run()
    colours, east, north = pixels(tmp_path / "out")
    infrared, other_east, other_north = pixels(tmp_path / "out", "nir")
    assert infrared.dtype == np.uint16
    assert np.array_equal(east, other_east)
    assert np.array_equal(north, other_north)
    assert np.array_equal(infrared[0] > 0, colours[3] == 255)
    there = colours[3] == 255
    assert np.abs(infrared[0][there] / 200.0 - colours[0][there]).max() <= 1.0


def test_a_cameras_bands_lie_on_the_picture_in_colour(tmp_path: Path) -> None:
    """Files of 16 bits beside each photo, of another size and field, where photos have them."""
    made = MadeMosaic(tmp_path, every=12, size=(320, 240))
    shots, narrow_deg, size = [], 50.0, (200, 150)
    for index, timed in enumerate(made.photos):
        view = replace(timed.view, across_deg=narrow_deg, cols=size[0], rows=size[1])
        path = timed.photo.path.with_suffix(".NIR.TIF")
        values = wave(ground_of_pixels(view)[..., 0]) * 200.0
        cv2.imwrite(str(path), np.rint(values).astype(np.uint16))
        beside = replace(
            timed.photo, path=path, name=path.name, cols=size[0], rows=size[1],
            across_deg=narrow_deg, kind="band", band=CameraBand("NIR"),
        )  # fmt: skip
        shots.append(CameraShot(timed.photo, (beside,) if index else ()))
    build = made.build(tmp_path / "out", resolution_m=0.4)
    cameras = [placed.camera for placed in build.photos]
    build.bands = [*build.bands, *band_rasters(shots, made.photos, cameras)]
    build.run()
    colours, _east, _north = pixels(tmp_path / "out")
    infrared, _east, _north = pixels(tmp_path / "out", "mosaic-NIR")
    there = infrared[0] > 0
    assert 0.3 < there.sum() / (colours[3] == 255).sum() < 1.0
    assert (colours[3][there] == 255).all()
    # Photo, band and mosaic each have pixels of decimetres.
    off = np.abs(infrared[0][there] / 200.0 - colours[0][there])
    assert np.quantile(off, 0.99) < 0.2 * SWING
