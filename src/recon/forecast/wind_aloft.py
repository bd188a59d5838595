"""The wind that moves the clouds whose shadows are sharp, of a weather forecast. Pure."""

from recon.model.weather import HourWeather, WindAloft

LOW_CLOUD_M, MID_CLOUD_M = 1_500.0, 5_000.0
"""Usual heights above ground of clouds below 3 km, and of those from 3 to 8 km. High clouds are
thin: their shade is half sun."""
FARTHEST_M = 2_500.0
"""A level farther from the clouds states another wind."""


def wind_at_clouds(hour: HourWeather, ground_above_sea_m: float) -> WindAloft | None:
    """Return the wind at the height of the clouds that cover most; None if no level is near it."""
    low, mid = hour.low_cloud_share or 0.0, hour.mid_cloud_share or 0.0
    cloud_m = ground_above_sea_m + (MID_CLOUD_M if mid > low else LOW_CLOUD_M)
    levels = [(abs(_height_m(wind) - cloud_m), wind.pressure_hpa, wind) for wind in hour.aloft]
    off_m, _, nearest = min(levels, default=(float("inf"), 0, None))
    return nearest if off_m <= FARTHEST_M else None


def _height_m(wind: WindAloft) -> float:
    """Return a level's height above the sea: as stated, else of the standard atmosphere."""
    if wind.height_above_sea_m is not None:
        return wind.height_above_sea_m
    share: float = (wind.pressure_hpa / 1013.25) ** 0.190263
    return 44_330.8 * (1.0 - share)
