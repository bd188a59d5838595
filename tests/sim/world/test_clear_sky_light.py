"""The light of a clear sky against pvlib's models."""

import pvlib
import pytest

from recon.geo.sun import SunPosition
from recon.sim.world.light import clear_sky_light
from recon.sim.world.settings import LightSettings


@pytest.mark.parametrize("elevation_deg", [20.0, 30.0, 45.0, 60.0, 80.0])
def test_clear_light_lies_near_pvlibs_models(elevation_deg: float) -> None:
    light = clear_sky_light(SunPosition(180.0, elevation_deg, 1.0), LightSettings(3.5, 0.0))
    mass = pvlib.atmosphere.get_relative_airmass(90.0 - elevation_deg)
    truth = pvlib.clearsky.ineichen(90.0 - elevation_deg, mass, 3.5, altitude=0, dni_extra=1361)
    assert light.global_w_m2 == pytest.approx(truth["ghi"], rel=0.08)
    assert light.diffuse_w_m2 == pytest.approx(truth["dhi"], abs=15.0)


def test_haze_turns_direct_light_into_diffuse() -> None:
    sun = SunPosition(180.0, 45.0, 1.0)
    clear, hazy = (clear_sky_light(sun, LightSettings(t)) for t in (2.0, 6.0))
    assert hazy.direct_w_m2 < 0.7 * clear.direct_w_m2
    assert hazy.diffuse_w_m2 > 1.5 * clear.diffuse_w_m2
    assert hazy.global_w_m2 < clear.global_w_m2


def test_there_is_no_light_by_night_and_little_before() -> None:
    night = clear_sky_light(SunPosition(0.0, -5.0, 1.0), LightSettings())
    assert (night.global_w_m2, night.diffuse_share) == (0.0, 1.0)
    low = clear_sky_light(SunPosition(0.0, 1.0, 1.0), LightSettings())
    assert 0.0 < low.global_w_m2 < 40.0
    assert low.diffuse_share > 0.5
