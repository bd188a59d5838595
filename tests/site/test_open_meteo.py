"""Weather as a server gives it: its own units, its own clock, and nothing else is believed."""

import json
from contextlib import suppress
from math import hypot

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.site.weather_answer import FIRST, OFFSET_S, answer

from recon.model.errors import SiteError
from recon.model.geo import LatLon
from recon.model.weather import Weather
from recon.site.open_meteo import LARGEST_BYTES, MOST_HOURS, decoded, weather_of
from recon.site.weather_file import WEATHER_FILE, read_weather, weather_bytes
from recon.station.recording.recorded_values import values_codec

PLACE = LatLon(41.9012, -93.6034)


def read(value: object) -> Weather:
    return weather_of("it", value, PLACE, "host", 5.0, "")


def test_hours_are_in_utc_shares_and_metres_a_second() -> None:
    weather = read(answer([0, 55.0, None, 100]))
    first = FIRST.timestamp() - OFFSET_S
    assert [hour.utc_s for hour in weather.hours] == [first + 3600.0 * n for n in range(4)]
    assert [hour.cloud_share for hour in weather.hours] == [0.0, 0.55, None, 1.0]
    assert weather.hours[0].mid_cloud_share is None
    assert weather.hours[0].wind_mps == pytest.approx(5.0)
    (wind,) = weather.hours[0].aloft
    # From the south-west is towards the north-east.
    assert (wind.east_mps, wind.north_mps) == pytest.approx((50**0.5, 50**0.5))
    assert (wind.pressure_hpa, wind.height_above_sea_m) == (850, 1500.0)
    assert weather.at(first + 1700.0) == weather.hours[0]
    assert weather.at(first + 1900.0) == weather.hours[1]
    assert weather.at(first - 1900.0) is None
    assert weather.at(first + 4 * 3600.0) is None


@pytest.mark.parametrize(
    ("unit", "mps"), [("km/h", 10.0), ("m/s", 36.0), ("mph", 16.09344), ("kn", 18.52)]
)
def test_speeds_are_in_the_unit_that_the_answer_states(unit: str, mps: float) -> None:
    (wind,) = read(answer([0], unit)).hours[0].aloft
    assert hypot(wind.east_mps, wind.north_mps) == pytest.approx(mps)


def test_unix_times_count_from_greenwich() -> None:
    value = answer([0, 0])
    value["hourly"]["time"] = [1_782_000_000, 1_782_003_600]
    value["hourly_units"]["time"] = "unixtime"
    assert [hour.utc_s for hour in read(value).hours] == [1_782_000_000, 1_782_003_600]


def with_hourly(name: str, values: object, unit: str | None = None) -> dict:
    value = answer([10, 20])
    value["hourly"][name] = values
    if unit is not None:
        value["hourly_units"][name] = unit
    return value


@pytest.mark.parametrize(
    ("value", "sentence"),
    [
        ({"error": True, "reason": "no\nkey"}, "got the server's refusal: no key"),
        ([answer([0])], "expected weather of one place, got a list of 1"),
        ({}, "latitude is missing"),
        ({**answer([0]), "latitude": 51.0}, "within 0.6 degrees of the site, got that of 51"),
        (
            {**answer([0]), "latitude": float("nan")},
            "a number of -90 to 90, got nan",
        ),
        ({**answer([0]), "hourly": {"time": 5}}, "hourly.time: expected a list, got 5"),
        (with_hourly("time", []), "expected 1 to 500 hours, got 0"),
        (answer([0] * (MOST_HOURS + 1)), "expected 1 to 500 hours, got 501"),
        (with_hourly("time", ["2026-06-21T05:00", "2026-06-21T04:00"]), "times that rise"),
        (with_hourly("time", ["2026-06-21T05:00", "2026-07-21T05:00"]), "times that rise"),
        (with_hourly("time", ["now", "then"]), "expected times as iso8601, got 'now'"),
        (with_hourly("time", ["9999-12-31T23:59", "x"]), "expected times as iso8601"),
        (with_hourly("cloud_cover", [1]), "expected 2 values, one for each time, got a list of 1"),
        (with_hourly("cloud_cover", [1, 101]), "expected numbers of 0 to 100, got 101"),
        (with_hourly("cloud_cover", [1, True]), "expected numbers of 0 to 100, got true"),
        (with_hourly("cloud_cover", [1, float("nan")]), "expected numbers of 0 to 100, got nan"),
        (with_hourly("cloud_cover", [1, 10**400]), "got a number with very many digits"),
        (with_hourly("cloud_cover", [None, None]), "expected hourly cloud_cover, got none"),
        (with_hourly("cloud_cover", [1, 2], "okta"), "hourly_units.cloud_cover: expected %"),
        (with_hourly("wind_speed_10m", [1, 2], "furlong"), "expected km/h or m/s"),
        (with_hourly("wind_speed_850hPa", [1, 1e300]), "expected numbers of 0 to 540"),
        (with_hourly("wind_direction_850hPa", [1, -1]), "expected numbers of 0 to 360"),
        (with_hourly("geopotential_height_850hPa", [1, "x"]), "expected numbers of -1000 to"),
    ],
)
def test_what_is_no_weather_of_the_place_is_refused_in_a_sentence(
    value: object, sentence: str
) -> None:
    with pytest.raises(SiteError) as found:
        read(value)
    assert sentence in str(found.value)
    assert "\n" not in str(found.value)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"<html>",
        b"\xff\xfe",
        b"[" * 100_000,
        b'{"a":' * 50_000,
        b'{"latitude": NaN}',
        b" " * (LARGEST_BYTES + 1),
        b'{"latitude": 1e99999}',
    ],
)
def test_bytes_that_are_no_json_are_refused_in_a_sentence(data: bytes) -> None:
    with pytest.raises(SiteError, match=r"^it: expected "):
        read(decoded("it", data))


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=5,
)


@settings(max_examples=150, deadline=None)
@given(
    st.sampled_from(("hourly", "hourly_units", "top")),
    st.sampled_from(
        (
            *("time", "cloud_cover", "wind_speed_10m", "wind_direction_850hPa"),
            *("latitude", "utc_offset_seconds", "timezone", "hourly", "hourly_units"),
        )
    ),
    VALUES | st.lists(st.floats() | st.integers() | st.none(), min_size=2, max_size=2),
)
def test_no_change_of_an_answer_raises_anything_but_a_site_error(
    where: str, name: str, changed: object
) -> None:
    value = answer([10, 20])
    (value if where == "top" else value[where])[name] = changed
    with suppress(SiteError):
        for hour in read(value).hours:
            assert hour.cloud_share is None or 0.0 <= hour.cloud_share <= 1.0
            assert hour.wind_mps is None or 0.0 <= hour.wind_mps <= 150.0


def test_what_is_kept_reads_the_same_and_holds_nothing_else(tmp_path) -> None:
    value = answer([10, 20, None], secret="x" * 1000)
    value["hourly"]["soil"] = ["y"] * 3
    data, weather = weather_bytes("it", json.dumps(value).encode(), PLACE, "api.open-meteo.com", 7)
    (tmp_path / WEATHER_FILE).write_bytes(data)
    assert read_weather(tmp_path, PLACE) == weather
    assert weather.notice == "weather data by Open-Meteo.com, CC BY 4.0"
    assert b"xx" not in data
    assert b"soil" not in data
    codec = values_codec()
    assert codec.decode(codec.encode(weather, Weather), Weather) == weather
    (tmp_path / WEATHER_FILE).write_bytes(data[:50])
    with pytest.raises(SiteError, match=r"weather\.json: expected"):
        read_weather(tmp_path, PLACE)
