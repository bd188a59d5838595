"""The place of a scenario: a site's folder, or a generated site (fence, pads, lens and limits)."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import ceil, cos, hypot, radians, sin
from pathlib import Path

import numpy as np

from recon.camera import ImageCircle, TelemetryReference, mounted_pose
from recon.geo import enu_from_point, point_from_enu
from recon.model.airspace import FlightLimits, LandingPad, Region
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.survey import Survey
from recon.model.vehicle import AltitudeReference, Failsafe, VehicleProfile
from recon.score.scenario import EastNorth, ScenarioFleet, ScenarioImager
from recon.score.scenario_schema import (
    FleetTable,
    ScenarioErrors,
    ScenarioFile,
    ScenarioImagerTable,
)
from recon.sim.fleet import IMAGER_SERIAL
from recon.site import Imager, Site, SiteError, load_site
from recon.site.demo_site import (
    CENTRE_COL_PX,
    CENTRE_ROW_PX,
    IMAGE_CIRCLE_RADIUS_PX,
    demo_camera,
)
from recon.site.site import Layers

FENCE_OFF_M = 80.0
"""Around everything flown over: for turns, gusts and the margin to the fence."""
UPWIND_ROOM_M = 350.0
"""Around an imaging drone that moves upwind."""
BEYOND_HOME_M = 150.0
"""Past the farthest corner: the distance limit does not restrict a task."""
ABOVE_IMAGER_M = 10.0
USUAL_CEILING_M = 120.0
LOWEST_GO_HOME_M, GO_HOME_SPACING_M = 40.0, 8.0
"""The imaging drone's go-home height, and the spacing of the drones' heights above it; less for
large fleets."""
BELOW_CEILING_M = 5.0
IMAGER_PRIORITY = 10
"""In a conflict the imaging drone is held last: it observes the whole field."""
IMAGE_CELLS_PER_CELL = 4
"""Ground images are finer than shade maps by this."""


def generated_site(
    name: str,
    frame: LocalFrame,
    region: Region,
    fleet: ScenarioFleet,
    imager: ScenarioImager,
    photo_interval_s: float,
    *,
    moves_upwind: bool,
) -> Site:
    """Return a site on level ground, without obstacles, on which the task can be flown."""
    ceiling_m = max(USUAL_CEILING_M, imager.height_m + ABOVE_IMAGER_M)
    room_m = UPWIND_ROOM_M if moves_upwind else 0.0
    return Site(
        name=name,
        frame=frame,
        ground_grid=_grid(frame, imager),
        imagers={
            serial: _generated_imager(frame, imager, serial, over_m)
            for serial, over_m in imager.places_m.items()
        },
        profiles=_profiles(frame, fleet, imager, photo_interval_s, ceiling_m),
        layers=Layers(
            boundary=_boundary(
                [*region.outline_m.tolist(), *fleet.pads_m, *_hovered_m(imager, room_m)]
            ),
            landing_pads=_pads(frame, fleet, imager),
            survey_regions={name: region},
        ),
        limits=FlightLimits(
            max_height_above_ground_m=ceiling_m,
            max_distance_from_home_m=_farthest_m(fleet.pads_m, region) + BEYOND_HOME_M,
            battery_reserve_fraction=fleet.reserve_share,
        ),
    )


def _pads(
    frame: LocalFrame, fleet: ScenarioFleet, imager: ScenarioImager
) -> tuple[LandingPad, ...]:
    pads_m = {**dict(zip(fleet.serials, fleet.pads_m, strict=True)), **imager.places_m}
    return tuple(
        LandingPad(serial, serial, point_from_enu(frame, (*pad_m, 0.0)))
        for serial, pad_m in pads_m.items()
    )


def _hovered_m(imager: ScenarioImager, room_m: float) -> Iterable[EastNorth]:
    """Yield the corners of where imaging drones may hover; the first one moves so far."""
    east_m, north_m = imager.over_m
    yield (east_m - room_m, north_m - room_m)
    yield (east_m + room_m, north_m + room_m)
    yield from imager.also_over_m


def _boundary(places_m: Iterable[EastNorth | list[float]]) -> Region:
    places = np.array(list(places_m), dtype=np.float64)
    (west, south), (east, north) = places.min(axis=0), places.max(axis=0)
    off = FENCE_OFF_M
    corners = ((west, south), (east, south), (east, north), (west, north))
    outward = ((-off, -off), (off, -off), (off, off), (-off, off))
    return Region(np.array(corners) + np.array(outward))


def _farthest_m(pads_m: tuple[EastNorth, ...], region: Region) -> float:
    corners = region.outline_m.tolist()
    return max(hypot(east - e, north - n) for e, n in pads_m for east, north in corners)


def _grid(frame: LocalFrame, imager: ScenarioImager) -> GroundGrid:
    cell_m = imager.cell_m / IMAGE_CELLS_PER_CELL
    half_m = ceil((imager.reach_m or imager.radius_m) / cell_m) * cell_m
    west_m, north_m = imager.over_m[0] - half_m, imager.over_m[1] + half_m
    cells = round(2.0 * half_m / cell_m)
    return GroundGrid(frame, west_m, north_m, cell_m, cells, cells)


def _generated_imager(
    frame: LocalFrame, imager: ScenarioImager, serial: str, over_m: EastNorth
) -> Imager:
    """Return the demonstration's lens, with a pose that needs no fit."""
    beneath = point_from_enu(frame, (*over_m, 0.0))
    marked = TelemetryReference(beneath.latitude_deg, beneath.longitude_deg, imager.height_m, 0.0)
    camera = demo_camera()
    radius_px = IMAGE_CIRCLE_RADIUS_PX
    if imager.field_deg is not None:
        field = radians(imager.field_deg)
        (rim_px,) = camera.project(np.array([[sin(field), 0.0, cos(field)]]))
        radius_px = float(rim_px[0]) - CENTRE_COL_PX
    pose = mounted_pose(marked, np.array([*over_m, imager.height_m]), imager.tilt_deg)
    return Imager(
        serial=serial,
        camera=camera,
        marked_pose=pose,
        marked_frame=marked,
        image_circle=ImageCircle(CENTRE_COL_PX, CENTRE_ROW_PX, radius_px),
    )


