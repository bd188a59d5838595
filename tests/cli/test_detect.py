"""`recon detect` on a recorded flight: a field under a shadow that passes, and refusals."""

import csv
from pathlib import Path

import cv2
import numpy as np
import pytest
import rasterio
from tools.demo_site import demo_camera
from typer.testing import CliRunner, Result

from recon.camera import format_camera
from recon.cli.commands import app
from recon.geo import point_from_enu
from recon.model.geo import GeoPoint, LocalFrame

FRAMES = 8
HEIGHT_M = 120.0


SHADE_BGR = np.array([0.5, 0.36, 0.21])
"""Shade over sun in light, as real frames show it."""


class Ground:
    """Textured ground seen by a level camera; a dark band crosses it, 30 m from frame to frame."""

    def __init__(self) -> None:
        camera = demo_camera().scaled_to(360, 640)
        row, col = np.mgrid[0:360, 0:640].reshape(2, -1)
        rays = np.nan_to_num(camera.unproject(np.stack([col, row], axis=1))).reshape(360, 640, 3)
        self.is_ground = rays[..., 2] > 0.2
        depth = np.where(self.is_ground, rays[..., 2], 1.0)
        self.east_m = HEIGHT_M * rays[..., 0] / depth
        self.north_m = -HEIGHT_M * rays[..., 1] / depth
        land = cv2.GaussianBlur(np.random.default_rng(1).normal(0, 1, (800, 800)), (0, 0), 2.0)
        self.land = 140.0 + 10.0 * land / land.std()

    def levels(self, camera_east_m: float) -> np.ndarray:
        """Levels in sun, from a camera so far east of the origin."""
        at_row = np.clip(400 - self.north_m / 2.0, 0, 799).astype(int)
        at_col = np.clip(400 + (self.east_m + camera_east_m) / 2.0, 0, 799).astype(int)
        return self.land[at_row, at_col]

    def is_shade(self, number: int, camera_east_m: float = 0.0) -> np.ndarray:
        return np.abs(self.east_m + camera_east_m - band_east_m(number)) < 40.0

    def written(self, levels: np.ndarray, number: int, file: Path) -> None:
        noise = np.random.default_rng(number).normal(0, 1.5, levels.shape)
        shown = np.where(
            self.is_ground.reshape(360, 640, *[1] * (levels.ndim - 2)),
            np.clip(levels + noise, 30, 255),
            0,
        )
        cv2.imwrite(str(file), shown.astype(np.uint8))


def band_east_m(number: int) -> float:
    return -100.0 + 30.0 * number


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Gray frames of 640 x 360."""
    folder, ground = tmp_path_factory.mktemp("flight"), Ground()
    (folder / "lens.txt").write_text(format_camera(demo_camera()))
    (folder / "frames").mkdir()
    for number in range(FRAMES):
        light = np.where(ground.is_shade(number), 0.5, 1.0)
        ground.written(ground.levels(0.0) * light, number, folder / "frames" / f"{number:03d}.png")
    return folder


MOVED_EAST_M = 20.0
PLACE = LocalFrame(GeoPoint(44.5, -92.9, 200.0))


@pytest.fixture(scope="module")
def moved_flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Colour frames from 20 m east of where the marked frame was taken, which shows no shade."""
    folder, ground = tmp_path_factory.mktemp("moved"), Ground()
    (folder / "lens.txt").write_text(format_camera(demo_camera()))
    (folder / "GCPs.txt").write_text(control_points())
    (folder / "frames").mkdir()
    colour = np.array([0.8, 1.0, 0.9])
    ground.written(ground.levels(0.0)[..., None] * colour, 99, folder / "marked.png")
    for number in range(FRAMES):
        is_shade = ground.is_shade(number, MOVED_EAST_M)[..., None]
        light = np.where(is_shade, SHADE_BGR, 1.0) ** (1.0 / 2.2) * colour
        levels = ground.levels(MOVED_EAST_M)[..., None] * light
        ground.written(levels, number, folder / "frames" / f"{number:03d}.png")
    return folder


