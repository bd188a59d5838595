"""Mosaics by a finished run of OpenDroneMap, made by construction, and damaged ones."""

import json
from pathlib import Path

import numpy as np
import pytest
import rasterio
from tests.product.made_flight import FRAME
from tests.product.mosaic.made_mosaic import BRIGHT, SWING, WAVE_M, MadeMosaic, wave
from tests.product.mosaic.made_odm import CAMERA_ID, COLS, ROWS_PX, MadeOdm, up_m
from tests.product.mosaic.test_mosaic import off_m, pixels

from recon.model.errors import RecordError
from recon.product.mosaic import opened_odm


@pytest.fixture(scope="module")
def odm(tmp_path_factory: pytest.TempPathFactory) -> MadeOdm:
    folder = tmp_path_factory.mktemp("odm")
    return MadeOdm(MadeMosaic(folder, every=9, size=(COLS, ROWS_PX)), folder / "run")


@pytest.fixture
def run(odm: MadeOdm) -> Path:
    odm.write()
    yield odm.folder
    (odm.folder / "odm_report" / "shots.geojson").unlink()


def test_a_mosaic_over_its_surface_lies_within_centimetres(
    odm: MadeOdm, run: Path, tmp_path: Path
) -> None:
    with opened_odm(run, FRAME) as found:
        cameras = [found.cameras(odm.made.photos)[i] for i in range(len(odm.made.photos))]
        odm.made.build(tmp_path, cameras=cameras, ground=found.surface, read=odm.read).run()
    values, east, north = pixels(tmp_path)
    rows, cols = np.nonzero(values[3])
    assert len(rows) * 0.2**2 > 0.4 * 180.0**2
    assert abs(off_m(values[0][rows, cols] - 128.0, east[cols])) < 0.01
    assert abs(off_m(values[1][rows, cols] - 128.0, north[rows])) < 0.01
    wrong = np.abs(values[1][rows, cols] - wave(north[rows]))
    assert np.quantile(wrong, 0.99) < SWING * 2.0 * np.pi / WAVE_M * 0.05
    assert (values[2][rows, cols] < 0.5 * BRIGHT).mean() < 0.005


def test_poses_are_the_same_without_the_report(odm: MadeOdm, run: Path) -> None:
    with opened_odm(run, FRAME) as found:
        by_report = found.cameras(odm.made.photos)
    (run / "odm_report" / "shots.geojson").unlink()
    odm.write(has_report=False)
    with opened_odm(run, FRAME) as found:
        by_reconstruction = found.cameras(odm.made.photos)
    odm.write()
    for index, camera in by_report.items():
        place, to_camera = odm.pose(index)
        for each in (camera, by_reconstruction[index]):
            assert np.allclose(each.place_m, place, atol=0.02)
            assert np.allclose(each.rotation, to_camera.T, atol=2e-4)


def test_heights_are_those_of_the_file(odm: MadeOdm, run: Path) -> None:
    east, north = np.array([-80.0, 20.0, 90.0]), np.array([70.0, -10.0])
    with opened_odm(run, FRAME) as found:
        heights = found.surface.up_m(east, north)
        beyond = found.surface.up_m(np.array([1e5, 1e5 + 1.0]), np.array([1.0, 0.0]))
    easts, norths = np.meshgrid(east, north)
    assert np.allclose(heights, up_m(easts, norths), atol=0.01)
    assert np.isnan(beyond).all()


def text_of(run: Path, path: str) -> str:
    return (run / path).read_text()


def changed_camera(run: Path, **values: object) -> None:
    cameras = json.loads(text_of(run, "cameras.json"))
    cameras[CAMERA_ID] |= values
    (run / "cameras.json").write_text(json.dumps(cameras))


def changed_shot(run: Path, **values: object) -> None:
    shots = json.loads(text_of(run, "odm_report/shots.geojson"))
    shots["features"][0]["properties"] |= values
    (run / "odm_report" / "shots.geojson").write_text(json.dumps(shots))


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        (lambda run: (run / "cameras.json").unlink(), "cameras.json: expected a file of a finish"),
        (lambda run: (run / "cameras.json").write_bytes(b"\xff{"), "expected a file of OpenDrone"),
        (lambda run: (run / "cameras.json").write_text("[" * 100_000), "expected a file of OpenD"),
        (lambda run: changed_camera(run, projection_type="fisheye"), "--camera-lens brown"),
        (lambda run: changed_camera(run, focal_x=None), "expected focal_x and focal_y"),
        (lambda run: changed_camera(run, k1=float("nan")), "expected a file of OpenDroneMap"),
        (lambda run: changed_camera(run, focal_x=1e300), "expected a file of OpenDroneMap"),
        (lambda run: changed_camera(run, width=10**9), "expected a file of OpenDroneMap"),
        (lambda run: changed_camera(run, width=240, height=320), "expected 240 x 320 pixels"),
        (lambda run: changed_shot(run, camera="another"), "expected 'another', got none"),
        (lambda run: changed_shot(run, translation=[5e5, 1e6, 0.0]), "expected photos near"),
        (lambda run: changed_shot(run, translation=[1.0, 2.0]), "expected a file of OpenDroneM"),
        (lambda run: changed_shot(run, rotation=[float("inf")] * 3), "expected a file of OpenD"),
        (lambda run: (run / "odm_dem" / "dsm.tif").unlink(), "run OpenDroneMap with --dsm"),
        (lambda run: (run / "odm_dem" / "dsm.tif").write_text("dsm"), "expected a GeoTIFF"),
        (lambda run: (run / "odm_dem" / "dsm.tif").write_bytes(b"II*\0" + b"\0" * 60), "GeoTIFF"),
    ],
)
def test_a_damaged_run_is_refused_in_a_sentence(odm: MadeOdm, run: Path, damage, sentence) -> None:
    damage(run)
    with pytest.raises(RecordError, match=sentence), opened_odm(run, FRAME) as found:
        found.cameras(odm.made.photos)


def test_a_run_of_other_photos_is_refused(odm: MadeOdm, run: Path) -> None:
    text = text_of(run, "odm_report/shots.geojson").replace("SIM-", "OTHER-")
    (run / "odm_report" / "shots.geojson").write_text(text)
    with (
        pytest.raises(RecordError, match="with these photos, got one with"),
        opened_odm(run, FRAME) as found,
    ):
        found.cameras(odm.made.photos)


def test_a_picture_is_no_surface_model(run: Path) -> None:
    profile = {"driver": "GTiff", "width": 64, "height": 64, "count": 3, "dtype": "uint8"}
    with rasterio.open(
        run / "odm_dem" / "dsm.tif", "w", crs="EPSG:32615",
        transform=rasterio.Affine(1.0, 0.0, 4e5, 0.0, -1.0, 4.6e6), **profile,
    ):  # fmt: skip
        pass
    with pytest.raises(RecordError, match="is it a picture"), opened_odm(run, FRAME):
        pass
