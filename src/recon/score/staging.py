"""The place of a scenario: a site's folder, or a site generated around its task."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from recon.geo import enu_from_point
from recon.model.airspace import Region
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.survey import Survey
from recon.score.generated_site import generated_site
from recon.score.scenario import EastNorth, ScenarioFleet, ScenarioImager
from recon.score.scenario_schema import (
    FleetTable,
    ScenarioErrors,
    ScenarioFile,
    ScenarioImagerTable,
)
from recon.sim.fleet import IMAGER_SERIAL
from recon.site import Site, SiteError, demo_site_folder, load_site

DEMO_SITE = "recon:demo"
"""The demonstration's site, which is inside the package."""
PADS_APART_M = 25.0
PADS_OFF_M = 30.0
"""South of the region."""
USUAL_IMAGER_HEIGHT_M = 120.0


@dataclass(frozen=True, slots=True)
class Staged:
    """A site with its frame, fleet and imaging drone."""

    site: Site
    frame: LocalFrame
    fleet: ScenarioFleet
    imager: ScenarioImager


def staged(path: Path, file: ScenarioFile, survey: Survey, errors: ScenarioErrors) -> Staged:
    """Return the place of a scenario: a site's folder, or a site generated around the task.

    Raises `ScenarioError`.
    """
    table = file.site
    if table.folder is not None:
        return _on_folder(site_folder(path, table.folder), file, errors)
    latitude, longitude, altitude = (
        table.latitude_deg,
        table.longitude_deg,
        table.ground_altitude_m,
    )
    if latitude is None or longitude is None or altitude is None:
        wanted = "expected a folder, or latitude_deg, longitude_deg and ground_altitude_m"
        raise errors.error(f"{wanted}, got an incomplete origin", "site")
    frame = LocalFrame(GeoPoint(latitude, longitude, altitude))
    fleet = _fleet(file.fleet, _pads_m(file.fleet, survey.region, errors))
    imager = _imager(file.imager, _middle_m(survey.region))
    site = generated_site(
        survey.name,
        frame,
        survey.region,
        fleet,
        imager,
        survey.camera.interval_s,
        moves_upwind=imager.is_upwind or survey.upwind_allowed,
    )
    return Staged(_with_abilities(site, fleet), frame, fleet, imager)


def site_folder(path: Path, named: str) -> Path:
    """Return the site's folder that a scenario file names: the demonstration's, or one by its path
    from the file."""
    return demo_site_folder() if named == DEMO_SITE else path.parent / named


def _on_folder(folder: Path, file: ScenarioFile, errors: ScenarioErrors) -> Staged:
    table = file.site
    origin = (table.latitude_deg, table.longitude_deg, table.ground_altitude_m)
    if any(each is not None for each in origin):
        raise errors.error("expected a folder or an origin, got both", "site")
    for key in ("over_m", "also_over_m", "height_m", "field_deg", "tilt_deg", "reach_m"):
        if getattr(file.imager, key) not in (None, []):
            raise errors.error(f"{key}: expected only without a folder", "imager")
    if file.fleet.pads_m is not None:
        raise errors.error("pads_m: expected only without a folder", "fleet")
    try:
        site = load_site(folder)
    except SiteError as problem:
        raise errors.error(f"folder: expected a site that loads, got: {problem}", "site") from None
    frame = site.frame
    only = site.imager
    if frame is None or only is None or list(site.imagers) != [IMAGER_SERIAL]:
        got = ", ".join(site.imagers) or "none"
        text = f"folder: expected a site with the one imaging drone {IMAGER_SERIAL}, got {got}"
        raise errors.error(text, "site")
    fleet = _fleet(file.fleet, _site_pads_m(site, frame, file.fleet, errors))
    east_m, north_m, up_m = only.marked_pose.position_enu_m.tolist()
    imager = _imager(file.imager, (east_m, north_m), up_m)
    return Staged(_with_abilities(site, fleet), frame, fleet, imager)


def _with_abilities(site: Site, fleet: ScenarioFleet) -> Site:
    """Return the site with survey drones that take missions, or none."""
    if fleet.takes_missions:
        return site
    drones = {s: replace(site.profiles[s], max_waypoints=0) for s in fleet.serials}
    return replace(site, profiles={**site.profiles, **drones})


def _site_pads_m(
    site: Site, frame: LocalFrame, table: FleetTable, errors: ScenarioErrors
) -> tuple[EastNorth, ...]:
    serials = [f"SIM-{number + 1}" for number in range(table.survey_drones)]
    pads = []
    for serial in serials:
        profile = site.profiles.get(serial)
        if profile is None or profile.pad is None:
            text = f"survey_drones: expected a pad on the site for each, got none for {serial}"
            raise errors.error(text, "fleet")
        east_m, north_m = enu_from_point(frame, profile.pad)[:2].tolist()
        pads.append((east_m, north_m))
    return tuple(pads)


def _pads_m(table: FleetTable, region: Region, errors: ScenarioErrors) -> tuple[EastNorth, ...]:
    """Return the file's pads, or a line of pads south of the region."""
    if table.pads_m is None:
        middle_m = float(region.outline_m[:, 0].mean())
        south_m = float(region.outline_m[:, 1].min()) - PADS_OFF_M
        first_m = middle_m - PADS_APART_M * (table.survey_drones - 1) / 2.0
        return tuple((first_m + PADS_APART_M * i, south_m) for i in range(table.survey_drones))
    if len(table.pads_m) != table.survey_drones:
        text = f"expected {table.survey_drones} positions, one per drone, got {len(table.pads_m)}"
        raise errors.error(f"pads_m: {text}", "fleet")
    return tuple((east_m, north_m) for east_m, north_m in table.pads_m)


def _fleet(table: FleetTable, pads_m: tuple[EastNorth, ...]) -> ScenarioFleet:
    return ScenarioFleet(
        pads_m,
        60.0 * table.endurance_min,
        table.reserve_share,
        60.0 * table.swap_min,
        table.kept_share,
        table.takes_missions,
    )


def _middle_m(region: Region) -> EastNorth:
    least, most = region.outline_m.min(axis=0), region.outline_m.max(axis=0)
    east_m, north_m = np.asarray((least + most) / 2.0).tolist()
    return (east_m, north_m)


def _imager(
    table: ScenarioImagerTable, beneath_m: EastNorth, height_m: float = USUAL_IMAGER_HEIGHT_M
) -> ScenarioImager:
    over_m = beneath_m if table.over_m is None else (table.over_m[0], table.over_m[1])
    over_ground_m = height_m if table.height_m is None else table.height_m
    return ScenarioImager(
        over_m,
        over_ground_m,
        table.radius_m,
        table.cell_m,
        table.field_deg,
        table.tilt_deg or 0.0,
        table.reach_m,
        table.coarsest_m,
        table.upwind,
        tuple((east_m, north_m) for east_m, north_m in table.also_over_m),
    )
