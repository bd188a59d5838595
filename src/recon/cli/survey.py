"""`recon survey`: a region cut into rows, flown by vehicles that guidance controls."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import msgspec
import typer

from recon.cli.commands import App
from recon.cli.connection import (
    DONE,
    REFUSED,
    JsonOption,
    NamesArgument,
    named_serials,
    station_command,
)
from recon.cli.output import print_json, print_line, print_table
from recon.client import ClientError, Refusal, Station, SurveyStatus
from recon.client.surveys import SurveyVehicle
from recon.model.geo import GeoPoint
from recon.model.survey import PLANNER_GOALS, WhenDone, height_text, unknown_survey
from recon.model.units import HECTARE_M2

PHASES = {"created": "planned"}
"""Words that differ from the API's."""
REGION_SUFFIXES = (
    *(".geojson", ".json", ".kml", ".kmz", ".zip", ".gpkg", ".gpx", ".xml", ".plan"),
)
NO_ORIGIN = "the station's site has no origin: start the station with --site FOLDER"

survey_app = App(
    help="Survey a region: create, estimate, start, pause, abort, status.", no_args_is_help=True
)

NumberArgument = Annotated[int, typer.Argument(metavar="ID", help="The survey's number.")]


class SurveyNumberError(ClientError):
    """No survey has this number."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RowOptions:
    """How rows are projected over a region, for a plan as for a survey."""

    feature: Annotated[
        str | None, typer.Option("--feature", help="Name of the feature in the file.")
    ] = None
    close_paths: Annotated[
        bool, typer.Option("--close-paths", help="Take a path in the file as an area.")
    ] = False
    above_ground: Annotated[
        bool,
        typer.Option(
            "--above-ground",
            help="The height is above the ground of the site's elevation model, not above takeoff.",
        ),
    ] = False
    front: Annotated[
        float, typer.Option("--front-overlap", help="Overlap of photos along a row, 0 to 0.95.")
    ] = 0.7
    side: Annotated[float, typer.Option("--side-overlap", help="Overlap of rows, 0 to 0.95.")] = 0.6
    bearing: Annotated[
        float | None,
        typer.Option("--bearing", help="Of the rows, degrees; default: the fewest turns."),
    ] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CreateOptions:
    """A survey: its region, how it is flown and what the imaging drone may do."""

    region: Annotated[
        str,
        typer.Argument(
            metavar="REGION",
            help="Name of a survey region of the site, or a GeoJSON, KML, KMZ, Shapefile (zip) or "
            "GeoPackage file.",
        ),
    ]
    height: Annotated[
        float, typer.Option("--height", help="Metres above takeoff, or above ground.")
    ]
    speed: Annotated[float, typer.Option("--speed", help="Metres per second.")] = 5.0
    name: Annotated[str | None, typer.Option("--name", help="Name of the survey.")] = None
    planner: Annotated[
        str | None,
        typer.Option(
            "--planner",
            help=f"{' or '.join(PLANNER_GOALS)}. Default: sunlit_first with an imaging drone, else "
            "lawnmower_once.",
        ),
    ] = None
    camera: Annotated[
        str | None,
        typer.Option(
            "--camera",
            help="Name of a camera; `recon plan --camera list`. Default: a common one, 4:3, of "
            "unknown pixels.",
        ),
    ] = None
    interval: Annotated[
        float,
        typer.Option("--interval", help="Seconds between photos, as set in the camera's timer."),
    ] = 2.0
    rounds: Annotated[
        int,
        typer.Option(
            "--rounds", help="Most rounds of a lawnmower over ground that is still missing."
        ),
    ] = 6
    minutes: Annotated[
        float | None, typer.Option("--minutes", min=0.1, help="No new mission after this many.")
    ] = None
    when_done: Annotated[
        WhenDone,
        typer.Option("--when-done", help="What vehicles do when finished or low on battery."),
    ] = WhenDone.RETURN_HOME
    side_step: Annotated[
        bool,
        typer.Option(
            "--side-step",
            help="The imaging drone may side-step automatically while light is mostly unknown.",
        ),
    ] = False
    upwind: Annotated[
        bool,
        typer.Option(
            "--upwind",
            help="The imaging drone may fly to where it sees more of the shade to come.",
        ),
    ] = False
    relief: Annotated[
        bool,
        typer.Option(
            "--relief",
            help="The imaging drone is relieved by the spare drone, or recalled, when its "
            "battery is at the return threshold.",
        ),
    ] = False
    spare: Annotated[
        str | None,
        typer.Option("--spare", help="The imaging drone that relieves it; with --relief."),
    ] = None

    def as_requested(self, rows: RowOptions) -> dict[str, Any]:
        """Return the survey as the client creates it, but for its region."""
        height = "height_above_ground_m" if rows.above_ground else "height_above_takeoff_m"
        time_s = None if self.minutes is None else 60.0 * self.minutes
        return {
            height: self.height,
            "speed_mps": self.speed,
            "planner": self.planner,
            "front_overlap": rows.front,
            "side_overlap": rows.side,
            "row_bearing_deg": rows.bearing,
            "camera": {"model": self.camera, "interval_s": self.interval},
            "budget": {"rounds": self.rounds, "time_s": time_s},
            "when_done": self.when_done.value,
            "side_step_allowed": self.side_step,
            "upwind_allowed": self.upwind,
            "relief_allowed": self.relief,
        }


@survey_app.command("create")
@station_command
async def create_command(
    station: Station, survey: CreateOptions, rows: RowOptions, as_json: JsonOption = False
) -> int:
    """Plan a survey.

    Nothing flies yet: `recon survey start` starts it.
    """
    area = await _area(station, survey.region, rows, survey.name)
    if survey.spare is not None:
        area["spare_serial"] = named_serials(station, [survey.spare])[0]
    answer = await station.surveys.create(**area, **survey.as_requested(rows))
    return _print_answer(answer, as_json)


@survey_app.command("start")
@station_command
async def start_command(
    station: Station,
    number: NumberArgument,
    vehicles: NamesArgument = None,
    takeoff: Annotated[
        bool, typer.Option("--takeoff", help="Allow takeoff for this start.")
    ] = False,
    as_json: JsonOption = False,
) -> int:
    """Fly a survey with these vehicles; guidance takes control of them.

    For a running survey: add vehicles, or resume those that stopped.
    """
    serials = named_serials(station, vehicles)
    return _print_answer(await station.surveys.start(number, serials, takeoff=takeoff), as_json)


@survey_app.command("estimate")
@station_command
async def estimate_command(
    station: Station,
    number: NumberArgument,
    vehicles: NamesArgument = None,
    as_json: JsonOption = False,
) -> int:
    """Show what a survey will take with these vehicles: time, photos, batteries.

    Nothing flies. Without vehicles it is for one drone.
    """
    serials = named_serials(station, vehicles) if vehicles else []
    preview = await station.surveys.estimate(number, serials)
    if as_json:
        print_json(msgspec.to_builtins(preview))
    elif preview.refusal is not None:
        print_line(f"refused: {preview.refusal}")
    else:
        # Imported here: geometry takes longer to load than a pause may wait.
        from recon.cli.plan_output import rows_of

        figures = msgspec.to_builtins(preview)
        print_table("estimate", ("what", "value"), rows_of(figures))
    return REFUSED if preview.refusal or preview.warnings else DONE


@survey_app.command("pause")
@station_command
async def pause_command(
    station: Station, number: NumberArgument, as_json: JsonOption = False
) -> int:
    """Pause a survey.

    Its vehicles hold position, under operator control.
    """
    return _print_answer(await station.surveys.pause(number), as_json)


@survey_app.command("abort")
@station_command
async def abort_command(
    station: Station, number: NumberArgument, as_json: JsonOption = False
) -> int:
    """End a survey; it cannot be resumed.

    Its vehicles hold position, under operator control.
    """
    return _print_answer(await station.surveys.abort(number), as_json)


@survey_app.command("status")
@station_command
async def status_command(
    station: Station,
    number: Annotated[
        int | None, typer.Argument(metavar="ID", help="One survey; default: all.")
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Show surveys, their coverage and vehicles, the newest first."""
    known = await station.surveys.list()
    surveys = [survey for survey in known if number in (None, survey.id)]
    if number is not None and not surveys:
        raise SurveyNumberError(unknown_survey(number, ((s.id, s.name, s.phase) for s in known)))
    if as_json:
        print_json(msgspec.to_builtins(surveys))
    else:
        _print_surveys(surveys)
    return DONE


