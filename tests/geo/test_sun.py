"""The sun's position against pvlib's."""

import numpy as np
import pandas as pd
import pvlib
import pytest

from recon.geo.sun import SunPosition, refraction_deg, sun_position, utc_at_elevation
from recon.model.geo import LatLon

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
    with pytest.raises(ValueError, match="expected a place on the globe and a time"):
        sun_position(place, utc_s)


@pytest.mark.parametrize(
    ("azimuth_deg", "elevation_deg", "toward_enu"),
    [(0.0, 0.0, (0, 1, 0)), (90.0, 0.0, (1, 0, 0)), (270.0, 45.0, (-(0.5**0.5), 0, 0.5**0.5))],
)
def test_the_direction_to_the_sun_is_east_north_up(
    azimuth_deg: float, elevation_deg: float, toward_enu: tuple[float, float, float]
) -> None:
    found = SunPosition(azimuth_deg, elevation_deg, 1.0).toward_enu
    np.testing.assert_allclose(found, toward_enu, atol=1e-12)


@pytest.mark.parametrize("place", [LatLon(41.9, -93.6), LatLon(-33.0, 18.0), LatLon(20.0, 179.9)])
@pytest.mark.parametrize("elevation_deg", [5.0, 25.0])
@pytest.mark.parametrize("is_rising", [True, False])
def test_the_time_of_an_elevation(place: LatLon, elevation_deg: float, is_rising: bool) -> None:
    near_utc_s = pd.Timestamp("2025-06-20T16:00Z").timestamp()
    at_s = utc_at_elevation(place, near_utc_s, elevation_deg, is_rising=is_rising)
    sun = sun_position(place, at_s)
    assert sun.elevation_deg == pytest.approx(elevation_deg, abs=1e-4)
    assert (sun.azimuth_deg < 180.0) is is_rising
    assert abs(at_s - near_utc_s) < 24 * 3600.0


def test_an_elevation_that_the_sun_does_not_reach_is_refused() -> None:
    near_utc_s = pd.Timestamp("2025-12-21T18:00Z").timestamp()
    with pytest.raises(ValueError, match=r"to 24\.\d degrees, as the sun has on that day, got 60"):
        utc_at_elevation(LatLon(41.9, -93.6), near_utc_s, 60.0, is_rising=True)
