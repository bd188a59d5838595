"""`recon when`: the hours of the next days in which a survey of a site fits."""

import re
import time
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date, timedelta
from typing import TYPE_CHECKING, Annotated, Any

import typer

from recon.cli.connection import JsonOption
from recon.cli.opened_site import FolderArgument, opened_site
from recon.cli.options import with_options
from recon.cli.output import print_json, print_line, print_table
from recon.cli.when_output import FlyingDay
from recon.guidance.flying_hours import FlyingLimits, corner_deg, flying_spans
from recon.model.errors import SiteError
from recon.model.geo import LatLon
from recon.model.survey_camera import CameraModel, camera_named
from recon.site.fetched_report import age_text
from recon.site.local_time import clock_text, local_time, midnight_utc_s, offset_text

if TYPE_CHECKING:
    from recon.site import Site

USUAL_CAMERA = "mavic3m"
DAY = timedelta(days=1)


@dataclass(frozen=True, slots=True, kw_only=True)
class WhenOptions:
    """For which days, camera and limits."""

    days: Annotated[int, typer.Option(min=1, max=16, help="How many days.")] = 3
    first: Annotated[
        str | None, typer.Option("--from", metavar="DATE", help="First day; default: from now.")
    ] = None
    camera: Annotated[
        str | None,
        typer.Option(help="Name of a survey camera; default: the site's widest, else mavic3m."),
    ] = None
    lowest_sun: Annotated[
        float, typer.Option(min=0.0, max=80.0, help="Least elevation of the sun, degrees.")
    ] = 30.0
    most_cloud: Annotated[
        float, typer.Option(min=0.0, max=100.0, help="Most cloud cover, percent.")
    ] = 60.0
    utc_offset: Annotated[
        str | None,
        typer.Option(
            metavar="+HH:MM",
            help="Of the times shown; default: the weather's, else the computer's.",
        ),
    ] = None
    as_json: JsonOption = False


@with_options
def when_command(folder: FolderArgument, options: WhenOptions) -> None:
    """Show in which hours of the next days sun, hot spot and clouds fit a survey.

    The weather is the one that `recon site fetch` has brought; nothing is fetched.
    """
    site, now_s = opened_site(folder), time.time()
    camera, offset = _camera(site, options.camera), _offset(site, options.utc_offset, now_s)
    limits = FlyingLimits(
        corner_deg(camera.model.across_deg, camera.model.along_deg),
        options.lowest_sun,
        options.most_cloud / 100.0,
    )
    days = _days(site, options, offset.seconds, limits, now_s)
    if options.as_json:
        print_json(_as_json(site, camera.model, offset, limits, days, now_s))
        return
    print_line(f"site {site.name}: {camera.text}; times are {offset.text}")
    print_line(_weather_line(site, now_s))
    print_table("when a survey fits", ("day", "hours"), [day.row for day in days])
    for day in days:
        for sentence in day.others(limits):
            print_line(sentence)


@dataclass(frozen=True, slots=True)
class _NamedCamera:
    model: CameraModel
    text: str


@dataclass(frozen=True, slots=True)
class _Offset:
    seconds: float
    text: str


def _days(
    site: "Site", options: WhenOptions, offset_s: float, limits: FlyingLimits, now_s: float
) -> list[FlyingDay]:
    place = _place(site)
    first = local_time(now_s, offset_s).date() if options.first is None else _date(options.first)
    found = []
    for day in (first + n * DAY for n in range(options.days)):
        begins_s, ends_s = (midnight_utc_s(each, offset_s) for each in (day, day + DAY))
        if options.first is None:
            begins_s = max(begins_s, now_s)
        spans = flying_spans(place, begins_s, ends_s, limits, site.weather)
        found.append(FlyingDay(day, offset_s, spans))
    return found


def _place(site: "Site") -> LatLon:
    assert site.frame is not None, "a folder's site has an origin"
    return LatLon(site.frame.origin.latitude_deg, site.frame.origin.longitude_deg)


def _date(text: str) -> date:
    try:
        found = date.fromisoformat(text)
    except ValueError:
        found = date.min
    if not 2000 <= found.year < 2050:
        # The sun's formulas are good until then.
        raise SiteError(f"--from: expected a day of 2000 to 2049 like 2026-06-21, got {text!a}")
    return found


def _camera(site: "Site", name: str | None) -> _NamedCamera:
    names = {profile.camera for profile in site.profiles.values() if profile.camera}
    chosen = {name} if name else names or {USUAL_CAMERA}
    models = [camera_named(each, site.cameras.values()) for each in sorted(chosen)]
    widest = max(models, key=lambda model: corner_deg(model.across_deg, model.along_deg))
    assumed = "" if name or names else ", as the site names none"
    return _NamedCamera(widest, f"camera {widest.title}{assumed}")


def _offset(site: "Site", stated: str | None, now_s: float) -> _Offset:
    if stated is not None:
        seconds = _seconds(stated)
        return _Offset(seconds, offset_text(seconds))
    if site.weather is not None:
        seconds = site.weather.utc_offset_s
        zone = f", {site.weather.timezone}" if site.weather.timezone else ""
        return _Offset(seconds, f"{offset_text(seconds)}{zone}, as the weather states")
    seconds = float(time.localtime(now_s).tm_gmtoff)
    return _Offset(seconds, f"{offset_text(seconds)}, as this computer's clock")


def _seconds(text: str) -> float:
    found = re.fullmatch(r"([+-])(\d{1,2})(?::?(\d\d))?", text)
    if found is None or int(found[2]) > 14 or int(found[3] or 0) > 59:
        raise SiteError(f"--utc-offset: expected an offset like +02:00, got {text!a}")
    seconds = 3_600.0 * int(found[2]) + 60.0 * int(found[3] or 0)
    return -seconds if found[1] == "-" else seconds


def _weather_line(site: "Site", now_s: float) -> str:
    weather = site.weather
    if weather is None:
        return "no weather: the sun alone; recon site fetch --weather brings a forecast"
    until = clock_text(weather.hours[-1].utc_s, weather.utc_offset_s)
    age = age_text(weather.fetched_utc_s, now_s)
    return f"weather of {weather.source}, {age}, until {until}; after that the sun alone" + (
        f"; {weather.notice}" if weather.notice else ""
    )


def _as_json(
    site: "Site",
    camera: CameraModel,
    offset: _Offset,
    limits: FlyingLimits,
    days: Sequence[FlyingDay],
    now_s: float,
) -> dict[str, Any]:
    weather = site.weather
    return {
        "site": site.name,
        "camera": camera.key,
        "utc_offset_s": offset.seconds,
        "lowest_sun_deg": limits.lowest_sun_deg,
        "highest_sun_deg": round(limits.highest_sun_deg, 1),
        "most_cloud_percent": 100.0 * limits.most_cloud_share,
        "weather": None
        if weather is None
        else {
            "source": weather.source,
            "fetched_utc_s": weather.fetched_utc_s,
            "age_s": now_s - weather.fetched_utc_s,
            "timezone": weather.timezone,
            "notice": weather.notice,
        },
        "days": [day.as_json(limits) for day in days],
    }