def names_file(region: Path) -> bool:
    """Return whether a region is named as a file, there or not; else it is one of the site's."""
    return region.is_file() or region.suffix.lower() in REGION_SUFFIXES


async def _area(
    station: Station, region: str, rows: RowOptions, name: str | None
) -> dict[str, Any]:
    """Return the region of a file as rings, or the name of a region of the site."""
    path = Path(region)
    if not names_file(path):
        return {"region": region, "name": name}
    # Imported here: geometry takes longer to load than a pause may wait.
    from recon.cli.region_file import read_region

    site = await station.surveys.site_origin()
    if site is None or site.latitude_deg is None or site.longitude_deg is None:
        raise ClientError(NO_ORIGIN)
    origin = GeoPoint(site.latitude_deg, site.longitude_deg, site.ground_altitude_m or 0.0)
    own_name, rings = read_region(path, rows.feature, origin, close_paths=rows.close_paths)
    return {"polygon": rings, "name": name or own_name}


def _print_answer(answer: SurveyStatus | Refusal, as_json: bool) -> int:
    if as_json:
        print_json(msgspec.to_builtins(answer))
    elif isinstance(answer, Refusal):
        print_line(f"refused ({answer.rule}): {answer.reason}")
    else:
        print_line(_sentence(answer))
        _print_surveys([answer])
    return REFUSED if isinstance(answer, Refusal) else DONE


