"""Where a scenario is played: its site, who stands where, and what the eye hovers over."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from recon.geo import enu_from_point
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.survey import Survey
from recon.model.zone import Region
from recon.score.scenario import Fleet, Place, ScenarioImager
from recon.score.scenario_schema import FleetTable, ImagerTable, ScenarioFile
from recon.score.scenario_site import made_up_site
from recon.score.validation_errors import Complaints
from recon.sim.fleet import IMAGER_SERIAL
from recon.site import Site, SiteError, load_site

PADS_APART_M = 20.0
PADS_OFF_M = 30.0
"""South of the region."""
USUAL_IMAGER_HEIGHT_M = 120.0


@dataclass(frozen=True, slots=True)
class Staged:
    """A site with its frame, the fleet and the eye on it."""

    site: Site
    frame: LocalFrame
    fleet: Fleet
    imager: ScenarioImager


def staged(path: Path, file: ScenarioFile, survey: Survey, complain: Complaints) -> Staged:
    """Return where a scenario is played: on a site's folder, or on a site made up around it.

    Raises `ScenarioError`.
    """
    table = file.site
    if table.folder is not None:
        return _on_folder(path.parent / table.folder, file, complain)
    latitude, longitude, altitude = (
        table.latitude_deg,
        table.longitude_deg,
        table.ground_altitude_m,
    )
    if latitude is None or longitude is None or altitude is None:
        wanted = "expected a folder, or latitude_deg, longitude_deg and ground_altitude_m"
        raise complain.about(f"{wanted}, got neither whole", "site")
    frame = LocalFrame(GeoPoint(latitude, longitude, altitude))
    fleet = _fleet(file.fleet, _pads_m(file.fleet, survey.region, complain))
    imager = _imager(file.imager, _middle_m(survey.region))
    site = made_up_site(survey.name, frame, survey.region, fleet, imager, survey.camera.interval_s)
    return Staged(site, frame, fleet, imager)


def _on_folder(folder: Path, file: ScenarioFile, complain: Complaints) -> Staged:
    table = file.site
    told = (table.latitude_deg, table.longitude_deg, table.ground_altitude_m)
    if any(each is not None for each in told):
        raise complain.about("expected a folder alone, got an origin too", "site")
    for key, value in (("over_m", file.imager.over_m), ("height_m", file.imager.height_m)):
        if value is not None:
            raise complain.about(
                f"{key}: expected none, for the site says where, got one", "imager"
            )
    if file.fleet.pads_m is not None:
        raise complain.about("pads_m: expected none, for the site has pads, got some", "fleet")
    try:
        site = load_site(folder)
    except SiteError as problem:
        raise complain.about(f"folder: expected a site's folder, got: {problem}", "site") from None
    frame = site.frame
    if frame is None or site.imager is None or site.imager.serial != IMAGER_SERIAL:
        said = f"folder: expected a site with an eye of the serial {IMAGER_SERIAL}, got none"
        raise complain.about(said, "site")
    fleet = _fleet(file.fleet, _site_pads_m(site, frame, file.fleet, complain))
    east_m, north_m, up_m = site.imager.solution.pose.position_enu_m.tolist()
    imager = _imager(file.imager, (east_m, north_m), up_m)
    return Staged(site, frame, fleet, imager)


def _site_pads_m(
    site: Site, frame: LocalFrame, table: FleetTable, complain: Complaints
) -> tuple[Place, ...]:
    serials = [f"SIM-{number + 1}" for number in range(table.survey_drones)]
    pads = []
    for serial in serials:
        profile = site.profiles.get(serial)
        if profile is None or profile.pad is None:
            said = f"survey_drones: expected no more than have pads on the site, got no {serial}"
            raise complain.about(said, "fleet")
        east_m, north_m = enu_from_point(frame, profile.pad)[:2].tolist()
        pads.append((east_m, north_m))
    return tuple(pads)


def _pads_m(table: FleetTable, region: Region, complain: Complaints) -> tuple[Place, ...]:
    """The pads that are told, or a line of them south of the region."""
    if table.pads_m is None:
        middle_m = float(region.outline_m[:, 0].mean())
        south_m = float(region.outline_m[:, 1].min()) - PADS_OFF_M
        first_m = middle_m - PADS_APART_M * (table.survey_drones - 1) / 2.0
        return tuple((first_m + PADS_APART_M * i, south_m) for i in range(table.survey_drones))
    if len(table.pads_m) != table.survey_drones:
        said = f"expected {table.survey_drones} places, one a drone, got {len(table.pads_m)}"
        raise complain.about(f"pads_m: {said}", "fleet")
    return tuple((east_m, north_m) for east_m, north_m in table.pads_m)


def _fleet(table: FleetTable, pads_m: tuple[Place, ...]) -> Fleet:
    return Fleet(pads_m, 60.0 * table.endurance_min, table.reserve_share, 60.0 * table.swap_min)


def _middle_m(region: Region) -> Place:
    least, most = region.outline_m.min(axis=0), region.outline_m.max(axis=0)
    east_m, north_m = np.asarray((least + most) / 2.0).tolist()
    return (east_m, north_m)


def _imager(
    table: ImagerTable, beneath_m: Place, height_m: float = USUAL_IMAGER_HEIGHT_M
) -> ScenarioImager:
    over_m = beneath_m if table.over_m is None else (table.over_m[0], table.over_m[1])
    told_m = height_m if table.height_m is None else table.height_m
    return ScenarioImager(over_m, told_m, table.radius_m, float(table.period_s), table.cell_m)
