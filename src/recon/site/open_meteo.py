"""A weather forecast in Open-Meteo's JSON, checked: bounded, of this place, its own units.

Hours without a value are unknown. Units are those that the answer states in `hourly_units`; a
request may ask for others than the usual ones.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from math import cos, hypot, isfinite, radians, sin
from typing import Annotated, Any

import msgspec
from msgspec import Meta, Struct

from recon.model.errors import SiteError
from recon.model.foreign_text import one_line
from recon.model.geo import LatLon
from recon.model.units import M_PER_FT
from recon.model.weather import HOUR_S, HourWeather, Weather, WindAloft
from recon.site.reading import convert, shown_value

LARGEST_BYTES = 2 * 1024 * 1024
"""Sixteen days of all variables are a quarter of it."""
MOST_HOURS = 500
FARTHEST_DEG = 0.6
"""Weather models have cells of up to a quarter of a degree; more is another place."""
LONGEST_STEP_S = 3.0 * HOUR_S
"""Some models state every third hour."""
FASTEST_MPS = 150.0
COVERS = ("cloud_cover", "cloud_cover_low", "cloud_cover_mid", "cloud_cover_high")
LEVELS_HPA = (1000, 975, 950, 925, 900, 850, 800, 700, 600, 500, 400, 300, 250, 200)
SPEEDS_MPS = {"km/h": 1 / 3.6, "m/s": 1.0, "mph": 0.44704, "mp/h": 0.44704, "kn": 1852 / 3600}
LENGTHS_M = {"m": 1.0, "ft": M_PER_FT}
TIMES = ("iso8601", "unixtime")
FIRST_YEAR, LAST_YEAR = 2000, 2100
_ISO = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d")


class OpenMeteoAnswer(Struct):
    """What is read of an answer; other keys are ignored."""

    latitude: Annotated[float, Meta(ge=-90.0, le=90.0)]
    longitude: Annotated[float, Meta(ge=-180.0, le=180.0)]
    utc_offset_seconds: Annotated[int, Meta(ge=-54_000, le=54_000)]
    hourly_units: dict[str, Any]
    hourly: dict[str, Any]
    timezone: Annotated[str, Meta(max_length=60)] = ""


def decoded(place: str, data: bytes) -> Any:
    """Return a JSON value; raises `SiteError` for a larger one, or none."""
    if len(data) > LARGEST_BYTES:
        raise SiteError(f"{place}: expected weather of at most {LARGEST_BYTES} bytes, got more")
    try:
        return msgspec.json.decode(data)
    except (msgspec.DecodeError, UnicodeDecodeError, ValueError) as problem:
        raise SiteError(
            f"{place}: expected Open-Meteo's JSON, got: {one_line(problem)}"
        ) from problem
    except RecursionError as problem:
        raise SiteError(f"{place}: expected JSON, got values nested too deeply") from problem


def read_answer(place: str, value: Any, site: LatLon) -> OpenMeteoAnswer:
    """Return an answer that is of a site; raises `SiteError`."""
    if isinstance(value, Mapping) and value.get("error") is True:
        reason = one_line(value.get("reason", "no reason"))
        raise SiteError(f"{place}: expected weather, got the server's refusal: {reason}")
    if not isinstance(value, Mapping):
        raise SiteError(f"{place}: expected weather of one place, got {shown_value(value)}")
    answer = convert(place, value, OpenMeteoAnswer, "")
    east_deg = (answer.longitude - site.longitude_deg + 180.0) % 360.0 - 180.0
    off_deg = hypot(answer.latitude - site.latitude_deg, east_deg * cos(radians(answer.latitude)))
    if not off_deg <= FARTHEST_DEG:
        raise SiteError(
            f"{place}: expected weather within {FARTHEST_DEG:g} degrees of the site, got that of "
            f"{answer.latitude:g}, {answer.longitude:g}"
        )
    return answer


def hours_of(place: str, answer: OpenMeteoAnswer) -> tuple[HourWeather, ...]:
    """Return the hours of an answer. Raises `SiteError`."""
    series = _Series(place, answer.hourly, answer.hourly_units)
    times_s = list(series.times_s(answer.utc_offset_seconds))
    total, low, mid, high = (series.values(name, {"%": 0.01}, 0.0, 1.0) for name in COVERS)
    if all(each is None for each in total):
        raise SiteError(
            f"{place}: expected hourly cloud_cover, got none; ask for "
            "hourly=cloud_cover,cloud_cover_low,cloud_cover_mid,cloud_cover_high"
        )
    wind_mps = series.values("wind_speed_10m", SPEEDS_MPS, 0.0, FASTEST_MPS)
    aloft = [_aloft(series, level) for level in LEVELS_HPA]
    return tuple(
        HourWeather(
            utc_s,
            total[n],
            low[n],
            mid[n],
            high[n],
            wind_mps[n],
            tuple(wind for level in aloft if (wind := level[n]) is not None),
        )
        for n, utc_s in enumerate(times_s)
    )


def kept_part(answer: OpenMeteoAnswer) -> dict[str, Any]:
    """Return what is read of an answer, and nothing else."""
    names = {
        *("time", *COVERS, "wind_speed_10m"),
        *(name for level in LEVELS_HPA for name in _names(level)),
    }
    parts = {name: getattr(answer, name) for name in answer.__struct_fields__}
    names &= answer.hourly.keys()
    for key in ("hourly", "hourly_units"):
        parts[key] = {name: each for name, each in parts[key].items() if name in names}
    return parts


def weather_of(
    place: str, value: Any, site: LatLon, source: str, fetched_utc_s: float, notice: str
) -> Weather:
    """Return the weather of an answer. Raises `SiteError`."""
    answer = read_answer(place, value, site)
    hours = hours_of(place, answer)
    zone = one_line(answer.timezone, 60)
    return Weather(source, fetched_utc_s, answer.utc_offset_seconds, zone, hours, notice)


@dataclass(frozen=True, slots=True)
class _Series:
    """The hourly lists of an answer, each as long as its times."""

    place: str
    hourly: Mapping[str, Any]
    units: Mapping[str, Any]

    def times_s(self, offset_s: int) -> Iterator[float]:
        """Yield the times, seconds after 1970 in UTC, rising."""
        times, unit = self._list("time"), self.units.get("time")
        if not 1 <= len(times) <= MOST_HOURS:
            raise SiteError(
                f"{self.place}: hourly.time: expected 1 to {MOST_HOURS} hours, got {len(times)}"
            )
        if unit not in TIMES:
            raise self._wrong("hourly_units.time", "iso8601 or unixtime", unit)
        earlier_s = None
        for time in times:
            utc_s = _utc_s(time, offset_s if unit == "iso8601" else None)
            if utc_s is None:
                raise self._wrong("hourly.time", f"times as {unit}", time)
            if earlier_s is not None and not 0.0 < utc_s - earlier_s <= LONGEST_STEP_S:
                raise self._wrong("hourly.time", "times that rise hour by hour", time)
            earlier_s = utc_s
            yield utc_s

    def values(
        self, name: str, units: Mapping[str, float], least: float, most: float
    ) -> list[float | None]:
        """Return a list's values in the unit that `units` are factors to; None where unknown."""
        count = len(self.hourly["time"])
        if name not in self.hourly:
            return [None] * count
        values, unit = self._list(name), self.units.get(name)
        if len(values) != count:
            raise self._wrong(f"hourly.{name}", f"{count} values, one for each time", values)
        if not isinstance(unit, str) or unit not in units:
            raise self._wrong(f"hourly_units.{name}", " or ".join(units), unit)
        return [self._value(name, value, units[unit], least, most) for value in values]

    def _list(self, name: str) -> list[Any]:
        values = self.hourly.get(name)
        if not isinstance(values, list):
            raise self._wrong(f"hourly.{name}", "a list", values)
        return values

    def _value(
        self, name: str, value: Any, factor: float, least: float, most: float
    ) -> float | None:
        if value is None:
            return None
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        found = value * factor if is_number and abs(value) < 1e9 else float("nan")
        # NaN compares as outside.
        if not least <= found <= most:
            expected = f"{least / factor:g} to {most / factor:g}"
            raise self._wrong(f"hourly.{name}", f"numbers of {expected}", value)
        return float(found)

    def _wrong(self, key: str, expected: str, got: Any) -> SiteError:
        return SiteError(f"{self.place}: {key}: expected {expected}, got {shown_value(got)}")


