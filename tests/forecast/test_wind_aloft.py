"""The wind of a weather forecast: which level moves the clouds, and what it adds at the start."""

import numpy as np
import pytest
from tests.detection.shaded_field import FIELD, DriftingShade
from tests.forecast.moving_shade import SEEN, drawn_velocity, forecasts, shade_map

from recon.forecast import ForecastSettings
from recon.forecast.wind_aloft import wind_at_clouds
from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.model.weather import HourWeather, WindAloft

LEADS_S = (0.0, 15.0, 30.0, 60.0)
LEVELS = tuple(
    WindAloft(hpa, float(hpa), 0.0, height_m)
    for hpa, height_m in ((1000, 110.0), (850, 1_500.0), (700, 3_000.0), (500, None), (300, None))
)


@pytest.mark.parametrize(
    ("low", "mid", "ground_m", "hpa"),
    [(0.5, 0.2, 0.0, 850), (None, None, 300.0, 850), (0.5, 0.1, 1_600.0, 700), (0.1, 0.6, 0, 500)],
)
def test_the_level_nearest_to_the_clouds_that_cover_most(low, mid, ground_m, hpa) -> None:
    hour = HourWeather(0.0, 0.5, low, mid, 0.9, 5.0, LEVELS)
    wind = wind_at_clouds(hour, ground_m)
    assert wind is not None
    assert wind.pressure_hpa == hpa


def test_no_level_near_the_clouds_is_no_wind() -> None:
    assert wind_at_clouds(HourWeather(0.0, 0.5), 0.0) is None
    assert wind_at_clouds(HourWeather(0.0, 0.5, aloft=LEVELS[-1:]), 0.0) is None


def brier(seed: int, wind_mps: tuple[float, float] | None) -> float:
    """Mean over leads of the Brier score of a first map's forecast, which shows no motion yet."""
    shade = DriftingShade(seed, cover=0.4, velocity_mps=drawn_velocity(seed, 3.0, 8.0))
    settings = ForecastSettings(lead_s=LEADS_S, wind_aloft_mps=wind_mps)
    (only,) = forecasts("advection", [shade_map(shade.transmittance(FIELD, 0.0), 0.0)], settings)
    assert only.velocity_mps is None
    assert (only.horizon_s[SEEN] == 0.0).all()
    wrong = [
        (only.sun_probability[n] / 255.0 - (shade.transmittance(FIELD, s) >= SUNLIT_TRANSMITTANCE))
        for n, s in enumerate(LEADS_S)
    ]
    return float(np.mean([np.square(each[SEEN]).mean() for each in wrong]))


def test_before_maps_show_the_motion_an_inexact_wind_is_better_than_none() -> None:
    seeds = range(920, 928)
    without = np.array([brier(seed, None) for seed in seeds])
    rng = np.random.default_rng(7)
    with_wind = []
    for seed in seeds:
        east, north = np.add(drawn_velocity(seed, 3.0, 8.0), rng.normal(0.0, 1.5, 2)).tolist()
        with_wind.append(brier(seed, (east, north)))
    assert np.mean(with_wind) < 0.9 * without.mean()


def test_maps_that_show_the_motion_leave_the_wind_aside() -> None:
    shade = DriftingShade(931, cover=0.4, velocity_mps=(5.0, -3.0))
    maps = [shade_map(shade.transmittance(FIELD, s), s) for s in np.arange(0.0, 60.0, 5.0)]
    plain = forecasts("advection", maps, ForecastSettings(lead_s=LEADS_S))[-1]
    wrong = ForecastSettings(lead_s=LEADS_S, wind_aloft_mps=(-20.0, 20.0))
    windy = forecasts("advection", maps, wrong)[-1]
    assert windy.velocity_mps == plain.velocity_mps is not None
    np.testing.assert_array_equal(windy.sun_probability, plain.sun_probability)
