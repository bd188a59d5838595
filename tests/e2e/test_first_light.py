"""First light: real fisheye frames, sent by a simulated app as bytes, lie where they belong."""

import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest
from tests.station.imagers import imager_of

from recon.camera import GroundProjector
from recon.model.imagery import Frame, GroundImage, Registration
from recon.sim.app.camera_feed import FeedSettings, ImageFormat
from recon.sim.camera.replay import load_replay
from recon.sim.fleet import IMAGER_SERIAL, ImagerSetup, SimulationConfig, build_fleet
from recon.site import Site, load_site
from recon.station.kernel.build import first_state
from recon.station.kernel.virtual import VirtualDriver
from recon.station.kernel.worker import JobRunner

PLACES = {
    "becker-1": (45.3455, -93.8590, 288.0, 3.62),
    "elgin-5": (44.1291, -92.2942, 329.0, 1.27),
    "grand-meadow-7": (43.6226, -92.5617, 422.0, 1.97),
}
"""Origin, ground altitude and the fit of the control points that others reached, in pixels."""

SITE_TOML = """
name = "{name}"
[origin]
latitude_deg = {latitude}
longitude_deg = {longitude}
ground_altitude_m = {altitude}
[imager]
serial = "{serial}"
control_points_image_size_px = [3840, 2160]
"""


@pytest.fixture(params=PLACES)
def field(
    request: pytest.FixtureRequest, fisheye_data: Path, tmp_path: Path
) -> tuple[Path, Site, float]:
    """A real field's folder, a site made of it, and the fit to be reached."""
    name: str = request.param
    folder = fisheye_data / name
    latitude, longitude, altitude, rms_px = PLACES[name]
    shutil.copy(folder.parent / "camera-model.txt", tmp_path)
    shutil.copy(folder / "GCPs.txt", tmp_path)
    text = SITE_TOML.format(
        name=name, latitude=latitude, longitude=longitude, altitude=altitude, serial=IMAGER_SERIAL
    )
    (tmp_path / "site.toml").write_text(text, encoding="utf-8")
    return folder, load_site(tmp_path), rms_px


@pytest.mark.parametrize("image_format", ImageFormat)
def test_a_real_frame_comes_over_the_wire_and_lies_on_its_field(
    field: tuple[Path, Site, float], image_format: ImageFormat
) -> None:
    folder, site, rms_px = field
    assert site.imager is not None
    assert site.imager.solution.rms_px == pytest.approx(rms_px, abs=0.02)

    sent = load_replay(folder)[1].rgb
    image = _ground_image(folder, site, image_format)
    assert image.registration is Registration.REGISTERED

    assert site.ground_grid is not None
    projector = GroundProjector(site.ground_grid, site.imager.camera, site.imager.image_circle)
    expected, valid = projector.project_pixels(sent, site.imager.marked_pose)
    assert np.mean(valid == image.valid) > 0.97
    assert np.hypot(*_shift_m(image.rgb, expected, site.ground_grid.cell_m)) < 1.5


def _ground_image(folder: Path, site: Site, image_format: ImageFormat) -> GroundImage:
    """What the station makes of ten seconds of the eye's bytes."""
    rig, still = load_replay(folder)
    feed = FeedSettings(image_format=image_format)
    imager = ImagerSetup(still, feed, rig)
    config = SimulationConfig(
        home=rig.frame.origin, vehicle_count=1, imagers={IMAGER_SERIAL: imager}
    )
    driver = VirtualDriver(first_state(site), jobs=JobRunner(site))
    (app,) = build_fleet(config, start_ns=driver.now_ns)
    app.connected(driver.now_ns)
    driver.connect(app)
    driver.run_for(10.0)
    assert isinstance(driver.station.frames[IMAGER_SERIAL], Frame)
    imager_frames = imager_of(driver.station)
    assert imager_frames.latest_error is None
    image = imager_frames.ground_image
    assert image is not None
    return image


def _shift_m(a: np.ndarray, b: np.ndarray, cell_m: float) -> tuple[float, float]:
    grey = [cv2.cvtColor(x, cv2.COLOR_RGB2GRAY).astype(np.float32) for x in (a, b)]
    window = cv2.createHanningWindow(grey[0].shape[::-1], cv2.CV_32F)
    (east, south), _ = cv2.phaseCorrelate(grey[0].copy(), grey[1].copy(), window)
    return east * cell_m, south * cell_m
