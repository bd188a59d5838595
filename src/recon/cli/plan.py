"""`recon plan`: what a survey will take, before any station, drone or battery is needed."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from math import isfinite, nan
from pathlib import Path
from typing import Annotated, Any

import typer

from recon.cli.connection import JsonOption
from recon.cli.exit_codes import REFUSED
from recon.cli.opened_site import opened_site
from recon.cli.options import with_options
from recon.cli.output import print_json, print_table, print_warning
from recon.cli.plan_export import ExportedFiles, PlanExportOptions, export_plans, rows_of_exports
from recon.cli.plan_output import ImagingFigures, figures_of, geojson_of, plan_rows_of
from recon.cli.plan_picture import Theme, picture_png
from recon.cli.region_file import region_in
from recon.cli.survey import RowOptions, names_file
from recon.geo import enu_from_points
from recon.guidance.survey import Surveyor, SurveyPlan, plan_survey, surroundings_of
from recon.guidance.survey.again import with_rows
from recon.guidance.survey.estimate import Batteries, SurveyEstimate, corner_of, estimate
from recon.guidance.survey.imaging import (
    SpeedLimit,
    best_interval_s,
    height_for_gsd_m,
    speed_limits,
)
from recon.guidance.survey.plan import SLOWEST_MPS, survey_fault
from recon.guidance.survey.terrain import ground_up_m
from recon.model.airspace import Region
from recon.model.command import Refusal
from recon.model.errors import ReconError
from recon.model.geo import LocalFrame
from recon.model.survey import RowChoice, Survey
from recon.model.survey_camera import CAMERAS, CameraModel, camera_named
from recon.model.vehicle import VehicleProfile
from recon.record.files.flown_region_file import day_of, read_regions
from recon.safety.energy import Consumption, profile_consumption
from recon.safety.settings import EnergySettings
from recon.site import Site
from recon.site.reading import FLOWN_FOLDER
from recon.site.site import default_site
from recon.site.survey_cameras import read_cameras_file

MOST_DRONES = 16
ENDURANCE_MIN = 25.0
SPEED_STEP_MPS = 0.1


NO_ELEVATION = (
    "--above-ground needs the ground's heights: name a site by --site whose site.toml has an "
    "elevation model under [elevation], or leave --above-ground out for heights above takeoff"
)


class PlanError(ReconError):
    """Options that make no plan; one sentence."""


class RefusedPlanError(PlanError):
    """A survey that cannot be flown: the region, or the numbers."""

    is_failure = True


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanOptions:
    """What is planned, for which drones, and what is written of it."""

    region: Annotated[
        str | None,
        typer.Argument(
            metavar="REGION",
            help="GeoJSON, KML, KMZ, Shapefile (zip) or GeoPackage file, or the name of a survey "
            "region of --site.",
        ),
    ] = None
    camera: Annotated[
        str, typer.Option("--camera", help="Name of a camera; `list` prints them.")
    ] = "mavic3m"
    gsd: Annotated[
        str | None, typer.Option("--gsd", help="Size of a pixel on the ground, such as 2cm.")
    ] = None
    height: Annotated[
        float | None, typer.Option("--height", help="Metres above takeoff, instead of --gsd.")
    ] = None
    drones: Annotated[
        int, typer.Option("--drones", min=1, max=MOST_DRONES, help="How many fly.")
    ] = 1
    speed: Annotated[
        float | None, typer.Option("--speed", help="Metres per second; default: the most allowed.")
    ] = None
    interval: Annotated[
        float | None,
        typer.Option("--interval", help="Seconds between photos; default: the timer's best."),
    ] = None
    exposure: Annotated[
        str, typer.Option("--exposure", help="Of a photo, such as 1/1000, for the blur.")
    ] = "1/1000"
    site: Annotated[
        Path | None,
        typer.Option("--site", help="A site's folder: boundary, zones, pads, limits, cameras."),
    ] = None
    endurance: Annotated[
        float | None,
        typer.Option(
            "--endurance-min",
            min=1.0,
            max=240.0,
            help=f"Hover time of a full battery; default: the site's, else {ENDURANCE_MIN:g}.",
        ),
    ] = None
    batteries: Annotated[
        int | None, typer.Option("--batteries", min=1, help="Full batteries available.")
    ] = None
    cameras: Annotated[
        Path | None,
        typer.Option("--cameras", help="Your own cameras, as in a site's cameras.toml."),
    ] = None
    hourly: Annotated[
        float | None,
        typer.Option("--cost-per-hour", min=0.0, help="Of one drone in the air, any currency."),
    ] = None
    png: Annotated[Path | None, typer.Option("--png", help="Picture to write.")] = None
    theme: Annotated[Theme, typer.Option("--theme", help="Of the picture.")] = Theme.LIGHT
    geojson: Annotated[Path | None, typer.Option("--geojson", help="Rows and flights.")] = None
    as_json: JsonOption = False


@with_options
def plan_command(options: PlanOptions, rows: RowOptions, export: PlanExportOptions) -> None:
    """Plan a survey without a station: rows, speed, time, photos, batteries.

    Nothing flies and nothing is sent. `--export` writes the flights for other programs.
    """
    home = default_site() if options.site is None else opened_site(options.site)
    own = {} if options.cameras is None else read_cameras_file(options.cameras)
    cameras = {**home.cameras, **own}
    if options.camera == "list":
        _print_cameras({**CAMERAS, **cameras})
        return
    warnings = _plan_at(home, cameras, options, rows, export)
    if warnings:
        raise typer.Exit(REFUSED)


def _plan_at(
    home: Site,
    cameras: Mapping[str, CameraModel],
    options: PlanOptions,
    rows: RowOptions,
    export: PlanExportOptions,
) -> Sequence[str]:
    """Print and write the plan of a survey at a site; return its warnings."""
    if options.region is None:
        raise PlanError("name a region: a file, or a survey region of --site")
    _refuse_same_file(
        {
            "the region": Path(options.region),
            "--png": options.png,
            "--geojson": options.geojson,
            **{f"--export {n}": path for n, path in enumerate(export.paths, start=1)},
        }
    )
    model = camera_named(options.camera, cameras.values())
    name, area, frame = _region(options.region, rows, home)
    draft = _draft(name, area, home, model, options, rows)
    if options.site is not None and options.region in home.layers.survey_regions:
        draft = _on_kept_rows(replace(draft, region_name=name), frame, options.site, rows.choice)
    imaging = _imaging(draft, model, options.interval, _exposure_s(options.exposure), home)
    plan = _plan(draft, imaging, options.speed, frame, home)
    fleet = _fleet(plan, home, options.drones)
    needs, uses = _needs(plan, home, fleet, options.endurance)
    figures = figures_of(plan, fleet, needs, imaging, uses.endurance_s, options.hourly)
    figures["warnings"] += _too_few(needs.batteries, options.batteries)
    exports = export_plans(plan, needs, fleet, export)
    figures["exports"] = [asdict(each) for each in exports]
    if options.as_json:
        print_json(figures)
    else:
        print_table(f"plan of {name}", ("what", "value"), _table(figures, exports))
    if options.png is not None:
        around = None if home.frame is None else surroundings_of(home.airspace)
        picture = picture_png(plan, needs, fleet, around, figures["title"], options.theme)
        _write(options.png, picture)
    if options.geojson is not None:
        _write(options.geojson, geojson_of(plan, needs))
    warnings: Sequence[str] = figures["warnings"]
    return warnings


def _table(figures: dict[str, Any], exports: Sequence[ExportedFiles]) -> list[tuple[str, str]]:
    note: str = figures["rows_note"]
    noted = [("rows' origin", note)] if note else []
    return [*plan_rows_of(figures), *noted, *rows_of_exports(exports)]


def _draft(
    name: str,
    area: Region,
    home: Site,
    model: CameraModel,
    options: PlanOptions,
    rows: RowOptions,
) -> Survey:
    """Return the survey before the speed and the interval of its photos are known."""
    interval_s = model.timer_s[0] if options.interval is None else options.interval
    lens, height_m = model.at_interval(interval_s), _height_m(model, options.gsd, options.height)
    overlaps = rows.front, rows.side
    draft = Survey(1, name, area, height_m, SLOWEST_MPS, lens, *overlaps, rows.bearing)
    if not rows.above_ground:
        return draft
    if home.airspace.elevation is None:
        raise PlanError(NO_ELEVATION)
    return replace(draft, height_above_takeoff_m=None, height_above_ground_m=height_m)


def _on_kept_rows(draft: Survey, frame: LocalFrame, site: Path, choice: RowChoice) -> Survey:
    """Return a survey of a site's region with the rows that are kept of it, if they are wanted."""
    known, troubles = read_regions(site / FLOWN_FOLDER)
    for trouble in troubles:
        print_warning(trouble)
    found = with_rows(draft, frame, known, choice, day_of)
    if isinstance(found, Refusal):
        raise RefusedPlanError(f"refused: {found.reason}")
    return found


