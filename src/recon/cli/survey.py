"""`recon survey`: a region cut into rows, flown by vehicles that guidance controls."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import msgspec
import typer

from recon.cli.commands import App
from recon.cli.connection import JsonOption, NamesArgument, named_serials, station_command
from recon.cli.exit_codes import DONE, REFUSED
from recon.cli.output import print_json, print_line, print_table
from recon.cli.survey_again import print_flown_regions, region_asked, since_day
from recon.cli.survey_output import print_answer, print_surveys
from recon.client import ClientError, Refusal, Station
from recon.model.geo import GeoPoint
from recon.model.survey import PLANNER_GOALS, RowChoice, WhenDone, unknown_survey

REGION_SUFFIXES = (
    *(".geojson", ".json", ".kml", ".kmz", ".zip", ".gpkg", ".gpx", ".xml", ".plan"),
)
NO_ORIGIN = "the station's site has no origin: start the station with --site FOLDER"

survey_app = App(
    help="Survey a region: create, resume, estimate, start, pause, abort, status.",
    no_args_is_help=True,
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
    choice: Annotated[
        RowChoice,
        typer.Option(
            "--rows",
            help="Of a site's region: those of last time if nothing differs (auto), those whatever "
            "differs (as_before), or new ones.",
        ),
    ] = RowChoice.AUTO


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
            "rows": rows.choice.value,
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
    return print_answer(answer, as_json)


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
    return print_answer(await station.surveys.start(number, serials, takeoff=takeoff), as_json)


@survey_app.command("resume")
@station_command
async def resume_command(
    station: Station,
    region: Annotated[
        str, typer.Argument(metavar="REGION", help="Name of a region, or id of `survey flown`.")
    ],
    vehicles: NamesArgument = None,
    since: Annotated[
        str | None,
        typer.Option(
            "--since",
            help="Skip what was imaged from this day on: 2026-05-01, or today. Default: since "
            "the survey was begun.",
        ),
    ] = None,
    all_again: Annotated[bool, typer.Option("--all", help="Leave nothing out.")] = False,
    gaps: Annotated[
        bool, typer.Option("--gaps", help="Only the gaps of the photos that the station tagged.")
    ] = False,
    takeoff: Annotated[
        bool, typer.Option("--takeoff", help="Allow takeoff for this start.")
    ] = False,
    as_json: JsonOption = False,
) -> int:
    """Fly the rest of a region, on the same rows.

    After an abort, a restart of the station, or on another day. With vehicles it starts; without,
    it is only planned.
    """
    known = await station.surveys.flown_regions()
    asked, day = region_asked(known, region), since_day(known, since)
    serials = named_serials(station, vehicles) if vehicles else []
    answer = await station.surveys.again(asked.id, since=day, all_again=all_again, gaps=gaps)
    if serials and not isinstance(answer, Refusal):
        answer = await station.surveys.start(answer.id, serials, takeoff=takeoff)
    return print_answer(answer, as_json)


@survey_app.command("flown")
@station_command
async def flown_command(station: Station, as_json: JsonOption = False) -> int:
    """Show the regions that were surveyed, on which days, and how much is left."""
    known = await station.surveys.flown_regions()
    if as_json:
        print_json(msgspec.to_builtins(known))
    else:
        print_flown_regions(known)
    return DONE


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
    return print_answer(await station.surveys.pause(number), as_json)


@survey_app.command("abort")
@station_command
async def abort_command(
    station: Station, number: NumberArgument, as_json: JsonOption = False
) -> int:
    """End a survey; `resume` plans what is left of it anew.

    Its vehicles hold position, under operator control.
    """
    return print_answer(await station.surveys.abort(number), as_json)


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
        print_surveys(surveys)
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
