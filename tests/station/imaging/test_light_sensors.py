"""Light sensors beside constructed shade maps: what each shows, and what the maps say there."""

import numpy as np
import pytest

from recon.geo import geo_from_enu
from recon.light.lines import MOST_SENSORS
from recon.model.event import ClockRead, Tick
from recon.model.geo import GeoPoint, GroundGrid, LatLon, LocalFrame
from recon.model.light import LightRead, LightReading
from recon.model.replacing import replace
from recon.model.shade import ShadeMap
from recon.model.units import NS_PER_S
from recon.station.api_views.light_sensor_views import light_sensors_view
from recon.station.imaging.light_sensors import FORGOTTEN_S
from recon.station.kernel.step import step
from recon.station.state.station import Station

FRAME = LocalFrame(GeoPoint(41.9, -93.6, 290.0))
GRID = GroundGrid(FRAME, -50.0, 50.0, 10.0, 10, 10)
UTC_AHEAD_S = 7_200
FULL, SHADED = 820.0, 240.0


def place(east_m: float, north_m: float) -> LatLon:
    latitude, longitude, _height = geo_from_enu(FRAME, (east_m, north_m, 0.0))
    return LatLon(float(latitude[0]), float(longitude[0]))


WEST, EAST, UNSEEN, OFF = place(-30, 0), place(30, 0), place(0, 45), place(900, 0)


def at_ns(at_s: float) -> int:
    return round((1_000_000_000 + at_s) * NS_PER_S)


def with_clock() -> Station:
    wall_ns = at_ns(UTC_AHEAD_S)
    return step(Station(), ClockRead(wall_ns), at_ns(0.0))[0]


def reads(station: Station, at_s: float, source: str = "mast", **values: float) -> Station:
    """The station after readings of named sensors, heard as soon as they are read."""
    places = {"west": WEST, "east": EAST, "unseen": UNSEEN, "off": OFF}
    readings = tuple(
        LightReading(name, at_ns(at_s + UTC_AHEAD_S), value, places.get(name))
        for name, value in values.items()
    )
    return step(station, LightRead(source, readings), at_ns(at_s))[0]


def maps(station: Station, at_s: float) -> Station:
    """The station after a map with the west in shade and the upper row not known."""
    transmittance = np.ones((10, 10), np.float32)
    transmittance[:, :5] = 0.1
    valid = np.ones((10, 10), np.bool_)
    valid[0] = False
    shade = ShadeMap(
        GRID, at_ns(at_s), (), transmittance, valid, valid.astype(np.float32), transmittance
    )
    line = replace(station.shade, shade=shade, number=station.shade.number + 1)
    return step(replace(station, shade=line), Tick(), at_ns(at_s + 2.0))[0]


def seen(station: Station, at_s: float) -> dict[str, tuple[str, str, int, int]]:
    view = light_sensors_view(station, at_ns(at_s))
    assert view is not None
    return {e.name: (e.shows, e.map_says, e.right, e.compared) for e in view.sensors}


def contrasted(station: Station) -> Station:
    """Each of four sensors has seen sun and shade."""
    for at_s, value in ((0.0, FULL), (1.0, SHADED)):
        station = reads(station, at_s, west=value, east=value, unseen=value, off=value)
    return station


def test_each_sensor_is_held_against_the_map_where_it_stands() -> None:
    station = contrasted(with_clock())
    for at_s in (2.0, 3.0):
        station = reads(station, at_s, west=SHADED, east=SHADED, unseen=FULL, off=FULL)
        station = maps(station, at_s)
    assert seen(station, 5.0) == {
        "west": ("shade", "shade", 2, 2),
        "east": ("shade", "sun", 0, 2),
        "unseen": ("sun", "unknown", 0, 0),
        "off": ("sun", "unknown", 0, 0),
    }


