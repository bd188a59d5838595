"""Footage of the real places: its light, its poses and its truth are those it was made with."""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import cv2
import numpy as np
import pytest
from tests.real_footage.clouds import DrawnClouds
from tests.real_footage.footage import FootageSettings, MadeFrame, footage, ground_images
from tests.real_footage.light import CURVE_POWER, SHADE_OVER_SUN, levels_of, light_of
from tests.real_footage.places import PLACES, Place, load_place

from recon.camera import GroundProjector, decode_frame, decode_jpeg
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame

STILL = FootageSettings(cover=0.0, wobble_deg=0.0, drift_m=0.0, noise=0.0, jpeg_quality=None)
UNSATURATED = 200


@pytest.fixture(scope="module", params=PLACES)
def place(request: pytest.FixtureRequest, fisheye_data: Path) -> Place:
    return load_place(fisheye_data, request.param)


def pixels(made: MadeFrame) -> np.ndarray:
    return decode_frame(made.frame)


@lru_cache(maxsize=4)
def in_sun(place: Place) -> np.ndarray:
    return pixels(next(footage(place, STILL, 1)))


def usable(place: Place, rgb: np.ndarray) -> np.ndarray:
    """Pixels well inside the circle that are not saturated."""
    cols, rows = np.meshgrid(np.arange(rgb.shape[1]), np.arange(rgb.shape[0]))
    circle = place.circle
    off = np.hypot(cols - circle.centre_col_px, rows - circle.centre_row_px)
    return (off < 0.9 * circle.radius_px) & (rgb.max(axis=2) < UNSATURATED)


def test_levels_come_back_from_light() -> None:
    levels = np.arange(256, dtype=np.uint8)
    assert (levels_of(light_of(levels)) == levels).all()
    assert (np.diff(light_of(levels)) > 0.0).all()
    # Near black, a power law: twice the level is so many times the light.
    assert light_of(np.array([39]))[0] / light_of(np.array([19]))[0] == pytest.approx(
        (39.5 / 19.5) ** CURVE_POWER, rel=0.02
    )


def test_the_tone_curve_gives_crop_and_soil_the_same_shade() -> None:
    crop = light_of(np.array([63, 108, 96])) / light_of(np.array([133, 171, 131]))
    soil = light_of(np.array([107, 131, 140])) / light_of(np.array([207, 216, 202]))
    assert crop == pytest.approx(SHADE_OVER_SUN, rel=0.06)
    assert soil == pytest.approx(SHADE_OVER_SUN, rel=0.16)


@pytest.mark.parametrize("cover", [0.2, 0.5, 0.8])
def test_clouds_cover_what_they_are_asked_to_and_move_with_the_wind(cover: float) -> None:
    clouds = DrawnClouds(3, cover, (6.0, -3.0))
    frame = LocalFrame(GeoPoint(44.0, -93.0, 300.0))
    grid = GroundGrid(frame, 0.0, 6144.0, 12.0, 512, 512)
    found = clouds.on_grid(grid, 0.0)
    assert float((found < 0.5).mean()) == pytest.approx(cover, abs=0.03)
    moved = replace(grid, west_m=grid.west_m + 60.0, north_m=grid.north_m - 30.0)
    assert clouds.on_grid(moved, 10.0) == pytest.approx(found, abs=1e-3)


def test_without_clouds_the_frame_is_the_real_one(place: Place, fisheye_data: Path) -> None:
    real = decode_jpeg((fisheye_data / place.name / "RefFrame.jpeg").read_bytes())
    made = in_sun(place)
    small = cv2.resize(real, made.shape[1::-1], interpolation=cv2.INTER_AREA)
    differs = np.abs(made.astype(int) - small)[usable(place, made)]
    assert differs.mean() < 3.0


def test_deep_shade_has_the_measured_ratios(place: Place) -> None:
    sunlit = in_sun(place)
    shaded = pixels(next(footage(place, replace(STILL, cover=1.0, seed=1), 1)))
    ratio = np.median(
        (light_of(shaded) / light_of(sunlit))[usable(place, sunlit) & (sunlit.min(axis=2) > 60)],
        axis=0,
    )
    assert ratio == pytest.approx(SHADE_OVER_SUN, rel=0.08)


def test_the_drawn_shade_lies_where_the_truth_says(place: Place) -> None:
    """Judged by the light of the same frame without clouds: a reference that no method has."""
    grid = place.grid(cell_m=4.0, side_m=320.0)
    settings = replace(STILL, seed=2, cover=0.4, wobble_deg=0.5, drift_m=2.0)
    clear = GroundProjector(grid, place.camera, place.circle)
    reference, valid = clear.project_pixels(in_sun(place), place.marked_pose)
    known = valid & (reference.max(axis=2) < UNSATURATED)
    for image, made in ground_images(place, footage(place, settings, 2), grid, is_pose_true=True):
        green = light_of(image.rgb)[..., 1] / light_of(reference)[..., 1]
        is_shade = (green - SHADE_OVER_SUN[1]) / (1.0 - SHADE_OVER_SUN[1]) < 0.5
        truth = made.transmittance(grid) < 0.5
        both = (is_shade & truth & known).sum()
        assert both / ((is_shade | truth) & known).sum() > 0.85


def test_a_wobbling_frame_fits_the_ground_by_its_true_pose_only(place: Place) -> None:
    grid = place.grid(cell_m=1.0, side_m=256.0)
    projector = GroundProjector(grid, place.camera, place.circle)
    reference, _ = projector.project_pixels(in_sun(place), place.marked_pose)
    moved = replace(STILL, seed=5, wobble_deg=1.5, drift_m=4.0)
    differ = [
        [
            float(np.abs(image.rgb.astype(int) - reference).mean())
            for image, _ in ground_images(place, footage(place, moved, 4), grid, is_pose_true=true)
        ]
        for true in (True, False)
    ]
    assert np.mean(differ[0]) < 0.5 * np.mean(differ[1])


def test_auto_exposure_keeps_the_metered_light(place: Place) -> None:
    settings = replace(STILL, cover=1.0, exposure_follows=1.0)
    made = next(footage(place, settings, 1))
    # Full shade leaves 0.36 of the green light; the gain undoes it.
    assert made.gains[1] == pytest.approx(1.0 / SHADE_OVER_SUN[1], rel=0.08)


def test_the_same_seed_makes_the_same_bytes(fisheye_data: Path) -> None:
    place = load_place(fisheye_data, PLACES[0], cols=320)
    first, again = (
        [made.frame.jpeg for made in footage(place, FootageSettings(seed=4), 3)] for _ in range(2)
    )
    assert first == again
    other = [made.frame.jpeg for made in footage(place, FootageSettings(seed=6), 3)]
    assert other != first


def test_ground_images_carry_what_a_station_knows(place: Place) -> None:
    grid = place.grid(cell_m=4.0)
    for follows in (0.0, 0.7):
        settings = FootageSettings(exposure_follows=follows)
        image, _ = next(ground_images(place, footage(place, settings, 1), grid))
        assert image.exposure_locked == (follows == 0.0)
        if image.toward_sun_enu is not None:
            # In July at these places the sun is never higher than 70 degrees.
            assert np.linalg.norm(image.toward_sun_enu) == pytest.approx(1.0, abs=1e-3)
            assert 25.0 < np.degrees(np.arcsin(image.toward_sun_enu[2])) < 70.0
