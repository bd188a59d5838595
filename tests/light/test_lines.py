"""Lines of loggers, good and bad ones, as they come in parts."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.geo import geo_from_enu
from recon.light.lines import LONGEST_LINE_BYTES, MOST_SENSORS, PROBLEMS_KEPT, LightLines
from recon.model.geo import GeoPoint, LatLon, LocalFrame
from recon.model.light import LightRead, LightReading
from recon.model.units import NS_PER_S

FRAME = LocalFrame(GeoPoint(41.9, -93.6, 290.0))
NOW_NS = 1_750_000_100 * NS_PER_S
AT_NS = 1_750_000_000 * NS_PER_S
GATE = LatLon(41.9, -93.6)


def heard(*lines: str, frame: LocalFrame | None = FRAME, part: int = 7) -> LightRead:
    """What lines give that come a few bytes at a time."""
    found, data = LightLines(frame), "".join(f"{line}\n" for line in lines).encode()
    for begin in range(0, len(data), part):
        found.push(data[begin : begin + part], NOW_NS)
    read, _problems = found.taken("mast")
    return read or LightRead("mast")


def test_a_wide_and_a_long_logger_state_the_same() -> None:
    wide = heard("Time;gate;oak", "lat;41.9;41.91", "lon;-93.6;-93.61", "1750000000;800.5;nan")
    long = heard("utc,sensor,ghi,lat,lon", "2025-06-15T15:06:40,gate,800.5,41.9,-93.6")
    assert wide == long == LightRead("mast", (LightReading("gate", AT_NS, 800.5, GATE),))


def test_places_in_metres_are_from_the_sites_origin() -> None:
    lines = ("time,sensor,east_m,north_m,par", "1750000000,gate,100,-50,3")
    (found,) = heard(*lines).readings
    latitude, longitude, _height = geo_from_enu(FRAME, (100.0, -50.0, 0.0))
    assert found.place == LatLon(float(latitude[0]), float(longitude[0]))
    assert "metres need a site with an origin" in heard(*lines, frame=None).problem


@pytest.mark.parametrize("place", ["-93.6,41.9", "42.2,-93.6", "0,0"])
def test_a_place_far_from_the_site_is_refused_as_the_record_could_not_be_verified(
    place: str,
) -> None:
    found = heard("time,sensor,lat,lon,par", f",gate,{place},3", ",oak,41.9,-93.6,4")
    assert [each.sensor for each in found.readings] == ["oak"]
    assert "line 2: expected a place" in found.problem or "degrees" in found.problem
    assert heard("time,sensor,lat,lon,par", ",gate,42.2,-93.6,3", frame=None).readings


def test_a_logger_without_clock_or_place_is_read_at_its_arrival() -> None:
    assert heard("time,a", ",5").readings == (LightReading("a", NOW_NS, 5.0),)


def test_a_logger_that_begins_anew_sends_its_head_again() -> None:
    found = heard("time,a", "1750000000,5", "time,a", "1750000001,6")
    assert [each.value for each in found.readings] == [5.0, 6.0]
    assert found.refused == 0


def test_a_byte_order_mark_alone_is_an_empty_line() -> None:
    found = heard("\ufeff", "time,a", "\ufeff\r", ",5")
    assert ([each.value for each in found.readings], found.refused) == ([5.0], 0)


def test_a_value_without_a_usable_name_is_refused_and_the_others_are_used() -> None:
    found = heard("time,a,", ",5,", ",6,7")
    assert [(each.sensor, each.value) for each in found.readings] == [("a", 5.0), ("a", 6.0)]
    assert found.problem == "line 3: expected a sensor's name of 1 to 40 characters, got ''"
    found = heard("time,sensor,par", ",,5", ",\x1b\x07,5", f",{'a' * 41},5")
    assert (found.readings, found.refused) == ((), 3)
    assert "got 'aaa" in found.problem


BAD = [
    ("1750000000,x", "line 2: expected a number such as 1480 or 0.5, got 'x'"),
    ("1750000000", "line 2: expected 2 values, one for each column of the head, got 1"),
    ("yesterday,1", "line 2: expected a time in ISO 8601 or Unix seconds, got 'yesterday'"),
    ("9999-01-01,1", "line 2: expected Unix seconds, got 2.53371e+11 (milliseconds?)"),
    ("1750000000,inf", "line 2: expected a value of light, got inf"),
    ("1750000000," + "9" * LONGEST_LINE_BYTES, "line 2: expected at most 2048 bytes, got more"),
    ("lat,95", "expected degrees of latitude and longitude, got 95, 0"),
]


@pytest.mark.parametrize(("line", "words"), BAD)
def test_a_bad_line_costs_itself_alone(line: str, words: str) -> None:
    after = ["lon,0", "1750000000,5"] if line.startswith("lat") else []
    found = heard("time,a", line, *after, "lat,41.9", "lon,-93.6", "1750000000,5")
    assert words in found.problem
    assert found.refused == 1
    assert found.readings == (LightReading("a", AT_NS, 5.0, GATE),)


@pytest.mark.parametrize(
    "lines",
    [
        ["time," + ",".join(map(str, range(MOST_SENSORS + 1)))],
        ["time,sensor,ghi", *(f"1750000000,{n},1" for n in range(MOST_SENSORS + 1))],
    ],
)
def test_a_logger_has_so_many_sensors_and_no_more(lines: list[str]) -> None:
    assert f"expected at most {MOST_SENSORS} sensors, got" in heard(*lines).problem


@given(st.lists(st.binary(max_size=60), max_size=8))
def test_any_bytes_are_read_within_limits(parts: list[bytes]) -> None:
    found = LightLines(None)
    for part in [b"time,sensor,v\n", *parts]:
        found.push(part, NOW_NS)
        assert len(found.problems) <= PROBLEMS_KEPT
    read, _problems = found.taken("mast")
    lines = b"".join(parts).count(b"\n")
    assert read is None or len(read.readings) + read.refused <= lines
