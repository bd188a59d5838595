"""What is known of an imaging drone and the shade over a region, to propose a place upwind by."""

from collections.abc import Sequence

from recon.camera.sight import COARSEST_M, farthest_sight_m
from recon.guidance.upwind_place import GroundView
from recon.guidance.upwind_proposal import UpwindProposal, UpwindQuestion, propose
from recon.model.airspace import Region, ZoneKind
from recon.model.imagery import Outlook
from recon.model.units import ns_to_seconds
from recon.station.imaging.at_work import imagers_at_work
from recon.station.state.station import Station
from recon.station.steering.kinematic_state import kinematic_state, refusal_without_telemetry

OLDEST_FORECAST_S = 60.0
LEAST_HEIGHT_M = 10.0
"""Least height: below it the camera sees no field from anywhere."""


def proposed(
    station: Station, regions: Sequence[Region], serial: str | None, now_ns: int
) -> UpwindProposal | str:
    """Return the best place over these regions, or why none is known, as a sentence.

    Without a serial the first imaging drone that shows the field is meant. Takes too long for a
    step.
    """
    asked = upwind_question(station, regions, serial, now_ns)
    return asked if isinstance(asked, str) else propose(asked)


def upwind_question(
    station: Station, regions: Sequence[Region], serial: str | None, now_ns: int
) -> UpwindQuestion | str:
    """Return what a place is proposed by, or why none can be, as a sentence."""
    imagers = station.imaging.imagers
    imager = imagers.get(serial or next(iter((*imagers_at_work(station), *imagers)), ""))
    if imager is None or imager.outlook is None:
        return "expected an imaging drone of the site, got " + (serial or "a site without any")
    if not regions:
        return "expected a survey region, got none: draw one, or start a survey"
    sun, vehicle = station.shade.sun, station.fleet.vehicles.get(imager.serial)
    if sun is None or sun.velocity_mps is None:
        return "the shadows' motion is not known yet: it takes a minute of broken shade in view"
    if ns_to_seconds(now_ns - sun.issued_at_ns) > OLDEST_FORECAST_S:
        return "the newest forecast is more than a minute old: expected frames of the imaging drone"
    seen = None if vehicle is None else kinematic_state(vehicle, now_ns)
    if vehicle is None or vehicle.is_flying.value is not True:
        return f"{imager.serial} is not in the air"
    unseen = refusal_without_telemetry(vehicle, now_ns, station.settings.streams)
    if seen is None or unseen is not None:
        return f"{imager.serial} has no recent telemetry" if unseen is None else unseen.reason
    if seen.height_above_takeoff_m < LEAST_HEIGHT_M:
        return f"{vehicle.display_name} is lower than {LEAST_HEIGHT_M:g} m above takeoff"
    is_following = station.shade.forecast.followed is not None
    airspace = station.airspace.airspace
    return UpwindQuestion(
        serial=imager.serial,
        frame=sun.grid.frame,
        regions=tuple(regions),
        velocity_mps=sun.velocity_mps,
        view=_view(imager.outlook, seen.height_above_takeoff_m),
        followed_for_s=station.settings.forecast.followed_for_s if is_following else 0.0,
        position=seen.position,
        height_above_takeoff_m=seen.height_above_takeoff_m,
        yaw_deg=seen.yaw_deg,
        off_front_deg=imager.outlook.off_front_deg,
        boundary=airspace.boundary,
        keep_out=tuple(z.region for z in airspace.zones if z.kind is ZoneKind.KEEP_OUT),
    )


def _view(outlook: Outlook, height_m: float) -> GroundView:
    farthest_m = farthest_sight_m(height_m, outlook.pixels_per_radian, COARSEST_M)
    return GroundView(height_m, outlook.field_rad, outlook.tilt_rad, farthest_m)
