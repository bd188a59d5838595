"""Where an imaging drone would see more of the shade that comes over a region than it does now.

It flies there by an order of a person, a goto like any other; the gate judges it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot

import numpy as np

from recon.camera.sight import COARSEST_M, farthest_sight_m
from recon.geo import Polygon, enu_from_point, point_from_enu
from recon.guidance.upwind_place import (
    BoolArray,
    FloatArray,
    GroundView,
    UpwindPlace,
    best_place,
    field_points_m,
    seen_from,
)
from recon.model.airspace import Region, ZoneKind
from recon.model.geo import GeoPoint, LatLon, LocalFrame
from recon.model.imagery import Outlook
from recon.model.units import ns_to_seconds, wrap_degrees
from recon.station.state.station import Station
from recon.station.steering.kinematic_state import kinematic_state, refusal_without_telemetry

SPEED_MPS = 8.0
EDGE_M = 30.0
"""From the boundary and from keep-out zones: the gate wants less, and has the last word."""
OLDEST_FORECAST_S = 60.0
LEAST_HEIGHT_M = 10.0
"""Lower, it sees no field from anywhere."""
LEAST_GAIN = 0.03
"""In what a place is worth, for a flight there."""
LEAST_TILT_RAD = 0.1
"""A camera tilted by less sees as much in every direction: the heading stays."""


@dataclass(frozen=True, slots=True)
class UpwindProposal:
    """What an imaging drone sees from its place, and from the best one."""

    serial: str
    place: LatLon
    height_above_takeoff_m: float
    yaw_deg: float
    """The aircraft's heading there."""
    distance_m: float
    here: UpwindPlace
    there: UpwindPlace

    @property
    def takes_s(self) -> float:
        """The time to fly there."""
        return self.distance_m / SPEED_MPS


def proposed(
    station: Station, regions: Sequence[Region], serial: str | None, now_ns: int
) -> UpwindProposal | str:
    """Return the best place over these regions, or why none is known, as a sentence.

    Without a serial the site's first imaging drone is meant.
    """
    imagers = station.imaging.imagers
    imager = imagers.get(serial or next(iter(imagers), ""))
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
    frame, outlook = sun.grid.frame, imager.outlook
    view = _view(outlook, seen.height_above_takeoff_m)
    field_m = np.concatenate([_points_m(region) for region in regions])
    here_m = _east_north_m(frame, seen.position)
    looks_deg = wrap_degrees(seen.yaw_deg + outlook.off_front_deg)
    is_following = station.shade.forecast.followed is not None
    followed_for_s = station.settings.forecast.followed_for_s if is_following else 0.0
    here = seen_from(field_m, here_m, looks_deg, sun.velocity_mps, view, followed_for_s)
    there = best_place(
        field_m,
        sun.velocity_mps,
        view,
        followed_for_s,
        lambda places: _may_hover(station, places),
    )
    if there is None or there.worth < here.worth + LEAST_GAIN:
        there = here
    is_turned = there is not here and outlook.tilt_rad >= LEAST_TILT_RAD
    place = point_from_enu(frame, (there.east_m, there.north_m, 0.0))
    return UpwindProposal(
        imager.serial,
        LatLon(place.latitude_deg, place.longitude_deg),
        seen.height_above_takeoff_m,
        wrap_degrees(there.heading_deg - outlook.off_front_deg) if is_turned else seen.yaw_deg,
        hypot(there.east_m - here_m[0], there.north_m - here_m[1]),
        here,
        there,
    )


def _view(outlook: Outlook, height_m: float) -> GroundView:
    farthest_m = farthest_sight_m(height_m, outlook.pixels_per_radian, COARSEST_M)
    return GroundView(height_m, outlook.field_rad, outlook.tilt_rad, farthest_m)


def _points_m(region: Region) -> FloatArray:
    return field_points_m(region.outline_m, Polygon(region).contains)


def _east_north_m(frame: LocalFrame, place: LatLon) -> tuple[float, float]:
    ground = GeoPoint(place.latitude_deg, place.longitude_deg, frame.origin.ellipsoid_height_m)
    east_m, north_m, _up_m = enu_from_point(frame, ground).tolist()
    return east_m, north_m


def _may_hover(station: Station, places_m: FloatArray) -> BoolArray:
    """Return which places (N, 2) lie inside the boundary and outside keep-out zones."""
    airspace = station.airspace
    allowed = np.ones(len(places_m), dtype=np.bool_)
    if airspace.boundary is not None:
        allowed &= airspace.boundary.distance_to_edge_m(places_m) >= EDGE_M
    for prepared in airspace.zones:
        if prepared.zone.kind is ZoneKind.KEEP_OUT:
            allowed &= prepared.polygon.distance_to_edge_m(places_m) <= -EDGE_M
    return allowed
