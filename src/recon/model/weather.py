"""A weather forecast of one place, hour by hour."""

from dataclasses import dataclass

HOUR_S = 3_600.0


@dataclass(frozen=True, slots=True)
class WindAloft:
    """The wind on a level of pressure, as the motion of the air."""

    pressure_hpa: int
    east_mps: float
    north_mps: float
    height_above_sea_m: float | None = None
    """None: not stated; the standard atmosphere's is near enough."""


@dataclass(frozen=True, slots=True)
class HourWeather:
    """One hour; shares are 0 to 1, and None is unknown."""

    utc_s: float
    cloud_share: float | None = None
    low_cloud_share: float | None = None
    """Below 3 km."""
    mid_cloud_share: float | None = None
    """From 3 to 8 km."""
    high_cloud_share: float | None = None
    wind_mps: float | None = None
    """10 m above ground."""
    aloft: tuple[WindAloft, ...] = ()


@dataclass(frozen=True, slots=True)
class Weather:
    """A forecast, with where it is from; hours rise."""

    source: str
    fetched_utc_s: float
    utc_offset_s: float
    """Of the local time there."""
    timezone: str
    hours: tuple[HourWeather, ...]
    notice: str = ""

    def at(self, utc_s: float) -> HourWeather | None:
        """Return the hour nearest to a time; None beyond the forecast's hours."""
        if not self.hours:
            return None
        first_s, last_s = self.hours[0].utc_s, self.hours[-1].utc_s
        if not first_s - HOUR_S / 2.0 <= utc_s <= last_s + HOUR_S / 2.0:
            return None
        return min(self.hours, key=lambda hour: abs(hour.utc_s - utc_s))
