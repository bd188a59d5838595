"""`recon survey`: a region cut into rows, flown by vehicles under the station's guidance."""

from collections.abc import Awaitable, Callable
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import msgspec
import typer

from recon.cli.at_station import (
    DEFAULT_ADDRESS,
    DONE,
    REFUSED,
    JsonOption,
    StationOption,
    TokenOption,
    Work,
    at_station,
)
from recon.cli.output import say, say_json, table
from recon.cli.vehicle_names import NamingError, serials_of
from recon.client import ClientError, Refusal, Station, Survey, Surveys
from recon.model.geo import GeoPoint
from recon.model.survey import WhenDone, none_such

HECTARE_M2 = 10_000.0
PHASES = {"created": "planned"}
"""What the station calls otherwise than a person would."""
NO_PLACE = "the station's site has no place: start the station with --site FOLDER"

survey_app = typer.Typer(
    help="Survey a region: create, start, pause, abort, status.", no_args_is_help=True
)

NumberArgument = Annotated[int, typer.Argument(metavar="ID", help="The survey's number.")]


@survey_app.command("create")
def create_command(
    region: Annotated[
        str,
        typer.Argument(metavar="REGION", help="The site's region of that name, or a GeoJSON file."),
    ],
    height: Annotated[float, typer.Option("--height", help="Metres above takeoff.")],
    speed: Annotated[float, typer.Option("--speed", help="Metres a second.")] = 5.0,
    feature: Annotated[
        str | None, typer.Option("--feature", help="Which feature of the file, by name.")
    ] = None,
    name: Annotated[str | None, typer.Option("--name", help="What to call the survey.")] = None,
    planner: Annotated[
        str, typer.Option("--planner", help="lawnmower_once or lawnmower_again.")
    ] = "lawnmower_once",
    front: Annotated[float, typer.Option("--front-overlap", help="Of photos, 0 to 0.95.")] = 0.7,
    side: Annotated[float, typer.Option("--side-overlap", help="Of rows, 0 to 0.95.")] = 0.6,
    bearing: Annotated[
        float | None, typer.Option("--bearing", help="Of the rows, degrees; else the best one.")
    ] = None,
    interval: Annotated[
        float, typer.Option("--interval", help="Seconds between photos, as the timer is set.")
    ] = 2.0,
    rounds: Annotated[int, typer.Option("--rounds", help="Flights over what is missing.")] = 6,
    minutes: Annotated[
        float | None, typer.Option("--minutes", min=0.1, help="After these nothing new is flown.")
    ] = None,
    when_done: Annotated[
        WhenDone,
        typer.Option("--when-done", help="What its vehicles do then, or without battery."),
    ] = WhenDone.RETURN_HOME,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Plan a survey. Nothing flies by this: `recon survey start` does that."""
    more: dict[str, Any] = {
        "height_above_takeoff_m": height,
        "speed_mps": speed,
        "planner": planner,
        "front_overlap": front,
        "side_overlap": side,
        "row_bearing_deg": bearing,
        "camera": {"interval_s": interval},
        "budget": {"rounds": rounds, "time_s": None if minutes is None else 60.0 * minutes},
        "when_done": when_done.value,
    }

    async def work(at: Station) -> int:
        where = await _where(at, region, feature, name)
        return _told(await at.surveys.create(**where, **more), as_json)

    at_station(station, token_file, work)


@survey_app.command("start")
def start_command(
    number: NumberArgument,
    vehicles: Annotated[
        list[str] | None,
        typer.Argument(metavar="VEHICLE...", help="Serials or names."),
    ] = None,
    takeoff: Annotated[
        bool, typer.Option("--takeoff", help="Each may leave the ground, once.")
    ] = False,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Fly a survey with these vehicles: they are given to the station's guidance by this word.

    Said of a running survey, they join it, or fly for it again.
    """

    async def work(at: Station) -> int:
        if not vehicles:
            raise NamingError("name the vehicles that fly the survey")
        serials = serials_of(at, vehicles)
        return _told(await at.surveys.start(number, serials, takeoff=takeoff), as_json)

    at_station(station, token_file, work)


@survey_app.command("pause")
def pause_command(
    number: NumberArgument,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Pause a survey. Its vehicles hold, and are the operator's again."""
    at_station(station, token_file, _stop(Surveys.pause, number, as_json))


@survey_app.command("abort")
def abort_command(
    number: NumberArgument,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Abort a survey for good. Its vehicles hold, and are the operator's again."""
    at_station(station, token_file, _stop(Surveys.abort, number, as_json))


@survey_app.command("status")
def status_command(
    number: Annotated[int | None, typer.Argument(metavar="ID", help="One; else all.")] = None,
    as_json: JsonOption = False,
    station: StationOption = DEFAULT_ADDRESS,
    token_file: TokenOption = None,
) -> None:
    """Show the surveys, their figures and vehicles, the newest first."""
    at_station(station, token_file, _status(number, as_json))


def _stop(
    word: Callable[[Surveys, int], Awaitable[Survey | Refusal]], number: int, as_json: bool
) -> Work:
    async def work(at: Station) -> int:
        return _told(await word(at.surveys, number), as_json)

    return work


def _status(number: int | None, as_json: bool) -> Work:
    async def work(at: Station) -> int:
        known = await at.surveys.list()
        surveys = [survey for survey in known if number in (None, survey.id)]
        if number is not None and not surveys:
            raise NamingError(none_such(number, ((s.id, s.name, s.phase) for s in known)))
        if as_json:
            say_json(msgspec.to_builtins(surveys))
        else:
            _tell_all(surveys)
        return DONE

    return work


async def _where(at: Station, region: str, feature: str | None, name: str | None) -> dict[str, Any]:
    """What to survey: a file's region where there is such a file, else the site's of that name."""
    path = Path(region)
    if not path.is_file() and path.suffix.lower() not in (".geojson", ".json"):
        return {"region": region, "name": name}
    site = await at.surveys.site_origin()
    if site is None or site.latitude_deg is None or site.longitude_deg is None:
        raise ClientError(NO_PLACE)
    origin = GeoPoint(site.latitude_deg, site.longitude_deg, site.ground_altitude_m or 0.0)
    # Loaded only here: geometry takes longer to load than a stop may wait.
    own, rings = import_module("recon.cli.region_file").read_region(path, feature, origin)
    return {"polygon": rings, "name": name or own}


def _told(answer: Survey | Refusal, as_json: bool) -> int:
    if isinstance(answer, Refusal):
        say(f"refused by the rule {answer.rule}: {answer.reason}")
        return REFUSED
    if as_json:
        say_json(msgspec.to_builtins(answer))
    else:
        say(_sentence(answer))
        _tell_all([answer])
    return DONE


def _sentence(survey: Survey) -> str:
    """The survey's number first: it is what every later word on the survey names."""
    number, phase = survey.id, PHASES.get(survey.phase, survey.phase)
    said = f"survey {number}: {phase}, {survey.name}"
    if survey.phase != "created":
        return said
    return f"{said}. Nothing flies by this: `recon survey start {number} VEHICLE...` does that"


def _tell_all(surveys: list[Survey]) -> None:
    rows = [
        (
            f"survey {s.id}",
            s.name,
            PHASES.get(s.phase, s.phase),
            f"{s.rows} rows",
            *_areas(s),
            s.reason,
        )
        for s in surveys
    ]
    columns = ("number", "name", "is", "rows", "region", "not yet", "in shade", "in sun", "why")
    table("surveys", columns, rows)
    members = [
        (v.vehicle_name, "flies rows" if v.is_flying_rows else v.waits_for or v.refused or "waits")
        for survey in surveys
        for v in survey.vehicles
    ]
    if members:
        table("vehicles", ("vehicle", "what it does"), members)


def _areas(survey: Survey) -> tuple[str, str, str, str]:
    seen = survey.figures
    if seen is None:
        return "", "", "", ""
    areas = (seen.region_m2, seen.not_yet_m2, seen.in_shade_m2, seen.in_sun_m2)
    region, not_yet, in_shade, in_sun = (f"{area / HECTARE_M2:.2f} ha" for area in areas)
    return region, f"not yet {not_yet}", f"in shade {in_shade}", f"in sun {in_sun}"