def test_full_light_is_unknown_until_sun_and_shade_were_seen() -> None:
    station = reads(with_clock(), 0.0, west=SHADED)
    station = maps(reads(station, 1.0, west=SHADED * 1.1), 1.0)
    assert seen(station, 3.0) == {"west": ("unknown", "shade", 0, 0)}
    station = maps(reads(station, 2.0, west=FULL), 2.0)
    assert seen(station, 3.0) == {"west": ("sun", "shade", 0, 1)}


def test_a_silent_sensor_is_stale_and_is_not_compared() -> None:
    station = contrasted(with_clock())
    view = light_sensors_view(maps(station, 30.0), at_ns(31.0))
    assert view is not None
    west = next(each for each in view.sensors if each.name == "west")
    assert (west.is_live, west.shows, west.map_says) == (False, "unknown", "shade")
    assert (west.age_s, west.value, west.compared) == (30.0, SHADED, 0)


def test_a_slow_logger_is_live_for_three_of_its_steps() -> None:
    station = with_clock()
    for number in range(4):
        station = reads(station, 60.0 * number, west=FULL if number else SHADED)
    assert seen(station, 300.0)["west"][0] == "sun"
    assert seen(station, 361.0)["west"][0] == "unknown"


def test_an_old_map_says_nothing() -> None:
    station = maps(contrasted(with_clock()), 1.0)
    assert seen(station, 10.0)["west"][1] == "shade"
    assert seen(station, 12.0)["west"][1] == "unknown"


def test_a_clock_that_is_ahead_is_not_live_and_may_be_set_back() -> None:
    station = reads(contrasted(with_clock()), 2.0 + 3_600.0, west=FULL)
    assert seen(station, 3.0)["west"][0] == "unknown"
    station = reads(station, 4.0, west=FULL)
    assert seen(station, 4.0)["west"][0] == "sun"


def test_two_loggers_with_one_name_are_not_mixed() -> None:
    station = contrasted(with_clock())
    after = reads(station, 2.0, "another", west=1.0)
    assert after.light_sensors.sensors == station.light_sensors.sensors
    assert "mast sends one of this name" in after.light_sensors.problem
    view = light_sensors_view(after, at_ns(7.0))
    assert view is not None
    assert view.problem_age_s == 5.0
    gone = reads(station, 100.0, "another", west=1.0)
    assert gone.light_sensors.sensors["west"].source == "another"


def test_too_many_sensors_take_the_place_of_long_silent_ones_only() -> None:
    names = {f"s{number}": FULL for number in range(MOST_SENSORS)}
    station = reads(with_clock(), 0.0, **names)
    refused = reads(station, 5.0, one_more=FULL)
    assert "one_more" not in refused.light_sensors.sensors
    assert f"expected at most {MOST_SENSORS} sensors" in refused.light_sensors.problem
    later = reads(station, FORGOTTEN_S + 5.0, one_more=FULL)
    assert "one_more" in later.light_sensors.sensors
    assert len(later.light_sensors.sensors) == MOST_SENSORS


def test_memory_is_bounded_and_full_light_is_that_of_the_whole_run() -> None:
    station, rng = with_clock(), np.random.default_rng(4)
    values = np.where(rng.random(3_000) < 0.3, SHADED, FULL + 10.0 * rng.random(3_000))
    for number, value in enumerate(values.tolist()):
        station = reads(station, float(number), west=value)
    sensor = station.light_sensors.sensors["west"]
    assert len(sensor.sample) <= 256
    assert len(sensor.readings) <= 32
    full = float(np.percentile(values, 98.0))
    assert sensor.direct(SHADED) == pytest.approx((SHADED / full - 0.25) / 0.75, abs=0.005)


def test_refused_lines_are_counted_and_named() -> None:
    station = step(with_clock(), LightRead("mast", (), 3, "line 9: expected a number"), 0)[0]
    view = light_sensors_view(station, 0)
    assert view is not None
    assert (view.sensors, view.refused_lines) == ([], 3)
    assert view.problem == "mast: line 9: expected a number"
    assert light_sensors_view(with_clock(), 0) is None