def _sentence(survey: SurveyStatus) -> str:
    """Return the survey's number, phase and name; later commands use the number."""
    number, phase = survey.id, PHASES.get(survey.phase, survey.phase)
    sentence = f"survey {number}: {phase}, {survey.name}"
    if survey.phase != "created":
        return sentence
    return f"{sentence}. Start it with `recon survey start {number} VEHICLE...`"


def _print_surveys(surveys: list[SurveyStatus]) -> None:
    rows = [
        (
            f"survey {s.id}",
            s.name,
            PHASES.get(s.phase, s.phase),
            f"{s.rows} rows",
            height_text(s.height_above_takeoff_m, s.height_above_ground_m),
            *_areas(s),
            s.reason,
        )
        for s in surveys
    ]
    columns = (
        *("number", "name", "phase", "rows", "height", "region"),
        *("not reached", "not yet", "light unknown", "in shade", "in sun", "reason"),
    )
    print_table("surveys", columns, rows)
    members = [
        (f"survey {survey.id}", v.vehicle_name, _activity(v))
        for survey in surveys
        for v in survey.vehicles
    ]
    if members:
        print_table("vehicles", ("survey", "vehicle", "activity"), members)


def _activity(vehicle: SurveyVehicle) -> str:
    """What it does for its survey; a reason against flying counts more than a mission not ended."""
    flies = "flying rows" if vehicle.is_flying_rows else None
    return vehicle.not_flying_reason or flies or vehicle.refused or "idle"


def _areas(survey: SurveyStatus) -> tuple[str, ...]:
    figures = survey.figures
    if figures is None:
        return "", "", "", "", "", ""
    areas = {
        "": figures.region_m2,
        "not reached ": figures.region_m2 - figures.reached_m2,
        "not yet ": figures.not_yet_m2,
        "light unknown ": figures.sun_unknown_m2,
        "in shade ": figures.in_shade_m2,
        "in sun ": figures.in_sun_m2,
    }
    return tuple(f"{what}{area_m2 / HECTARE_M2:.2f} ha" for what, area_m2 in areas.items())
