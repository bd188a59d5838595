"""Whole pictures: their light is the light model's, and they are functions of their view."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from recon.geo.sun import SunPosition
from recon.model.imagery import RgbImage
from recon.sim.camera import CameraSettings, HoverSettings, ImageSensorSettings, LensSettings
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import CameraView
from recon.sim.camera.tone import light_of_value
from recon.sim.errors import SimulationError
from recon.sim.land import land_tiles as tiles_module
from recon.sim.land.farmland import lay_out
from recon.sim.land.farmland_raster import draw, draw_shadows
from recon.sim.land.land_part import LandPart
from recon.sim.land.land_tiles import TILES_KEPT, LandTiles, land_of
from recon.sim.world import LayerSettings, Sky, SkySettings
from recon.sim.world.light import light_under
from recon.sim.world.relief import Relief, ReliefSettings

PERFECT = CameraSettings.perfect()
CLEAR = Sky(SkySettings(layers=()))
OVERCAST = Sky(SkySettings(layers=(LayerSettings(cover=1.0),)))
BROKEN = Sky(SkySettings(5, layers=(LayerSettings(cover=0.4, outer_scale_m=800.0),)))
MIDDLE = np.s_[261:461, 538:738]


@pytest.fixture(scope="module")
def frames(camera, circle) -> FieldRenderer:
    return FieldRenderer(camera, circle, 5, CLEAR, PERFECT)


def light_in(picture: RgbImage) -> np.ndarray:
    return light_of_value()[picture].astype(float)


def in_the_open(east_m: float, north_m: float) -> bool:
    """Return whether no tree or roof shades the middle of a picture from 60 m."""
    part = LandPart(round(-north_m) - 40, round(east_m) - 40, 80, 1.0)
    return not draw_shadows(lay_out(5), part, CLEAR.sun_at(0.0)).any()


def test_shade_over_sun_is_the_light_models_in_each_colour(frames, pose) -> None:
    where = next((e, -30.0) for e in range(-200, 200, 20) if in_the_open(e, -30.0))
    view = CameraView(0.0, 0, pose(60.0, *where))
    pictures = (replace(frames, sky=sky).render(view) for sky in (OVERCAST, CLEAR))
    shade, sun = (light_in(picture[MIDDLE]).mean(axis=(0, 1)) for picture in pictures)
    covered, clear = light_under(OVERCAST, 0.0), light_under(CLEAR, 0.0)
    expected = covered.at(OVERCAST.transmittance(0.0, 0.0, 0.0)) / (clear.sky + clear.beam)
    assert shade / sun == pytest.approx(expected, rel=0.01)
    assert expected[2] > 1.1 * expected[0]


@pytest.mark.flight
def test_frames_do_not_depend_on_what_was_rendered_before(camera, circle, pose) -> None:
    def fresh() -> FieldRenderer:
        return FieldRenderer(camera, circle, 5, BROKEN, relief=Relief(ReliefSettings(1)))

    views = [CameraView(4.0 * n, n, pose(120.0, 90.0 * n, -60.0 * n)) for n in range(2)]
    tiles_module.land_of.cache_clear()
    forwards = [fresh().render(view) for view in views]
    tiles_module.land_of.cache_clear()
    shared = fresh()
    backwards = [shared.render(view) for view in reversed(views)][::-1]
    with ThreadPoolExecutor(3) as pool:
        at_once = list(pool.map(shared.render, views))
    for one, other, third in zip(forwards, backwards, at_once, strict=True):
        assert np.array_equal(one, other)
        assert np.array_equal(one, third)


def test_noise_differs_between_frames_of_the_same_time(frames, pose) -> None:
    noisy = replace(frames, imager=replace(PERFECT, sensor=ImageSensorSettings(full_well=500.0)))
    one, two = (noisy.render(CameraView(3.0, n, pose())).astype(int) for n in (1, 2))
    assert (one != two)[MIDDLE].mean() > 0.5
    outside = np.s_[:, :280]
    assert not one[outside].any()


def test_the_rim_is_darker_by_the_falloff(frames, pose) -> None:
    falling = replace(frames, imager=replace(PERFECT, lens=LensSettings(rim_falloff=0.5)))
    view = CameraView(0.0, 0, pose())
    with_it, without = (light_in(f.render(view)) for f in (falling, frames))
    row, col = np.mgrid[:720, :1280]
    share = np.hypot(col - 637.8, row - 361.2) / 340.0
    for inner, outer in ((0.0, 0.1), (0.45, 0.55), (0.85, 0.95)):
        ring = (share >= inner) & (share < outer)
        expected = 1.0 - 0.5 * np.mean(share[ring] ** 4)
        assert with_it[ring].sum() / without[ring].sum() == pytest.approx(expected, rel=0.02)


def test_the_hot_spot_lies_against_the_sun(frames, camera, pose) -> None:
    bright = replace(frames, imager=replace(PERFECT, hot_spot=0.8, hot_spot_deg=5.0))
    there = pose(200.0, yaw_deg=30.0)
    view = CameraView(0.0, 0, there)
    ratio = light_in(bright.render(view)) / np.maximum(light_in(frames.render(view)), 1e-3)
    against = -light_under(CLEAR, 0.0).toward_sun @ there.rotation_enu_camera
    col, row = np.rint(camera.project(against)[0]).astype(int)
    around = np.s_[row - 3 : row + 4, col - 3 : col + 4]
    assert 1.3 < np.median(ratio[around]) < 1.8
    assert np.median(ratio[MIDDLE]) < 1.15


def test_haze_lowers_contrast_with_distance(frames, pose) -> None:
    hazy = replace(frames, imager=replace(PERFECT, haze_m=2_000.0))
    view = CameraView(0.0, 0, pose(300.0))
    with_it, without = (light_in(f.render(view)) for f in (hazy, frames))
    row, col = np.mgrid[:720, :1280]
    share = np.hypot(col - 637.8, row - 361.2) / 340.0
    near, far = share < 0.2, (share > 0.85) & (share < 0.9)
    lost = [with_it[ring].std() / without[ring].std() for ring in (near, far)]
    assert lost[0] == pytest.approx(np.exp(-300.0 / 2_000.0), abs=0.06)
    assert lost[1] < 0.8 * lost[0]


def test_tiles_lie_side_by_side_as_one_drawing() -> None:
    land = lay_out(5)
    one = draw(land, LandPart(-256, -256, 512, 0.5), 5).astype(int)
    parts = [
        np.hstack([draw(land, LandPart(row, col, 256, 0.5), 5) for col in (-256, 0)])
        for row in (-256, 0)
    ]
    four = np.vstack(parts).astype(int)
    # Where OpenCV cuts a bank or a crown at a tile's edge, its outline may move by a pixel.
    assert (np.abs(one - four).max(axis=2) > 2).mean() < 2e-4


def test_the_number_of_tiles_kept_is_bounded() -> None:
    tiles = LandTiles(lay_out(5), 5)
    sun = SunPosition(140.0, 50.0, 1.0)
    first = tiles.square(0, 0.0, 0.0, sun).pixels.copy()
    for step in range(10):
        tiles.square(0, 300.0 * step, 0.0, sun)
    assert len(tiles._colours) <= TILES_KEPT
    assert len(tiles._shadows) <= TILES_KEPT
    assert np.array_equal(tiles.square(0, 0.0, 0.0, sun).pixels, first)


@pytest.mark.parametrize(("azimuth_deg", "elevation_deg"), [(90.0, 45.0), (200.0, 25.0)])
def test_shadows_fall_away_from_the_sun(azimuth_deg: float, elevation_deg: float) -> None:
    land = lay_out(5)
    barn = land.buildings[0]
    sun = SunPosition(azimuth_deg, elevation_deg, 1.0)
    reach_m = barn.height_m / np.tan(np.radians(elevation_deg))
    away = np.array([-np.sin(np.radians(azimuth_deg)), -np.cos(np.radians(azimuth_deg))])
    middle_m = (barn.south_m + barn.north_m) / 2.0
    corner = np.array(
        [
            barn.west_m if away[0] < 0.0 else barn.east_m,
            barn.north_m if away[1] > 0.1 else middle_m,
        ]
    )
    for share, is_shaded in ((0.4, True), (1.6, False), (-1.0, False)):
        east, north = corner + share * reach_m * away
        part = LandPart(round(-north / 0.25) - 2, round(east / 0.25) - 2, 4, 0.25)
        shadow = draw_shadows(land, part, sun)
        assert (shadow.mean() > 200) == is_shaded


def test_the_land_has_all_kinds_of_objects() -> None:
    land = land_of(5).land
    assert min(len(land.plots), len(land.trees)) > 1_000
    assert min(len(land.tracks), len(land.buildings), len(land.ponds)) > 20
    assert any(plot.bareness == 1.0 for plot in land.plots)


@pytest.mark.parametrize("seed", range(12))
def test_no_creek_and_no_tree_stand_in_the_farm_near_the_origin(seed: int) -> None:
    land = lay_out(seed)
    west, south, east, north = land.yards[0]
    creek_east = np.arange(west, east, 1.0)
    creek_north = np.interp(creek_east, land.creek_m[:, 0], land.creek_m[:, 1])
    assert ((creek_north < south - 15.0) | (creek_north > north + 15.0)).all()
    assert not [t for t in land.trees if west < t.east_m < east and south < t.north_m < north]


def test_wet_soil_is_darker_than_dry() -> None:
    land = lay_out(5)
    bare = [p for p in land.plots if p.bareness == 1.0 and max(map(abs, p.box_m)) < 4_000.0]
    spans = []
    for plot in bare[:40]:
        west, south, east, north = (round(edge / 4.0) for edge in plot.box_m)
        size = min(east - west, north - south) - 6
        pixels = draw(land, LandPart(-north + 3, west + 3, size, 4.0), 5)
        spans.append(np.percentile(pixels.mean(axis=2), (2, 98)))
    dark, light = np.array(spans).T
    assert dark.min() < 0.75 * np.median(light)


@pytest.mark.parametrize(
    "make",
    [
        lambda: CameraSettings(haze_m=0.0),
        lambda: CameraSettings(seed=-1),
        lambda: HoverSettings(drift_m=float("nan")),
        lambda: LensSettings(rim_falloff=1.0),
        lambda: ImageSensorSettings(full_well=0.0),
    ],
)
def test_invalid_settings_are_refused(make) -> None:
    with pytest.raises(SimulationError, match="expected"):
        make()
