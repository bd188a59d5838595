"""The weather of `recon site fetch`: one answer found or fetched, checked, and kept."""

import time
from pathlib import Path

from recon.cli.opened_site import save_staged
from recon.cli.output import print_line
from recon.fetching.polite_client import (
    AskedServer,
    AskFailedError,
    FetchError,
    answered,
    body_of,
    polite_client,
    with_tries,
)
from recon.fetching.source_address import local_path, shown_source
from recon.model.geo import LatLon
from recon.model.weather import Weather
from recon.site import Site
from recon.site.drawing import stage_files
from recon.site.local_time import clock_text, offset_text
from recon.site.open_meteo import LARGEST_BYTES
from recon.site.reading import read_bounded
from recon.site.weather_file import WEATHER_FILE, weather_bytes

WITHIN_S = 30.0


async def fetch_weather(folder: Path, site: Site, template: str) -> None:
    """Keep the forecast of an address or a file in a site's folder.

    Raises `FetchError` or `SiteError`.
    """
    assert site.frame is not None, "a folder's site has an origin"
    origin = site.frame.origin
    place = LatLon(origin.latitude_deg, origin.longitude_deg)
    # A hundredth of a degree is finer than any weather model, and hides the very field.
    address = template.replace("{latitude}", f"{place.latitude_deg:.2f}")
    address = address.replace("{longitude}", f"{place.longitude_deg:.2f}")
    source, path = shown_source(address), local_path(address)
    data = await _fetched(source, address) if path is None else _read(path)
    content, weather = weather_bytes(source, data, place, source, time.time())
    save_staged(folder, stage_files(folder, {WEATHER_FILE: content}), f"weather from {source}")
    for line in _lines(weather):
        print_line(line)


async def _fetched(host: str, address: str) -> bytes:
    server = AskedServer(host, "weather")

    async def once() -> bytes | None:
        async with answered(client, address, server, WITHIN_S) as answer:
            return None if answer is None else await body_of(answer, LARGEST_BYTES, "weather")

    try:
        async with polite_client("application/json") as client:
            data = await with_tries(once)
    except AskFailedError as problem:
        raise FetchError(f"{host}: expected weather, got: {problem}; try again later") from problem
    if data is None:
        raise FetchError(f"{host}: expected weather, got none; is its address right?")
    return data


def _read(path: Path) -> bytes:
    return read_bounded(path, LARGEST_BYTES, "a file of weather")


def _lines(weather: Weather) -> list[str]:
    first, last = weather.hours[0], weather.hours[-1]
    offset_s = weather.utc_offset_s
    aloft = sorted({wind.pressure_hpa for hour in weather.hours for wind in hour.aloft})
    levels = ", ".join(f"{level} hPa" for level in aloft)
    lines = [
        f"{WEATHER_FILE} written: {len(weather.hours)} hours from {weather.source}, "
        f"{clock_text(first.utc_s, offset_s)} to {clock_text(last.utc_s, offset_s)} "
        f"{offset_text(offset_s)}",
        f"wind aloft at {levels}"
        if levels
        else "no wind aloft: ask for wind_speed_850hPa and "
        "wind_direction_850hPa to have the shadows' motion expected",
    ]
    return [*lines, *([f"source: {weather.notice}"] if weather.notice else [])]
