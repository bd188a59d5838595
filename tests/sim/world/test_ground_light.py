"""Light by colour agrees with the light without, and shade is bluer."""

from dataclasses import replace

import numpy as np
import pytest

from recon.geo.sun import SunPosition
from recon.sim.world import LayerSettings, LightSettings, Sky, SkySettings
from recon.sim.world.light import (
    REFERENCE_W_M2,
    beam_share,
    clear_sky_light,
    ground_light,
    light_under,
    metered_light,
)
from recon.sim.world.relief import Relief, ReliefSettings

SETTINGS = LightSettings()


def sun(elevation_deg: float, azimuth_deg: float = 140.0) -> SunPosition:
    return SunPosition(azimuth_deg, elevation_deg, 1.0)


@pytest.mark.parametrize("elevation_deg", [8.0, 25.0, 55.0, 70.0])
@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_the_mean_of_the_colours_is_the_clear_sky_index(elevation_deg: float, share: float) -> None:
    light, clear = (f(sun(elevation_deg), SETTINGS) for f in (ground_light, clear_sky_light))
    index = clear.index(np.array(share, np.float32), SETTINGS.cloud_brightening)
    strength = clear.global_w_m2 / REFERENCE_W_M2
    assert light.at(np.array(share)).mean() == pytest.approx(strength * index, rel=1e-4)


def test_clear_sky_sun_is_white_and_shade_blue() -> None:
    light = ground_light(sun(50.0), replace(SETTINGS, cloud_brightening=1.0))
    in_sun, in_shade = light.beam + light.sky, light.sky
    assert np.ptp(in_sun) < 1e-9
    assert in_shade[0] < in_shade[1] < in_shade[2]
    assert in_shade[2] / in_shade[0] == pytest.approx(1.33 / 0.72)


def test_no_light_from_a_sun_below_the_horizon() -> None:
    light = ground_light(sun(-3.0), SETTINGS)
    assert not light.beam.any()
    assert not light.sky.any()


def test_light_wanes_slowly_with_the_sun() -> None:
    sky = Sky(SkySettings(layers=()))
    levels = [metered_light(sky, [0.0], [0.0], 60.0 * minute) for minute in range(480)]
    steps = np.abs(np.diff(levels))
    assert np.ptp(levels) > 0.3
    assert steps.max() < 0.004


def test_without_clouds_nothing_brightens_the_sky() -> None:
    cloudy, clear = (
        light_under(Sky(SkySettings(layers=layers)), 0.0) for layers in ((LayerSettings(),), ())
    )
    assert (cloudy.sky > 1.2 * clear.sky).all()
    assert np.array_equal(cloudy.beam, clear.beam)


def test_slopes_towards_the_sun_have_more_of_its_beam() -> None:
    sky, relief = Sky(SkySettings(layers=())), Relief(ReliefSettings(4, height_m=10.0))
    light = light_under(sky, 0.0)
    east, north = np.meshgrid(np.linspace(-2e3, 2e3, 80), np.linspace(-2e3, 2e3, 80))
    share = beam_share(sky, light, relief, east, north, 0.0)
    rises = relief.slope(east, north)
    normals = np.stack([-rises[0], -rises[1], np.ones_like(rises[0])], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    assert share == pytest.approx(normals @ light.toward_sun / light.toward_sun[2], abs=1e-4)
    assert share.mean() == pytest.approx(1.0, abs=0.01)
