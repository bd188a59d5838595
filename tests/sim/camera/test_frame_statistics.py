"""Statistics of rendered pixels: highlights, shade, lens colour and image circle, as drawn.

Small frames over one land; the conditions differ.
"""

from dataclasses import replace

import numpy as np
import pytest

from recon.camera import ImageCircle, OmnidirectionalCamera
from recon.model.imagery import RgbImage
from recon.sim.camera import CameraSettings, LensSettings, ToneSettings
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import CameraView
from recon.sim.camera.tone import light_at_level
from recon.sim.conditions import ConditionRanges, draw_conditions
from recon.sim.world import LayerSettings, LightSettings, ShadeColour, Sky, SkySettings

ROWS, COLS = 360, 640
IMAGE_CIRCLE_DEG = 66.0
SUN, SHADE = (Sky(SkySettings(layers=(LayerSettings(cover=cover),))) for cover in (0.0, 1.0))
PERFECT = CameraSettings.perfect()
PLAIN = ToneSettings()


@pytest.fixture(scope="module")
def small(camera: OmnidirectionalCamera) -> OmnidirectionalCamera:
    return camera.scaled_to(ROWS, COLS)


@pytest.fixture(scope="module")
def off_axis_deg(small: OmnidirectionalCamera) -> np.ndarray:
    pixels = np.stack(np.meshgrid(np.arange(COLS), np.arange(ROWS)), axis=-1).reshape(-1, 2)
    along = small.unproject(pixels.astype(float))[:, 2]
    return np.degrees(np.arccos(np.clip(along, -1.0, 1.0))).reshape(ROWS, COLS)


@pytest.fixture(scope="module")
def frames(small: OmnidirectionalCamera) -> FieldRenderer:
    radius_px = float(small.profile.radius_px(np.array([np.radians(IMAGE_CIRCLE_DEG)]))[0])
    circle = ImageCircle(small.centre_col_px, small.centre_row_px, radius_px)
    return FieldRenderer(small, circle, 5, SUN, PERFECT)


def light_in(picture: RgbImage, tone: ToneSettings = PLAIN) -> np.ndarray:
    table = np.array([light_at_level(tone, level) for level in range(256)])
    return table[picture]


def test_the_lands_highlights_have_the_drawn_level(frames, pose, off_axis_deg) -> None:
    brightest = []
    for seed in range(6):
        conditions = draw_conditions(ConditionRanges(), seed)
        renderer = replace(frames, imager=conditions.camera, light=conditions.light)
        picture = renderer.render(CameraView(0.0, 0, pose()))
        brightest.append(np.percentile(picture[off_axis_deg < 60.0, 1], 99.0))
    assert min(brightest) > 195.0
    assert max(brightest) < 252.0
    assert np.ptp(brightest) > 5.0


@pytest.mark.parametrize(("green", "blue_over_red"), [(0.36, 2.4), (0.22, 1.4)])
def test_shade_over_sun_is_that_of_the_shade_colour(
    frames, pose, green: float, blue_over_red: float
) -> None:
    tone = ToneSettings(knee=0.7, contrast=0.2)
    shade = ShadeColour(green, blue_over_red)
    lit = replace(frames, light=LightSettings(shade=shade), imager=replace(PERFECT, tone=tone))
    sun, dark = (
        light_in(replace(lit, sky=sky).render(CameraView(0.0, 0, pose(60.0, -60.0, -30.0))), tone)
        for sky in (SUN, SHADE)
    )
    middle = np.s_[130:230, 270:370]
    ratios = np.median((dark[middle] / sun[middle]).reshape(-1, 3), axis=0)
    assert ratios == pytest.approx(shade.ratios, rel=0.06)
    assert ratios[2] / ratios[0] == pytest.approx(blue_over_red, rel=0.06)


def test_the_rim_is_bluer_by_the_lens(frames, pose, off_axis_deg) -> None:
    coloured = replace(
        frames, imager=replace(PERFECT, lens=LensSettings(0.0, rim_blue_over_red=1.5))
    )
    view = CameraView(0.0, 0, pose())
    with_it, without = (light_in(f.render(view)) for f in (coloured, frames))
    gain = with_it / np.maximum(without, 1e-3)
    bluer = gain[:, :, 2] / np.maximum(gain[:, :, 0], 1e-3)
    middle, rim = off_axis_deg < 10.0, (off_axis_deg > 62.0) & (off_axis_deg < 65.0)
    assert np.median(bluer[middle]) == pytest.approx(1.0, abs=0.01)
    assert np.median(bluer[rim]) == pytest.approx(1.5, abs=0.08)


def test_the_lens_lights_the_sensor_up_to_66_degrees(frames, pose, off_axis_deg) -> None:
    picture = frames.render(CameraView(0.0, 0, pose())).max(axis=2)
    assert picture[off_axis_deg > 67.0].max() == 0
    assert np.percentile(picture[off_axis_deg < 65.0], 1.0) > 20


def test_the_tint_multiplies_the_light(frames, pose) -> None:
    view = CameraView(0.0, 0, pose())
    tinted = replace(frames, imager=replace(PERFECT, tint=(1.1, 1.0, 1.4)))
    gains = tinted.gains(view) / frames.gains(view)
    assert gains == pytest.approx((1.1, 1.0, 1.4))