def _region(name: str, rows: RowOptions, site: Site) -> tuple[str, Region, LocalFrame]:
    """Return a file's region, or the site's of that name, in the site's frame or its own."""
    path = Path(name)
    if site.frame is not None and name in site.layers.survey_regions:
        return name, site.layers.survey_regions[name], site.frame
    if not names_file(path):
        known = ", ".join(site.layers.survey_regions) or "none; name a site with --site"
        raise PlanError(f"Survey region {name!a} not found, nor a file; available: {known}")
    return region_in(path, rows.feature, site.frame, close_paths=rows.close_paths)


def _imaging(
    draft: Survey, model: CameraModel, interval_s: float | None, exposure_s: float, site: Site
) -> ImagingFigures:
    """Return the timer's interval, the best one unless given, and what limits the speed.

    Both are calculated from the survey's other numbers: these are checked first.
    """
    fault = survey_fault(draft)
    if fault is not None:
        raise RefusedPlanError(f"refused: {fault}")
    known = (draft.height_m, draft.front_overlap, exposure_s)
    fastest_mps, stops = site.limits.max_speed_mps, draft.is_above_ground
    wrong = None if interval_s is None else model.interval_fault(interval_s)
    if wrong is not None:
        raise RefusedPlanError(f"refused: {wrong}")
    if interval_s is None:
        interval_s = best_interval_s(model, *known, fastest_mps, stops_in_rows=stops)
    lens = model.at_interval(interval_s)
    limits = speed_limits(lens, *known, fastest_mps, stops_in_rows=stops)
    return ImagingFigures(model, lens, limits, exposure_s)


