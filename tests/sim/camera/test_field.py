"""The procedural land: drawn the same at every resolution, rendered through the lens."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from recon.camera import TelemetryReference, load_camera, mounted_pose
from recon.camera.image_circle import ImageCircle
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.imagery import CameraPose
from recon.sim.camera import CameraSettings, field
from recon.sim.camera.frames import CameraView
from recon.sim.errors import FrameSourceError
from recon.sim.land.farmland import lay_out
from recon.sim.land.farmland_raster import draw, draw_shadows, tileable_noise
from recon.sim.land.land_part import LandPart
from recon.sim.world import LayerSettings, Sky, SkySettings
from recon.sim.world.light import light_under
from recon.site import demo_site_folder

SEED = 5
HEIGHT_M = 120.0


@pytest.fixture(scope="module")
def camera():
    return load_camera(demo_site_folder() / "camera-model.txt")


@pytest.fixture(scope="module")
def frames(camera):
    circle = ImageCircle(camera.centre_col_px, camera.centre_row_px, 340.0)
    return field.FieldRenderer(camera, circle, SEED, imager=CameraSettings.perfect())


def pose(
    east_m: float = 0.0, north_m: float = 0.0, yaw_deg: float = 0.0, tilt_deg: float = 0.0
) -> CameraPose:
    reference = TelemetryReference(0.0, 0.0, HEIGHT_M, yaw_deg)
    return mounted_pose(reference, np.array([east_m, north_m, HEIGHT_M]), tilt_deg)


def correlation(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.corrcoef(a.ravel().astype(float), b.ravel().astype(float))[0, 1])


@pytest.mark.parametrize(
    ("east_m", "north_m", "yaw_deg", "tilt_deg"),
    [
        (0.0, 0.0, 0.0, 0.0),
        (40.0, -70.0, 33.0, 0.0),
        (-90.0, 20.0, -140.0, 0.0),
        (40.0, -70.0, 33.0, 20.0),
    ],
)
def test_a_picture_projected_on_the_ground_shows_the_land_where_it_is(
    frames, camera, east_m, north_m, yaw_deg, tilt_deg
) -> None:
    """Render, take the picture back to the ground by the camera room, compare with the raster."""
    there = pose(east_m, north_m, yaw_deg, tilt_deg)
    picture = frames.render(CameraView(0.0, 0, there))
    grid = GroundGrid(
        LocalFrame(GeoPoint(0.0, 0.0, 0.0)), east_m - 100, north_m + 100, 1.0, 200, 200
    )
    cols, rows = maps(grid, camera, there)
    seen = cv2.remap(picture, cols, rows, cv2.INTER_LINEAR)
    truth = raster_part(east_m, north_m)
    assert correlation(seen[20:-20, 20:-20], truth[20:-20, 20:-20]) > 0.97
    shifted = np.roll(truth, 4, axis=1)
    assert correlation(seen[20:-20, 20:-20], shifted[20:-20, 20:-20]) < correlation(
        seen[20:-20, 20:-20], truth[20:-20, 20:-20]
    )


def maps(grid: GroundGrid, camera, there):
    """Return where each ground cell's centre lies in the picture."""
    east = grid.west_m + (np.arange(grid.cols) + 0.5) * grid.cell_m
    north = grid.north_m - (np.arange(grid.rows) + 0.5) * grid.cell_m
    points = np.stack([*np.meshgrid(east, north), np.zeros((grid.rows, grid.cols))], axis=-1)
    rays = (points.reshape(-1, 3) - there.position_enu_m) @ there.rotation_enu_camera
    pixels = camera.project(rays).reshape(grid.rows, grid.cols, 2).astype(np.float32)
    return pixels[:, :, 0], pixels[:, :, 1]