def _names(level_hpa: int) -> tuple[str, str, str]:
    kinds = ("wind_speed", "wind_direction", "geopotential_height")
    speed, direction, height = (f"{kind}_{level_hpa}hPa" for kind in kinds)
    return speed, direction, height


def _aloft(series: _Series, level_hpa: int) -> list[WindAloft | None]:
    """Return the wind on a level, hour by hour; None where speed or direction is unknown."""
    speed, direction, height = _names(level_hpa)
    speeds_mps = series.values(speed, SPEEDS_MPS, 0.0, FASTEST_MPS)
    from_deg = series.values(direction, {"°": 1.0}, 0.0, 360.0)
    heights_m = series.values(height, LENGTHS_M, -1_000.0, 30_000.0)
    return [
        None
        if speed_mps is None or angle_deg is None
        # A wind's direction is where it comes from.
        else WindAloft(
            level_hpa,
            -speed_mps * sin(radians(angle_deg)),
            -speed_mps * cos(radians(angle_deg)),
            height_m,
        )
        for speed_mps, angle_deg, height_m in zip(speeds_mps, from_deg, heights_m, strict=True)
    ]


def _utc_s(time: Any, offset_s: int | None) -> float | None:
    """Return a time in UTC; None for what is none. Local ones have an offset, seconds."""
    if offset_s is not None:
        if not isinstance(time, str) or not _ISO.fullmatch(time):
            return None
        try:
            utc_s = datetime.fromisoformat(time).replace(tzinfo=UTC).timestamp() - offset_s
        except ValueError:
            return None
    elif isinstance(time, int | float) and not isinstance(time, bool) and abs(time) < 1e11:
        utc_s = float(time)
    else:
        return None
    year_s = 365.2425 * 86_400.0
    first_s, last_s = ((year - 1970) * year_s for year in (FIRST_YEAR, LAST_YEAR))
    return utc_s if isfinite(utc_s) and first_s <= utc_s <= last_s else None