def control_points() -> str:
    """Eight places round the point below the camera, marked where the lens shows them."""
    camera, lines = demo_camera().scaled_to(360, 640), []
    for number in range(8):
        turn, far_m = np.pi * number / 4.0, 60.0 + 10.0 * number
        east_m, north_m = far_m * np.cos(turn), far_m * np.sin(turn)
        ((col, row),) = camera.project(np.array([[east_m, -north_m, HEIGHT_M]]))
        place = point_from_enu(PLACE, (east_m, north_m, 0.0))
        degrees = f"{place.latitude_deg:.9f}, {place.longitude_deg:.9f}"
        lines.append(f"P{number}, {col:.3f}, {row:.3f}, {degrees}, {place.ellipsoid_height_m:.3f}")
    return "\n".join(lines) + "\n"


def detect(folder: Path, out: Path, *words: str) -> Result:
    place = ["--height-m", "120", "--latitude-deg", "44.5", "--longitude-deg", "-92.9"]
    lens = ["--camera", str(folder / "lens.txt"), "--out", str(out)]
    return CliRunner().invoke(app, ["detect", str(folder / "frames"), *lens, *place, *words])


def test_a_flight_gives_maps_a_sheet_and_cover_over_time(flight: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ["--method", "otsu", "--step-s", "5", "--start-utc", "2025-06-20T18:00:00"]
    done = detect(flight, out, *words, "--every", "2")
    assert done.exit_code == 0, done.output
    names = sorted(path.name for path in out.iterdir())
    assert names == [
        "contact-sheet.png",
        "cover.csv",
        *(f"shade-{n:05d}.tif" for n in range(0, FRAMES, 2)),
    ]
    with (out / "cover.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["frame"] for row in rows] == [f"{n:03d}.png" for n in range(FRAMES)]
    assert [float(row["time_s"]) for row in rows] == [5.0 * n for n in range(FRAMES)]
    for row in rows:
        shares = [float(row[name]) for name in ("in_sun", "in_shade", "unknown")]
        assert sum(shares) == pytest.approx(1.0, abs=2e-4)
        assert 0.15 < shares[1] < 0.35
        assert row["registration"] == "registered"
    with rasterio.open(out / "shade-00004.tif") as dataset:
        transmittance = dataset.read(1)
        assert dataset.tags()["RECON_CAPTURED_UTC"] == "2025-06-20T18:00:20+00:00"
        # The band's middle is 20 m east of the camera, over which the raster is centred.
        middle_col, middle_row = dataset.width // 2 + 5, dataset.height // 2
        assert np.nanmean(transmittance[middle_row - 4 : middle_row + 5, middle_col]) < 0.5
        assert np.nanmean(transmittance[middle_row - 4 : middle_row + 5, 4:10]) > 0.5
    sheet = cv2.imread(str(out / "contact-sheet.png"))
    assert sheet is not None
    assert sheet.shape == (512, 6 * 256, 3)


@pytest.mark.parametrize(
    ("name", "data", "words"),
    [
        ("000.png", b"text", "000.png: expected a JPEG or PNG file, got one that begins with"),
        ("003.jpg", b"\xff\xd8\xff", "003.jpg: JPEG: expected a frame header"),
    ],
)
def test_a_broken_frame_is_named_and_nothing_is_written(
    flight: Path, tmp_path: Path, name: str, data: bytes, words: str
) -> None:
    (tmp_path / "lens.txt").write_text((flight / "lens.txt").read_text())
    frames = tmp_path / "frames"
    frames.mkdir()
    (frames / "001.png").write_bytes((flight / "frames" / "001.png").read_bytes())
    (frames / name).write_bytes(data)
    done = detect(tmp_path, tmp_path / "out")
    assert (done.exit_code, done.stdout) == (2, "")
    assert words in done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["frames", "lens.txt"]


def test_wrong_use_is_one_line(flight: Path, tmp_path: Path) -> None:
    for words, expected in (
        (["--method", "magic"], "--method: expected "),
        (["--height-m", "0"], "expected --gcps FILE, or --height-m of 1 to 1000"),
        (["--camera", str(flight / "frames/000.png")], "expected"),
    ):
        done = detect(flight, tmp_path / "out", *words)
        assert (done.exit_code, done.stdout) == (2, "")
        assert expected in done.stderr
        assert len(done.stderr.splitlines()) == 1
    used = tmp_path / "used"
    used.mkdir()
    (used / "file").touch()
    assert "expected a new or empty folder" in detect(flight, used).stderr


def test_a_video_is_read_at_the_step_asked_for(flight: Path, tmp_path: Path) -> None:
    video = tmp_path / "flight.avi"
    writer = cv2.VideoWriter(str(video), cv2.VideoWriter.fourcc(*"MJPG"), 2.0, (640, 360))
    for name in sorted((flight / "frames").iterdir()):
        writer.write(cv2.imread(str(name)))
    writer.release()
    place = ["--height-m", "120", "--latitude-deg", "44.5", "--longitude-deg", "-92.9"]
    lens = ["--camera", str(flight / "lens.txt"), "--out", str(tmp_path / "out")]
    done = CliRunner().invoke(app, ["detect", str(video), *lens, *place, "--method", "otsu"])
    assert done.exit_code == 0, done.output
    with (tmp_path / "out/cover.csv").open() as file:
        assert [row["time_s"] for row in csv.DictReader(file)] == ["0.00", "1.00", "2.00", "3.00"]


def test_frames_are_placed_by_a_marked_frame_from_elsewhere(
    moved_flight: Path, tmp_path: Path
) -> None:
    lens = ["--camera", str(moved_flight / "lens.txt"), "--out", str(tmp_path / "out")]
    points = ["--gcps", str(moved_flight / "GCPs.txt")]
    marked = ["--marked", str(moved_flight / "marked.png")]
    words = ["detect", str(moved_flight / "frames"), *lens, *points, *marked, "--step-s", "5"]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    with (tmp_path / "out/cover.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {row["registration"] for row in rows} == {"registered"}
    # Shade is known from the fourth keyframe on; then a band of 80 m is in it.
    for number in range(4, FRAMES):
        with rasterio.open(tmp_path / f"out/shade-{number:05d}.tif") as dataset:
            transmittance = dataset.read(1)
            middle_m = dataset.transform.c + dataset.width * dataset.res[0] / 2.0
            east_m = dataset.transform.c + (np.arange(dataset.width) + 0.5) * dataset.res[0]
        across = transmittance[transmittance.shape[0] // 2 - 8 : transmittance.shape[0] // 2 + 8]
        is_shade = (across < 0.5).mean(axis=0) > 0.5  # of the unknown rim it is False
        found_m = float(np.mean(east_m[is_shade]) - middle_m)
        assert found_m == pytest.approx(band_east_m(number), abs=6.0)
        assert is_shade.sum() * dataset.res[0] == pytest.approx(80.0, abs=12.0)


def test_a_real_frame_is_placed_by_its_control_points(fisheye_data: Path, tmp_path: Path) -> None:
    (tmp_path / "frames").mkdir()
    data = (fisheye_data / "becker-1/RefFrame.jpeg").read_bytes()
    (tmp_path / "frames/0.jpeg").write_bytes(data)
    lens = ["--camera", str(fisheye_data / "camera-model.txt")]
    points = ["--gcps", str(fisheye_data / "becker-1/GCPs.txt"), "--out", str(tmp_path / "out")]
    words = ["detect", str(tmp_path / "frames"), *lens, *points, "--method", "otsu"]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    with rasterio.open(tmp_path / "out/shade-00000.tif") as dataset:
        assert np.isfinite(dataset.read(1)).mean() > 0.9
        assert 250.0 < dataset.width * dataset.res[0] < 420.0