def _profiles(
    frame: LocalFrame,
    fleet: ScenarioFleet,
    over: ScenarioImager,
    photo_interval_s: float,
    ceiling_m: float,
) -> dict[str, VehicleProfile]:
    room_m = ceiling_m - BELOW_CEILING_M - LOWEST_GO_HOME_M
    apart_m = min(GO_HOME_SPACING_M, room_m / len(fleet.serials))
    drones = {
        serial: VehicleProfile(
            serial,
            name=f"Drone {number + 1}",
            model="simulated",
            waypoint_altitude=AltitudeReference.TAKEOFF,
            pad=point_from_enu(frame, (*pad_m, 0.0)),
            endurance_s=fleet.endurance_s,
            go_home_height_m=LOWEST_GO_HOME_M + apart_m * (number + 1),
            failsafe=Failsafe.GO_HOME,
            camera_interval_s=photo_interval_s,
        )
        for number, (serial, pad_m) in enumerate(zip(fleet.serials, fleet.pads_m, strict=True))
    }
    imagers = {
        serial: VehicleProfile(
            serial,
            name=f"Imager {number}" if over.also_over_m else "Imager",
            model="simulated",
            waypoint_altitude=AltitudeReference.TAKEOFF,
            pad=point_from_enu(frame, (*over_m, 0.0)),
            endurance_s=fleet.endurance_s,
            go_home_height_m=LOWEST_GO_HOME_M,
            failsafe=Failsafe.GO_HOME,
            priority=IMAGER_PRIORITY,
        )
        for number, (serial, over_m) in enumerate(over.places_m.items(), 1)
    }
    return {**drones, **imagers}


PADS_APART_M = 20.0
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
        return _on_folder(path.parent / table.folder, file, errors)
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
    return Staged(site, frame, fleet, imager)


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
    return Staged(site, frame, fleet, imager)


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
        pads_m, 60.0 * table.endurance_min, table.reserve_share, 60.0 * table.swap_min
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
