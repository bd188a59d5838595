"""Photos to order: what their files state, right or wrong, and where their pixels truly lie."""

from dataclasses import replace
from math import radians
from pathlib import Path

import cv2
import numpy as np
import pytest

from recon.geo import enu_from_geo
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.units import NS_PER_S
from recon.product.footprint import Aim, PhotoView, projected
from recon.product.photos.photo import GimbalAttitude, Photo, read_photo_facts
from recon.sim.camera.field import FieldRenderer
from recon.sim.land.land_tiles import land_of
from recon.sim.photos.cameras import CAMERAS, CameraName, pinhole
from recon.sim.photos.card import GIMBAL, CardSettings, PhotoCard, PhotoFile, PhotoShot
from recon.sim.world import LayerSettings, Sky, SkySettings

FRAME = LocalFrame(GeoPoint(41.9, -93.6, 290.0))
SEED = 5
NOON_NS = 1_750_435_200_700_000_000
"""2025-06-20 16:00:00.7 UTC."""
CAMERA = CAMERAS[CameraName.MAVIC_3E]
WORLD = FieldRenderer(pinhole(60.0, 32, 24), seed=SEED)


def shot(east_m: float = -40.0, north_m: float = 25.0, yaw_deg: float = 30.0) -> PhotoShot:
    place_m = np.array([east_m, north_m, 62.0])
    return PhotoShot("SIM-1_0001.JPG", "SIM-1", 100.0, NOON_NS, place_m, 60.0, yaw_deg)


def taken(
    settings: CardSettings, *shots: PhotoShot, world: FieldRenderer = WORLD
) -> list[PhotoFile]:
    return list(PhotoCard(FRAME, world, settings).photos(shots or [shot()]))


def read_back(folder: Path, settings: CardSettings, photo: PhotoShot) -> Photo:
    path = folder / photo.name
    path.write_bytes(taken(settings, photo)[0].jpeg)
    return read_photo_facts(path, path.name)


SMALL = CardSettings(cols=400, gnss_m=0.0)


def test_a_photo_states_camera_place_heights_and_attitude_as_our_reader_finds_them(
    tmp_path,
) -> None:
    found = read_back(tmp_path, SMALL, shot())
    assert found.camera == ("DJI", "M3E", "CAM-SIM-1")
    assert (found.cols, found.rows) == (400, 300)
    assert found.across_deg == pytest.approx(CAMERA.across_deg, abs=1e-3)
    assert found.attitude == GimbalAttitude(30.0, -90.0, 0.0)
    assert found.flight_yaw_deg == 30.0
    assert found.height_above_takeoff_m == pytest.approx(60.0)
    assert found.absolute_height_m == pytest.approx(352.0, abs=0.01)
    place = enu_from_geo(FRAME, [found.latitude_deg], [found.longitude_deg], 352.0)[0]
    assert place[:2] == pytest.approx([-40.0, 25.0], abs=0.01)


