"""The sun's position by the Astronomical Almanac's low-precision formulas.

As given by Michalsky (Solar Energy 40, 1988), good to 0.01 degrees between 1950 and 2050: the
shadow of a cloud at 2 km is right within a metre.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import asin, atan2, cos, degrees, hypot, isfinite, radians, sin, tan

import numpy as np
import numpy.typing as npt

from recon.model.geo import LatLon

J2000_UNIX_S = 946_728_000.0
"""2000-01-01 12:00 UTC."""
DAY_S = 86_400.0
POSITIONS_KEPT = 16_384
HALVINGS = 30
"""Halvings of half a day: to a tenth of a millisecond."""


@dataclass(frozen=True, slots=True)
class SunPosition:
    """Direction of the sun, refraction included."""

    azimuth_deg: float
    """Clockwise from north."""
    elevation_deg: float
    distance_au: float

    @property
    def toward_enu(self) -> npt.NDArray[np.float64]:
        """Unit vector (3,) to the sun: east, north, up."""
        azimuth, elevation = radians(self.azimuth_deg), radians(self.elevation_deg)
        level = cos(elevation)
        return np.array([level * sin(azimuth), level * cos(azimuth), sin(elevation)])


@dataclass(frozen=True, slots=True)
class _Ecliptic:
    right_ascension_rad: float
    declination_rad: float
    distance_au: float


@lru_cache(maxsize=POSITIONS_KEPT)
def sun_position(place: LatLon, utc_s: float) -> SunPosition:
    """Return the sun's position at a place, `utc_s` seconds after 1970-01-01 00:00 UTC.

    Raises `ValueError` for an invalid place or a time that is NaN or infinity.
    """
    if not (place.is_valid() and isfinite(utc_s)):
        raise ValueError(f"expected a place on the globe and a time, got {place} at {utc_s}")
    days = (utc_s - J2000_UNIX_S) / DAY_S
    sun = _ecliptic(days)
    latitude = radians(place.latitude_deg)
    hour_angle = _hour_angle_rad(days, utc_s, place.longitude_deg, sun)
    up = sin(sun.declination_rad) * sin(latitude)
    up += cos(sun.declination_rad) * cos(latitude) * cos(hour_angle)
    east = -cos(sun.declination_rad) * sin(hour_angle)
    north = sin(sun.declination_rad) * cos(latitude)
    north -= cos(sun.declination_rad) * sin(latitude) * cos(hour_angle)
    elevation = degrees(atan2(up, hypot(east, north)))
    return SunPosition(
        degrees(atan2(east, north)) % 360.0, elevation + refraction_deg(elevation), sun.distance_au
    )


def utc_at_elevation(
    place: LatLon, near_utc_s: float, elevation_deg: float, *, is_rising: bool
) -> float:
    """Return when the sun is at an elevation, before or after the noon nearest to a time.

    Raises `ValueError` where the sun does not reach it on that day.
    """
    noon_s = _noon_utc_s(place, near_utc_s)
    below_s, above_s = noon_s - (0.5 * DAY_S if is_rising else -0.5 * DAY_S), noon_s
    lowest, highest = (sun_position(place, at_s).elevation_deg for at_s in (below_s, above_s))
    if not lowest <= elevation_deg <= highest:
        raise ValueError(
            f"expected an elevation of {lowest:.1f} to {highest:.1f} degrees, as the sun has on"
            f" that day, got {elevation_deg:g}"
        )
    # From midnight to noon the sun only rises, from noon to midnight it only sinks.
    for _ in range(HALVINGS):
        middle_s = (below_s + above_s) / 2.0
        if sun_position(place, middle_s).elevation_deg < elevation_deg:
            below_s = middle_s
        else:
            above_s = middle_s
    return above_s


def _noon_utc_s(place: LatLon, near_utc_s: float) -> float:
    """Return when the sun is highest, within a minute, on the day around a time."""
    mean_noon_s = 0.5 * DAY_S - place.longitude_deg / 360.0 * DAY_S
    mean_noon_s += round((near_utc_s - mean_noon_s) / DAY_S) * DAY_S
    # True noon is within 17 minutes of the mean one (equation of time).
    times_s = [mean_noon_s + 60.0 * minute for minute in range(-20, 21)]
    return max(times_s, key=lambda at_s: sun_position(place, at_s).elevation_deg)


def refraction_deg(elevation_deg: float) -> float:
    """Return the refraction in degrees (Saemundsson 1986); 0 well below the horizon."""
    if elevation_deg < -1.0:
        return 0.0
    return 1.02 / tan(radians(elevation_deg + 10.3 / (elevation_deg + 5.11))) / 60.0


def _ecliptic(days: float) -> _Ecliptic:
    mean_longitude = radians((280.460 + 0.9856474 * days) % 360.0)
    anomaly = radians((357.528 + 0.9856003 * days) % 360.0)
    longitude = mean_longitude + radians(1.915 * sin(anomaly) + 0.020 * sin(2.0 * anomaly))
    obliquity = radians(23.439 - 4e-7 * days)
    return _Ecliptic(
        atan2(cos(obliquity) * sin(longitude), cos(longitude)),
        asin(sin(obliquity) * sin(longitude)),
        1.00014 - 0.01671 * cos(anomaly) - 0.00014 * cos(2.0 * anomaly),
    )


def _hour_angle_rad(days: float, utc_s: float, longitude_deg: float, sun: _Ecliptic) -> float:
    hours = (utc_s % DAY_S) / 3600.0
    sidereal_h = (6.697375 + 0.0657098242 * days + hours) % 24.0
    return radians(sidereal_h * 15.0 + longitude_deg) - sun.right_ascension_rad