def _plan(
    draft: Survey, imaging: ImagingFigures, speed_mps: float | None, frame: LocalFrame, site: Site
) -> SurveyPlan:
    """Return the rows of a survey at a speed, the most that is allowed unless given."""
    speed_mps = _most_mps(imaging.limits[0]) if speed_mps is None else speed_mps
    surroundings = None if site.frame is None else surroundings_of(site.airspace)
    survey = replace(draft, speed_mps=speed_mps, camera=imaging.lens)
    plan = plan_survey(survey, frame, surroundings)
    if isinstance(plan, Refusal):
        raise RefusedPlanError(f"refused: {plan.reason}")
    return plan


def _most_mps(limit: SpeedLimit) -> float:
    """Return the most that a limit allows, rounded down to a tenth."""
    if limit.speed_mps < SLOWEST_MPS:
        raise RefusedPlanError(
            f"refused: the speed limit is {limit.speed_mps:.2g} m/s ({limit.reason}), and "
            f"{SLOWEST_MPS:g} m/s is the least: expose shorter or fly higher"
        )
    return int(limit.speed_mps / SPEED_STEP_MPS + 1e-9) * SPEED_STEP_MPS


def _refuse_same_file(files: dict[str, Path | None]) -> None:
    """A picture or rows written over the field's boundary would destroy it."""
    named: dict[Path, str] = {}
    for name, path in files.items():
        if path is None:
            continue
        other = named.setdefault(path.resolve(), name)
        if other != name:
            raise PlanError(f"{name}: expected a file of its own, got that of {other}: {path}")


def _height_m(model: CameraModel, gsd: str | None, height_m: float | None) -> float:
    if (gsd is None) == (height_m is None):
        raise PlanError("give either --gsd, such as 2cm, or --height in metres")
    if height_m is not None:
        return height_m
    found = height_for_gsd_m(model.at_interval(1.0), _gsd_m(gsd or ""))
    assert found is not None  # every model has pixels
    return round(found, 1)


UNITS_M = {"mm": 0.001, "cm": 0.01, "m": 1.0}


def _gsd_m(text: str) -> float:
    found = re.fullmatch(r"(\d{1,6}(?:\.\d{1,6})?) ?(mm|cm|m)", text.strip())
    gsd_m = float(found[1]) * UNITS_M[found[2]] if found else 0.0
    if not 0.0005 <= gsd_m <= 5.0:
        raise PlanError(f"--gsd: expected 0.5 mm to 5 m with its unit, such as 2cm, got {text!a}")
    return gsd_m