def test_the_clock_shows_whole_seconds_of_a_wrong_clock(tmp_path) -> None:
    ahead = replace(SMALL, clock_ahead_s=3600.5)
    found = read_back(tmp_path, ahead, shot())
    assert found.clock_ns == (NOON_NS // NS_PER_S + 3601) * NS_PER_S
    assert found.clock_step_s == 1.0


def test_the_stated_gimbal_can_be_turned_the_other_way_round_or_missing(tmp_path) -> None:
    off = replace(SMALL, gimbal_yaw_off_deg=53.0)
    assert read_back(tmp_path, off, shot()).attitude == GimbalAttitude(83.0, -90.0, 0.0)
    rolled = replace(SMALL, is_roll_180=True)
    assert read_back(tmp_path, rolled, shot()).attitude == GimbalAttitude(-150.0, -90.0, 180.0)
    bare = replace(SMALL, states_gimbal=False)
    assert read_back(tmp_path, bare, shot()).attitude is None


def test_positions_are_off_by_as_much_as_is_asked(tmp_path) -> None:
    shots = [replace(shot(), serial=f"SIM-{number}") for number in range(100)]
    errors = []
    for photo in taken(CardSettings(cols=16, gnss_m=2.0), *shots):
        path = tmp_path / "photo.jpg"
        path.write_bytes(photo.jpeg)
        found = read_photo_facts(path, path.name)
        place = enu_from_geo(FRAME, [found.latitude_deg], [found.longitude_deg], 352.0)[0]
        errors.append(place[:2] - photo.shot.place_m[:2])
    assert np.std(errors) == pytest.approx(2.0, rel=0.3)


def test_only_a_camera_with_rtk_states_how_sure_its_position_is(tmp_path) -> None:
    rtk = CardSettings(camera=CAMERAS[CameraName.PHANTOM_4_RTK], cols=400)
    found = read_back(tmp_path, rtk, shot())
    assert found.horizontal_sigma_m == pytest.approx(0.015)
    assert found.height_reference == "ellipsoid"
    assert read_back(tmp_path, SMALL, shot()).horizontal_sigma_m is None


@pytest.mark.parametrize("yaw_deg", [0.0, 30.0, -140.0])
def test_a_photo_shows_the_ground_where_its_true_pose_says(yaw_deg) -> None:
    photo = taken(CardSettings(cols=450), shot(yaw_deg=yaw_deg))[0]
    grey = cv2.imdecode(np.frombuffer(photo.jpeg, np.uint8), cv2.IMREAD_GRAYSCALE)
    # Level ground, and the product's own geometry: a gimbal error of 0.1 degrees is 0.1 m.
    view = PhotoView(Aim(-40.0, 25.0, 62.0, yaw_deg), CAMERA.across_deg, 450, grey.shape[0])
    land = land_of(SEED).square(0, -40.0, 25.0, WORLD.sky.sun_at(100.0))
    shown = cv2.cvtColor(land.pixels[..., :3], cv2.COLOR_RGB2GRAY)
    cols, rows = np.meshgrid(np.arange(450.0), np.arange(float(grey.shape[0])))
    east, north = projected(view.homography, np.stack([cols.ravel(), rows.ravel()], axis=1)).T
    at = np.stack([(east - land.west_m) / land.cell_m, (land.north_m - north) / land.cell_m])
    at = (at - 0.5).reshape(2, *grey.shape).astype(np.float32)
    wanted = cv2.remap(shown, at[0], at[1], cv2.INTER_LINEAR)
    (right, down), _ = cv2.phaseCorrelate(
        cv2.GaussianBlur(wanted, (0, 0), 1.0).astype(np.float64),
        cv2.GaussianBlur(grey, (0, 0), 1.0).astype(np.float64),
    )
    pixel_m = 62.0 * 2.0 * np.tan(radians(CAMERA.across_deg) / 2.0) / 450
    assert np.hypot(right, down) * pixel_m < 62.0 * radians(4.0 * GIMBAL.mount_error_deg)


def test_neighbouring_photos_show_the_same_detail_at_the_same_place() -> None:
    one, other = taken(CardSettings(cols=900), shot(), shot(east_m=-30.0))
    greys = [
        cv2.imdecode(np.frombuffer(each.jpeg, np.uint8), cv2.IMREAD_GRAYSCALE)
        for each in (one, other)
    ]
    sift = cv2.SIFT_create(500)
    found = [sift.detectAndCompute(grey, None) for grey in greys]
    pairs = cv2.BFMatcher().knnMatch(found[0][1], found[1][1], k=2)
    good = [a for a, b in pairs if a.distance < 0.75 * b.distance]
    assert len(good) > 40
    points = [np.array([found[k][0][(m.queryIdx, m.trainIdx)[k]].pt for m in good]) for k in (0, 1)]
    homography, inliers = cv2.findHomography(points[0], points[1], cv2.RANSAC, 2.0)
    assert inliers.mean() > 0.8
    moved = np.hypot(*homography[:2, 2])
    pixel_m = 62.0 * 2.0 * np.tan(radians(CAMERA.across_deg) / 2.0) / 900
    assert moved * pixel_m == pytest.approx(10.0, abs=0.5)


def test_the_same_shots_give_the_same_bytes() -> None:
    settings = CardSettings(cols=400)
    assert [p.jpeg for p in taken(settings)] == [p.jpeg for p in taken(settings)]


def test_the_sunlit_share_is_that_of_the_sky() -> None:
    overcast = Sky(SkySettings(layers=(LayerSettings(cover=1.0),)))
    assert taken(SMALL)[0].sunlit == 1.0
    assert taken(SMALL, world=replace(WORLD, sky=overcast))[0].sunlit == 0.0
