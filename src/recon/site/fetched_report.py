"""What a site has fetched, and how old it is, for those who are about to fly with it."""

from collections.abc import Iterator

from recon.site.local_time import clock_text
from recon.site.site import Site

DAY_S, HOUR_S = 86_400.0, 3_600.0


def fetched_report(site: Site, now_utc_s: float) -> tuple[str, ...]:
    """Return a line on each thing that was fetched: what, when, and what to know about it."""
    return (*_terrain(site, now_utc_s), *_weather(site, now_utc_s))


def age_text(fetched_utc_s: float, now_utc_s: float) -> str:
    """Return how long ago something was fetched: fetched today, fetched 3 days ago."""
    passed_s = now_utc_s - fetched_utc_s
    if passed_s < -HOUR_S:
        return "fetched in the future, by this computer's clock"
    if passed_s < 2.0 * HOUR_S:
        return "fetched just now" if passed_s < HOUR_S else "fetched 1 hour ago"
    if passed_s < 2.0 * DAY_S:
        return f"fetched {int(passed_s / HOUR_S)} hours ago"
    return f"fetched {int(passed_s / DAY_S)} days ago"


def _terrain(site: Site, now_utc_s: float) -> Iterator[str]:
    source = site.terrain_source
    if source is None:
        return
    kinds = {
        None: "",
        True: " a surface model, with trees and buildings,",
        False: " a model of the bare ground,",
    }
    missing = f"; no tile for {', '.join(source.missing)}" if source.missing else ""
    yield (
        f"terrain of {source.title}:{kinds[source.is_surface]} heights above {source.zero}, "
        f"{age_text(source.fetched_utc_s, now_utc_s)}{missing}"
    )
    if source.notice:
        yield f"terrain: {source.notice}"


def _weather(site: Site, now_utc_s: float) -> Iterator[str]:
    weather = site.weather
    if weather is None:
        return
    last_s = weather.hours[-1].utc_s
    until = clock_text(last_s, weather.utc_offset_s)
    age = age_text(weather.fetched_utc_s, now_utc_s)
    stale = "" if now_utc_s <= last_s else ": it is over, and is not used"
    yield f"weather of {weather.source}, {age}, until {until} there{stale}"
    if weather.notice:
        yield weather.notice
