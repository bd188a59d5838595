"""weather.json in a site's folder: a forecast as it was fetched, with its source and date."""

from pathlib import Path
from typing import Annotated, Any

import msgspec
from msgspec import Meta, Struct

from recon.model.foreign_text import one_line
from recon.model.geo import LatLon
from recon.model.weather import Weather
from recon.site.open_meteo import LARGEST_BYTES, decoded, kept_part, read_answer, weather_of
from recon.site.reading import convert, read_bounded

WEATHER_FILE = "weather.json"
NOTICES = {"open-meteo.com": "weather data by Open-Meteo.com, CC BY 4.0"}
"""The notices that licences ask for, by the end of a server's name."""


class WeatherFile(Struct, frozen=True, forbid_unknown_fields=True):
    """The file: `answer` is Open-Meteo's, without what is not read."""

    source: Annotated[str, Meta(max_length=200)]
    fetched_utc_s: Annotated[float, Meta(ge=0.0, le=1e11)]
    answer: dict[str, Any]


def weather_bytes(
    place: str, data: bytes, site: LatLon, source: str, fetched_utc_s: float
) -> tuple[bytes, Weather]:
    """Return the file of an answer, and what it states. Raises `SiteError`."""
    value = decoded(place, data)
    weather = weather_of(place, value, site, source, fetched_utc_s, _notice(source))
    kept = kept_part(read_answer(place, value, site))
    return msgspec.json.encode(WeatherFile(source, fetched_utc_s, kept)), weather


def read_weather(folder: Path, site: LatLon) -> Weather | None:
    """Return the weather that a site's folder has; None without. Raises `SiteError`."""
    path = folder / WEATHER_FILE
    if not path.is_file():
        return None
    place = str(path)
    data = read_bounded(path, LARGEST_BYTES, "weather; remove it, or fetch it again")
    file = convert(place, decoded(place, data), WeatherFile, "")
    source = one_line(file.source)
    return weather_of(place, file.answer, site, source, file.fetched_utc_s, _notice(source))


def _notice(source: str) -> str:
    return next((text for host, text in NOTICES.items() if source.endswith(host)), "")