def _exposure_s(text: str) -> float:
    found = re.fullmatch(r"(?:1/)?(\d{1,6}(?:\.\d{1,6})?)", text.strip())
    value = float(found[1]) if found else 0.0
    if value > 0.0 and text.strip().startswith("1/"):
        value = 1.0 / value
    if not 1e-5 <= value <= 1.0:
        raise PlanError(f"--exposure: expected 1/100000 to 1 s, such as 1/1000, got {text!a}")
    return value


def _fleet(plan: SurveyPlan, site: Site, drones: int) -> list[Surveyor]:
    """Return drones on their pads; without pads all take off at the region's south-west corner."""
    pads_m = takeoff_points_m(site)[:drones]
    east_m, north_m = corner_of(plan)
    elevation = site.airspace.elevation
    ground_m = nan if elevation is None else ground_up_m(elevation, [(east_m, north_m)])[0]
    points_m = (*pads_m, *([(east_m, north_m, float(ground_m))] * (drones - len(pads_m))))
    return [
        Surveyor(
            f"drone {number}",
            (east_m, north_m),
            home_m=(east_m, north_m),
            takeoff_up_m=up_m if isfinite(up_m) else None,
        )
        for number, (east_m, north_m, up_m) in enumerate(points_m, start=1)
    ]


def _needs(
    plan: SurveyPlan, site: Site, drones: Sequence[Surveyor], endurance_min: float | None
) -> tuple[SurveyEstimate, Consumption]:
    """Return the estimate of drones that begin with full batteries where they are."""
    height_m = plan.survey.height_m
    uses = least_enduring(site, endurance_min, height_m)
    level_s = uses.level_flight_s(1.0, height_m, site.limits.battery_reserve_fraction)
    fleet = [replace(drone, time_left_s=level_s) for drone in drones]
    made = estimate(plan, fleet, Batteries(level_s, landing_s=uses.settings.landing_s(height_m)))
    if isinstance(made, Refusal):
        raise RefusedPlanError(f"refused: {made.reason}")
    return made, uses


def _too_few(needed: int | None, there: int | None) -> list[str]:
    if needed is None or there is None or needed <= there:
        return []
    return [
        f"{needed} full batteries are needed, {there} are there: fly higher, overlap less, divide "
        "the region, or charge between flights"
    ]


def takeoff_points_m(site: Site) -> tuple[tuple[float, float, float], ...]:
    """Return the pads of a site's drones but the imaging ones, east, north and up in metres."""
    if site.frame is None:
        return ()
    pads = [
        profile.pad
        for serial, profile in site.profiles.items()
        if profile.pad is not None and serial not in site.imagers
    ]
    origin_m = site.frame.origin.ellipsoid_height_m
    enu_m = enu_from_points(site.frame, pads).tolist()
    return tuple(
        (east_m, north_m, pad.ellipsoid_height_m - origin_m)
        for (east_m, north_m, _), pad in zip(enu_m, pads, strict=True)
    )


def least_enduring(site: Site, endurance_min: float | None, height_m: float) -> Consumption:
    """Return what the drone uses whose full battery lasts the shortest at a height, in some wind.

    A drone of unknown endurance is taken to have `ENDURANCE_MIN`.
    """
    settings = EnergySettings()

    def uses(profile: VehicleProfile) -> Consumption:
        unless_given_s = profile.endurance_s or 60.0 * ENDURANCE_MIN
        endurance_s = unless_given_s if endurance_min is None else 60.0 * endurance_min
        known = replace(profile, endurance_s=endurance_s)
        found = profile_consumption(known, site.limits, settings.unknown_wind_load, settings)
        assert found is not None  # its endurance is known
        return found

    flying = [p for serial, p in site.profiles.items() if serial not in site.imagers]
    reserve = site.limits.battery_reserve_fraction
    return min(
        map(uses, flying or [VehicleProfile("")]),
        key=lambda each: each.level_flight_s(1.0, height_m, reserve),
    )


def _print_cameras(cameras: Mapping[str, CameraModel]) -> None:
    rows = [
        (
            model.key,
            model.title,
            f"{model.across_px} x {model.along_px}",
            f"{model.across_deg:.1f} x {model.along_deg:.1f} deg",
            f"{model.timer_s[0]:g} s",
            model.shutter,
            model.source,
        )
        for model in cameras.values()
    ]
    columns = ("name", "camera", "pixels", "field of view", "shortest timer", "shutter", "source")
    print_table("cameras", columns, rows)


def _write(path: Path, data: bytes) -> None:
    try:
        path.write_bytes(data)
    except OSError as problem:
        raise PlanError(f"{path}: cannot be written: {problem.strerror or problem}") from problem
