"""The sun against pvlib's, and the light of a clear sky against pvlib's models."""

import numpy as np
import pandas as pd
import pvlib
import pytest

from recon.model.geo import LatLon
from recon.sim.errors import SimulationError
from recon.sim.world.light import clear_sky_light
from recon.sim.world.settings import LightSettings
from recon.sim.world.sun import SunPosition, refraction_deg, sun_position

PLACES = [(45.0, -93.0), (-33.0, 18.0), (66.0, 25.0), (0.0, 0.0), (20.0, 179.9)]


@pytest.mark.parametrize(("latitude_deg", "longitude_deg"), PLACES)
def test_the_suns_position_agrees_with_pvlib(latitude_deg: float, longitude_deg: float) -> None:
    times = pd.date_range("2024-01-01", "2030-01-01", freq="61h17min", tz="UTC")
    truth = pvlib.solarposition.spa_python(times, latitude_deg, longitude_deg, altitude=0)
    found = [sun_position(LatLon(latitude_deg, longitude_deg), t.timestamp()) for t in times]
    elevation = np.array([sun.elevation_deg for sun in found])
    azimuth = np.array([sun.azimuth_deg for sun in found])
    is_up = truth.apparent_elevation.to_numpy() > 3.0
    aside = (azimuth - truth.azimuth.to_numpy() + 180.0) % 360.0 - 180.0
    assert is_up.sum() > 300
    assert np.abs(elevation - truth.apparent_elevation.to_numpy())[is_up].max() < 0.02
    # Azimuths converge overhead: what counts is the angle on the sphere.
    assert np.abs(aside * np.cos(np.radians(elevation)))[is_up].max() < 0.02


def test_the_sun_is_farthest_in_july() -> None:
    times = pd.to_datetime(["2025-01-04T13:00Z", "2025-07-03T20:00Z"])
    truth = pvlib.solarposition.nrel_earthsun_distance(times).to_numpy()
    found = [sun_position(LatLon(0.0, 0.0), t.timestamp()).distance_au for t in times]
    assert found == pytest.approx(truth, abs=2e-4)


def test_refraction_is_a_sun_diameter_at_the_horizon_and_0_at_the_zenith() -> None:
    assert 0.45 < refraction_deg(0.0) < 0.6
    assert refraction_deg(90.0) == pytest.approx(0.0, abs=1e-4)
    assert refraction_deg(-20.0) == 0.0


@pytest.mark.parametrize(
    ("place", "utc_s"), [(LatLon(91.0, 0.0), 0.0), (LatLon(0.0, 0.0), float("nan"))]
)
def test_an_invalid_place_or_time_is_refused(place: LatLon, utc_s: float) -> None:
    with pytest.raises(SimulationError, match="expected a place on the globe and a time"):
        sun_position(place, utc_s)


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
