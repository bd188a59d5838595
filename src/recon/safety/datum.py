"""Where things are in one frame: east, north and up in metres, for everything safety compares.

East and north are in the tangent plane of the frame's origin, at the origin's height; up is the
ellipsoidal height minus the origin's. Every function returns None for what is not known.

A vehicle reports heights above its own takeoff point. The height of that point is the pad's
it took off from (within 10 m: its own first, else the nearest), else the elevation model's, else
that of the frame's origin: "flat assumed". Without a site the ground is unknown: the frame is put
at the vehicle itself, and all ground is flat, at its origin's height.
"""

from collections.abc import Iterable, Sequence
from functools import lru_cache

import numpy as np

from recon.geo import OnGlobe, enu_from_geo, tangent_plane
from recon.geo.distance import horizontal_distance_m
from recon.model.arrays import FloatArray
from recon.model.geo import GeoPoint, LatLon, LocalFrame
from recon.model.vehicle import VehicleState
from recon.safety.airspace import PreparedAirspace

NEAR_PAD_M = 10.0
"""Where a vehicle took off and where its pad is are both known by GNSS: twice 2.5 m off, and a
pilot steps aside."""

FEW_PLACES = 16
"""Number of places up to which one by one is faster than all at once."""

TAKEOFF_POINTS_KEPT = 256
"""Their heights, more than vehicles fly: they are asked for with every stick and every look."""


def frame_for(airspace: PreparedAirspace, vehicle: VehicleState) -> LocalFrame | None:
    """Return the site's frame, or one put at the vehicle; None without a site or a position."""
    if airspace.airspace.frame is not None:
        return airspace.airspace.frame
    position = vehicle.position.value
    if position is None:
        return None
    return LocalFrame(GeoPoint(position.latitude_deg, position.longitude_deg, 0.0))


def places_m(frame: LocalFrame, places: Iterable[OnGlobe]) -> FloatArray:
    """Return east and north (N, 2) of N places; (0, 2) for none."""
    height_m, degrees = (
        frame.origin.ellipsoid_height_m,
        [(place.latitude_deg, place.longitude_deg) for place in places],
    )
    if len(degrees) <= FEW_PLACES:
        plane = tangent_plane(frame)
        points = [plane.enu_m(latitude, longitude, height_m)[:2] for latitude, longitude in degrees]
        return np.array(points).reshape(len(points), 2)
    latitudes, longitudes = np.array(degrees).T
    return enu_from_geo(frame, latitudes, longitudes, height_m)[:, :2]


def home(vehicle: VehicleState) -> LatLon | None:
    """Return where the vehicle would go home to.

    On the ground it is the vehicle's position, since it will take off there. In the air it is where
    the station observed its takeoff, or else its own pad: the aircraft does not report its home.
    """
    if vehicle.is_flying.value is False and vehicle.position.value is not None:
        return vehicle.position.value
    if vehicle.takeoff_point is not None:
        return vehicle.takeoff_point
    return None if vehicle.profile is None else vehicle.profile.pad_place


def takeoff_up_m(airspace: PreparedAirspace, vehicle: VehicleState) -> float | None:
    """Return how high the vehicle's takeoff point is.

    None when the takeoff point is unknown, or outside the elevation model. Without
    a site it is always 0.
    """
    return takeoff_up_m_at(airspace, vehicle, home(vehicle))


def takeoff_up_m_at(
    airspace: PreparedAirspace, vehicle: VehicleState, point: LatLon | None
) -> float | None:
    """Return the same where the vehicle's `home` is known already."""
    if airspace.airspace.frame is None:
        return 0.0
    if point is None:
        return None
    own = None if vehicle.profile is None else vehicle.profile.pad
    return _takeoff_up_m(airspace, point, own, vehicle.serial)


