"""Answers as Open-Meteo gives them, made up."""

from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

FIRST = datetime(2026, 6, 21, tzinfo=UTC)
"""Midnight in the local time of the answers, five hours west of Greenwich."""
OFFSET_S = -18_000
NAMES = ("cloud_cover", "cloud_cover_low", "cloud_cover_mid", "cloud_cover_high")


def answer(cloud: Sequence[float | None], speed_unit: str = "km/h", **more: Any) -> dict[str, Any]:
    """Return an answer with an hour for each cover; 36 km/h from the south-west at 850 hPa."""
    count = len(cloud)
    hourly: dict[str, Any] = {
        "time": [f"{FIRST + timedelta(hours=n):%Y-%m-%dT%H:%M}" for n in range(count)],
        "cloud_cover": list(cloud),
        "cloud_cover_low": list(cloud),
        "wind_speed_10m": [18.0] * count,
        "wind_speed_850hPa": [36.0] * count,
        "wind_direction_850hPa": [225] * count,
        "geopotential_height_850hPa": [1500.0] * count,
    }
    units = dict.fromkeys(NAMES, "%") | {"time": "iso8601", "wind_direction_850hPa": "°"}
    units |= {"wind_speed_10m": speed_unit, "wind_speed_850hPa": speed_unit}
    units["geopotential_height_850hPa"] = "m"
    return {
        "latitude": 41.9,
        "longitude": -93.6,
        "elevation": 300.0,
        "generationtime_ms": 0.1,
        "utc_offset_seconds": OFFSET_S,
        "timezone": "America/Chicago",
        "timezone_abbreviation": "CDT",
        "hourly_units": units,
        "hourly": hourly,
        **more,
    }
