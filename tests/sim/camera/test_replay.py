"""The imaging drone over a real field: one constructed with a known pose, and three real ones."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from recon.camera import (
    ControlPoint,
    TelemetryReference,
    format_camera,
    format_control_points,
    load_camera,
    mounted_pose,
)
from recon.geo import enu_from_point, geo_from_enu
from recon.model.geo import GeoPoint, LocalFrame
from recon.sim.camera.frames import CameraView
from recon.sim.camera.replay import load_replay
from recon.sim.errors import ReplayError
from recon.sim.fleet import IMAGER_SERIAL, ImagerSetup, SimulationConfig, build_fleet
from recon.site import demo_site_folder

ORIGIN = GeoPoint(44.0, -93.0, 300.0)
TRUE_POSITION_M = np.array([12.0, -30.0, 118.0])
PLACES_M = [(-100, 80), (20, 120), (110, 60), (90, -90), (-60, -120), (0, 10)]


def make_field(folder: Path) -> None:
    camera = load_camera(demo_site_folder() / "camera-model.txt")
    large = camera.scaled_to(2160, 3840)
    pose = mounted_pose(TelemetryReference(0.0, 0.0, 118.0, 50.0), TRUE_POSITION_M)
    places = np.array([(*p, 0.0) for p in PLACES_M])
    pixels = large.project((places - TRUE_POSITION_M) @ pose.rotation_enu_camera)
    globe = zip(*geo_from_enu(LocalFrame(ORIGIN), places), strict=True)
    points = tuple(
        ControlPoint(f"P{i}", *map(float, pixel), *map(float, place))
        for i, (pixel, place) in enumerate(zip(pixels, globe, strict=True))
    )
    picture = np.zeros((2160, 3840, 3), dtype=np.uint8)
    picture[:, :1920] = 200
    folder.mkdir()
    (folder / "GCPs.txt").write_text(format_control_points(points))
    (folder.parent / "camera-model.txt").write_text(format_camera(camera))
    assert cv2.imwrite(str(folder / "RefFrame.jpeg"), picture)


def test_the_imaging_drone_starts_where_the_frame_was_taken(tmp_path: Path) -> None:
    make_field(tmp_path / "field")
    rig, still = load_replay(tmp_path / "field")
    config = SimulationConfig(
        home=ORIGIN, vehicle_count=1, imagers={IMAGER_SERIAL: ImagerSetup(still, rig=rig)}
    )
    (app,) = build_fleet(config, 0)
    truth = app.true_reference()
    place = GeoPoint(truth.latitude_deg, truth.longitude_deg, 300.0)
    east_north = enu_from_point(LocalFrame(ORIGIN), place)[:2]
    assert east_north == pytest.approx(TRUE_POSITION_M[:2], abs=0.02)
    assert truth.height_above_takeoff_m == pytest.approx(118.0, abs=0.02)
    assert app.settings.home.ellipsoid_height_m == pytest.approx(300.0, abs=0.02)
    assert rig.pose_at(truth).position_enu_m == pytest.approx(rig.marked_pose.position_enu_m)


def test_the_frame_is_scaled_to_the_camera(tmp_path: Path) -> None:
    make_field(tmp_path / "field")
    _, still = load_replay(tmp_path / "field")
    picture = still.render(CameraView(0.0, 0, None))
    assert picture.shape == (720, 1280, 3)
    assert picture[100, 630, 0] > 190
    assert picture[100, 650, 0] < 10


def test_an_invalid_folder_is_refused_with_a_message(tmp_path: Path) -> None:
    with pytest.raises(ReplayError, match="expected a folder with RefFrame"):
        load_replay(tmp_path)
    make_field(tmp_path / "field")
    points = tmp_path / "field" / "GCPs.txt"
    lines = points.read_text().splitlines()
    points.write_text("\n".join(lines[:6]))
    with pytest.raises(ReplayError, match="at least 4"):
        load_replay(tmp_path / "field")
    points.write_text("A, 1, 2\n")
    with pytest.raises(ReplayError, match="line 1"):
        load_replay(tmp_path / "field")
    (tmp_path / "camera-model.txt").unlink()
    with pytest.raises(ReplayError, match="camera-model"):
        load_replay(tmp_path / "field")


@pytest.mark.parametrize(
    ("name", "height_m"), [("becker-1", 133.0), ("elgin-5", 124.0), ("grand-meadow-7", 139.0)]
)
def test_real_fields(fisheye_data: Path, name: str, height_m: float) -> None:
    rig, still = load_replay(fisheye_data / name)
    assert rig.marked.height_above_takeoff_m == pytest.approx(height_m, abs=2.0)
    picture = still.render(CameraView(0.0, 0, None))
    assert picture.shape == (720, 1280, 3)
    assert 30.0 < picture[200:500, 400:800].mean() < 220.0