def raster_part(east_m: float, north_m: float) -> np.ndarray:
    """Return the land 200 m around a place, at one metre, with the shadows of trees and roofs."""
    part = LandPart(round((-north_m - 100) / 0.5), round((east_m - 100) / 0.5), 400, 0.5)
    land, sky = lay_out(SEED), Sky(SkySettings(layers=()))
    light = light_under(sky, 0.0)
    shadow = draw_shadows(land, part, sky.sun_at(0.0))[:, :, np.newaxis] / 255.0
    fine = draw(land, part, SEED) * (1.0 - shadow * light.beam / (light.beam + light.sky)) ** 0.4545
    return cv2.resize(fine, (200, 200), interpolation=cv2.INTER_AREA)


def test_the_same_view_is_the_same_picture(frames) -> None:
    view = CameraView(3.0, 1, pose())
    assert np.array_equal(frames.render(view), frames.render(view))


def test_outside_the_image_circle_there_is_nothing(frames, camera) -> None:
    picture = frames.render(CameraView(0.0, 0, pose()))
    row, col = np.mgrid[: camera.rows, : camera.cols]
    radius = np.hypot(col - camera.centre_col_px, row - camera.centre_row_px)
    assert picture.shape == (camera.rows, camera.cols, 3)
    assert picture[radius > 342.0].max() == 0
    assert picture[radius < 330.0].min(axis=1).mean() > 30.0


def test_a_view_without_a_pose_is_refused(frames) -> None:
    with pytest.raises(FrameSourceError, match="expected a camera pose"):
        frames.render(CameraView(0.0, 0, None))


def test_a_coarse_raster_agrees_with_the_fine_one() -> None:
    land = lay_out(SEED)
    fine, coarse = (
        draw(land, LandPart(-size // 2, -size // 2, size, 512.0 / size), SEED)
        for size in (1024, 256)
    )
    shrunk = cv2.resize(fine, (256, 256), interpolation=cv2.INTER_AREA)
    assert correlation(shrunk, coarse) > 0.93


def test_noise_is_seamless_and_of_unit_strength() -> None:
    noise = tileable_noise(128, 3, smallest_cells=3.0, slope=1.5)
    assert noise.std() == pytest.approx(1.0, abs=1e-3)
    inner = np.abs(np.diff(noise, axis=1)).mean()
    assert np.abs(noise[:, 0] - noise[:, -1]).mean() < 2.0 * inner


def test_clouds_shade_the_land_and_leave_skylight(frames, camera) -> None:
    """Where nothing of the beam comes through, a picture is half as bright and a little bluer."""
    overcast = Sky(SkySettings(layers=(LayerSettings(cover=1.0),)))
    shaded = replace(frames, sky=overcast).render(CameraView(0.0, 0, pose())).astype(float)
    lit = frames.render(CameraView(0.0, 0, pose())).astype(float)
    near = slice(camera.rows // 2 - 60, camera.rows // 2 + 60)
    red, _green, blue = (shaded[near, near] / np.maximum(lit[near, near], 1.0)).mean(axis=(0, 1))
    assert 0.4 < red < blue < 0.65


def test_pictures_show_the_shadows_where_the_sky_has_them(frames, camera) -> None:
    sky = Sky(SkySettings(3, layers=(LayerSettings(cover=0.5, outer_scale_m=500.0),)))
    there = pose()
    shaded = replace(frames, sky=sky).render(CameraView(40.0, 0, there)).astype(float).sum(axis=2)
    lit = frames.render(CameraView(40.0, 0, there)).astype(float).sum(axis=2)
    grid = GroundGrid(LocalFrame(GeoPoint(0.0, 0.0, 0.0)), -150, 150, 2.0, 150, 150)
    cols, rows = maps(grid, camera, there)
    light = (shaded / np.maximum(lit, 1.0)) ** 2.2
    seen = cv2.remap(light.astype(np.float32), cols, rows, cv2.INTER_LINEAR)
    truth = sky.on_grid(grid, 40.0)
    assert 0.1 < (truth < 0.5).mean() < 0.9
    shadows = draw_shadows(lay_out(SEED), LandPart(-75, -75, 150, 2.0), sky.sun_at(40.0))
    in_the_open = cv2.dilate(shadows, np.ones((5, 5))) == 0
    assert in_the_open.mean() > 0.8
    assert correlation(seen[in_the_open], truth[in_the_open]) > 0.99
