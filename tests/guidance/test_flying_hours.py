"""When a survey fits: by a sun that is computed otherwise, and weather that is made up."""

import numpy as np
import pandas as pd
import pvlib
import pytest

from recon.guidance.flying_hours import Fit, FlyingLimits, corner_deg, flying_spans
from recon.model.geo import LatLon
from recon.model.weather import HourWeather, Weather

PLACE = LatLon(41.9, -93.6)
DAY_S = pd.Timestamp("2026-06-21T05:00Z").timestamp()
"""Midnight there."""
LIMITS = FlyingLimits(corner_deg=corner_deg(70.3, 55.7))


def spans(weather: Weather | None = None, limits: FlyingLimits = LIMITS):
    return flying_spans(PLACE, DAY_S, DAY_S + 86_400.0, limits, weather)


def test_the_spans_are_those_of_the_suns_elevation() -> None:
    found = spans()
    assert [span.fit for span in found] == [
        *(Fit.LOW_SUN, Fit.FITS, Fit.HOT_SPOT, Fit.FITS, Fit.LOW_SUN),
    ]
    assert found[0].from_utc_s == DAY_S
    assert found[-1].to_utc_s == DAY_S + 86_400.0
    at_s = DAY_S + 60.0 * np.arange(1440)
    sun = pvlib.solarposition.get_solarposition(
        pd.to_datetime(at_s, unit="s", utc=True), 41.9, -93.6
    )
    sun_deg = sun["apparent_elevation"].to_numpy()
    for span in found:
        inside = (at_s >= span.from_utc_s + 150.0) & (at_s < span.to_utc_s - 150.0)
        low, high = sun_deg[inside].min(), sun_deg[inside].max()
        assert (low >= 29.9) == (span.fit is not Fit.LOW_SUN)
        assert (high > LIMITS.highest_sun_deg + 0.1) == (span.fit is Fit.HOT_SPOT)


def test_the_corner_is_that_of_the_drawn_picture() -> None:
    # A picture of 2 x 2 tangents has its corner at the root of two.
    assert corner_deg(90.0, 90.0) == pytest.approx(np.degrees(np.arctan(np.sqrt(2.0))))


def test_clouds_end_a_span_and_without_weather_the_sun_decides_alone() -> None:
    covers = [0.9 if 14 <= hour < 16 else 0.2 for hour in range(24)]
    hours = tuple(HourWeather(DAY_S + 3600.0 * n, share) for n, share in enumerate(covers))
    lenient = FlyingLimits(corner_deg=0.0)
    found = spans(Weather("x", 0.0, -18_000.0, "", hours), lenient)
    clouded = [span for span in found if span.fit is Fit.CLOUD]
    assert [(s.from_utc_s - DAY_S, s.to_utc_s - DAY_S) for s in clouded] == [
        (13.5 * 3600.0, 15.5 * 3600.0)
    ]
    assert clouded[0].cloud_share == (0.9, 0.9)
    short = spans(Weather("x", 0.0, -18_000.0, "", hours[:12]), lenient)
    fitting = [span.cloud_share for span in short if span.fit is Fit.FITS]
    assert fitting == [(0.2, 0.2), None]


def test_a_low_winter_sun_fits_nowhere() -> None:
    winter_s = pd.Timestamp("2026-12-21T05:00Z").timestamp()
    found = flying_spans(LatLon(55.0, -93.6), winter_s, winter_s + 86_400.0, LIMITS, None)
    assert [span.fit for span in found] == [Fit.LOW_SUN]
