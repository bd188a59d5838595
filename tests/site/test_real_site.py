"""A site made of a real frame: from the folder to the ground."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from recon.camera import GroundProjector, load_control_points
from recon.geo import enu_from_points
from recon.model.imagery import Frame
from recon.site import load_site

SITE_TOML = """
name = "Becker"
[origin]
latitude_deg = 45.3455
longitude_deg = -93.8590
ground_altitude_m = 288.0
[imager]
serial = "IMAGER"
control_points_image_size_px = [3840, 2160]
[ground_image]
width_m = 600.0
height_m = 600.0
"""


@pytest.fixture
def becker(fisheye_data: Path, tmp_path: Path) -> Path:
    """A site's folder of the real frame becker-1."""
    shutil.copy(fisheye_data / "camera-model.txt", tmp_path)
    for name in ("GCPs.txt", "RefFrame.jpeg"):
        shutil.copy(fisheye_data / "becker-1" / name, tmp_path)
    (tmp_path / "site.toml").write_text(SITE_TOML)
    return tmp_path


def test_a_real_frame_lies_on_the_ground_of_its_site(becker: Path) -> None:
    site = load_site(becker)
    assert site.imager is not None
    assert site.frame is not None
    assert site.ground_grid is not None
    assert site.imager.solution is not None
    assert site.imager.solution.rms_px == pytest.approx(3.62, abs=0.02)
    jpeg = (becker / "RefFrame.jpeg").read_bytes()
    projector = GroundProjector(site.ground_grid, site.imager.camera, site.imager.image_circle)
    frame = Frame(1, "IMAGER", 10, 5, 0.2, jpeg=jpeg)
    image = projector.project(frame, site.imager.marked_pose)
    assert image.valid.mean() > 0.75
    points = becker / "GCPs.txt"
    # Point A is where a pale track forks: brighter than the meadow beside it.
    enu = enu_from_points(site.frame, [point.place for point in load_control_points(points)])
    rows = np.floor(site.ground_grid.north_m - enu[:, 1]).astype(int)
    cols = np.floor(enu[:, 0] - site.ground_grid.west_m).astype(int)
    assert image.valid[rows, cols].all()
    crossing = image.rgb[rows[0] - 6 : rows[0] + 7, cols[0] - 6 : cols[0] + 7].mean(axis=2)
    beside = image.rgb[rows[0] - 30 : rows[0] - 15, cols[0] - 40 : cols[0] - 20].mean(axis=2)
    assert crossing.max() > beside.mean() + 20.0
