"""A site generated around a task: fence, pads, lens and limits."""

from collections.abc import Iterable
from functools import cache
from math import ceil, cos, hypot, radians, sin

import numpy as np

from recon.camera import (
    ImageCircle,
    OmnidirectionalCamera,
    TelemetryReference,
    load_camera,
    mounted_pose,
)
from recon.geo import point_from_enu
from recon.model.airspace import FlightLimits, LandingPad, Region
from recon.model.geo import GroundGrid, LocalFrame
from recon.model.vehicle import AltitudeReference, Failsafe, VehicleProfile
from recon.score.scenario import EastNorth, ScenarioFleet, ScenarioImager
from recon.site import Imager, Site, demo_site_folder
from recon.site.site import Layers

FENCE_OFF_M = 80.0
"""Margin around everything flown over: for turns, gusts and the margin to the fence."""
UPWIND_ROOM_M = 350.0
"""Room around an imaging drone that moves upwind."""
BEYOND_HOME_M = 150.0
"""Distance past the farthest corner: the distance limit does not restrict a task."""
ABOVE_IMAGER_M = 10.0
USUAL_CEILING_M = 120.0
LOWEST_GO_HOME_M, GO_HOME_SPACING_M = 40.0, 8.0
"""The imaging drone's go-home height, and the spacing of the drones' heights above it; less for
large fleets."""
BELOW_CEILING_M = 5.0
IMAGER_PRIORITY = 10
"""Priority that holds the imaging drone last in a conflict: it observes the whole field."""
IMAGE_CIRCLE_RADIUS_PX = 274.1
"""Radius for the demonstration's lens, as its site.toml states it."""
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
    """Yield the corners of where imaging drones may hover; the first one moves `room_m`."""
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
    camera = _demo_camera()
    radius_px = IMAGE_CIRCLE_RADIUS_PX
    if imager.field_deg is not None:
        field = radians(imager.field_deg)
        (rim_px,) = camera.project(np.array([[sin(field), 0.0, cos(field)]]))
        radius_px = float(rim_px[0]) - camera.centre_col_px
    pose = mounted_pose(marked, np.array([*over_m, imager.height_m]), imager.tilt_deg)
    return Imager(
        serial=serial,
        camera=camera,
        marked_pose=pose,
        marked_frame=marked,
        image_circle=ImageCircle(camera.centre_col_px, camera.centre_row_px, radius_px),
    )


@cache
def _demo_camera() -> OmnidirectionalCamera:
    return load_camera(demo_site_folder() / "camera-model.txt")


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
