"""The sky over one's own site: a sun to see by wherever it is, and clouds that follow the wind."""

import pytest

from recon.geo import sun_position
from recon.model.geo import LatLon
from recon.score.rehearsal import rehearsal_sky, sun_over
from recon.sim.world import WindSettings


@pytest.mark.parametrize(
    ("latitude_deg", "elevation_deg"),
    [(0.0, 45.0), (41.9, 45.0), (-34.0, 45.0), (67.0, 45.0), (80.0, 33.0), (-90.0, 23.4)],
)
def test_the_sun_is_that_of_a_midsummer_morning(latitude_deg: float, elevation_deg: float) -> None:
    place = LatLon(latitude_deg, 20.0)
    sun = sun_over(place)
    now = sun_position(place, sun.start_utc_s)
    assert now.elevation_deg == pytest.approx(elevation_deg, abs=0.5)
    if abs(latitude_deg) < 90.0:
        assert sun_position(place, sun.start_utc_s + 600.0).elevation_deg > now.elevation_deg


def test_clouds_move_with_the_wind_and_none_is_a_clear_sky() -> None:
    place = LatLon(41.9, -93.6)
    wind = WindSettings(1, speed_10m_mps=4.0, heading_deg=90.0)
    (clouds,) = rehearsal_sky(place, 0.7, wind, 1).settings.layers
    assert (clouds.cover, clouds.speed_mps, clouds.heading_deg) == (0.7, 8.0, 110.0)
    assert rehearsal_sky(place, 0.0, None, 1).settings.layers == ()