def is_takeoff_height_known(
    airspace: PreparedAirspace, vehicle: VehicleState, point: LatLon | None
) -> bool:
    """Return whether a takeoff point's height comes from a pad or an elevation model.

    Where flat ground is assumed the heights of two vehicles may differ by any slope between their
    takeoff points: they say nothing about each other.
    """
    if point is None:
        return False
    if not is_ground_assumed_flat(airspace):
        return takeoff_up_m_at(airspace, vehicle, point) is not None
    own = None if vehicle.profile is None else vehicle.profile.pad
    return _is_at_pad(airspace, point, own)


def is_ground_assumed_flat(airspace: PreparedAirspace) -> bool:
    """Return whether no elevation model is loaded."""
    return airspace.airspace.elevation is None


def vehicle_enu_m(
    airspace: PreparedAirspace, vehicle: VehicleState, frame: LocalFrame | None = None
) -> FloatArray | None:
    """Return the vehicle's last known position, (3,).

    `frame` is for comparing several vehicles where there is no site; else the airspace's own.
    """
    frame = frame or frame_for(airspace, vehicle)
    position, height_m = vehicle.position.value, vehicle.height_above_takeoff_m.value
    takeoff_m = takeoff_up_m(airspace, vehicle)
    if frame is None or position is None or height_m is None or takeoff_m is None:
        return None
    return _enu_m(frame, position, takeoff_m + height_m)


def home_enu_m(
    airspace: PreparedAirspace, vehicle: VehicleState, frame: LocalFrame | None = None
) -> FloatArray | None:
    """Return the takeoff point that the vehicle goes home to, (3,)."""
    frame = frame or frame_for(airspace, vehicle)
    point, takeoff_m = home(vehicle), takeoff_up_m(airspace, vehicle)
    if frame is None or point is None or takeoff_m is None:
        return None
    return _enu_m(frame, point, takeoff_m)


@lru_cache(maxsize=TAKEOFF_POINTS_KEPT)
def _takeoff_up_m(
    airspace: PreparedAirspace,
    point: LatLon,
    own_pad: GeoPoint | None,
    serial: str | None,
) -> float | None:
    frame = airspace.airspace.frame
    assert frame is not None, "only called with a frame"
    pad = _pad_at(airspace, point, own_pad, serial)
    if pad is not None:
        return pad.ellipsoid_height_m - frame.origin.ellipsoid_height_m
    if is_ground_assumed_flat(airspace):
        return 0.0
    ground_m = float(airspace.ground_up_m(places_m(frame, [point]))[0])
    return None if np.isnan(ground_m) else ground_m


@lru_cache(maxsize=TAKEOFF_POINTS_KEPT)
def _is_at_pad(airspace: PreparedAirspace, point: LatLon, own_pad: GeoPoint | None) -> bool:
    """Whether a takeoff here was from a pad: the vehicle's own, or any of the site's."""
    return _pad_at(airspace, point, own_pad, None) is not None


def _pad_at(
    airspace: PreparedAirspace, point: LatLon, own_pad: GeoPoint | None, serial: str | None
) -> GeoPoint | None:
    """The pad that a takeoff here was from: the vehicle's own when it is near, else the nearest."""
    pads = airspace.airspace.landing_pads
    own = [] if own_pad is None else [own_pad]
    own += [pad.place for pad in pads if pad.serial is not None and pad.serial == serial]
    return _nearest(own, point) or _nearest([pad.place for pad in pads], point)


def _nearest(pads: Sequence[GeoPoint], point: LatLon) -> GeoPoint | None:
    def far_m(pad: GeoPoint) -> float:
        return horizontal_distance_m(point, pad)

    return min((pad for pad in pads if far_m(pad) <= NEAR_PAD_M), key=far_m, default=None)


def _enu_m(frame: LocalFrame, place: LatLon, up_m: float) -> FloatArray:
    """A place on the globe and its height in the frame, (3,)."""
    return np.array([*places_m(frame, [place])[0], up_m])
