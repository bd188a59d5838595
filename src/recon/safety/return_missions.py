"""Missions that only bring a vehicle down: checks that prevent a flight do not apply."""

from itertools import pairwise
from typing import Final

from recon.geo.distance import horizontal_distance_m
from recon.model.geo import GeoPoint, LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.vehicle import VehicleState
from recon.safety.airspace import PreparedAirspace
from recon.safety.datum import NEAR_PAD_M, home

LONGEST_DETOUR: Final = 2.0
DETOUR_M: Final = 50.0
"""A path round a zone is at most twice as long as the straight one, and near its end 50 m more."""


def leads_home(mission: Mission, vehicle: VehicleState, airspace: PreparedAirspace) -> bool:
    """Return whether a mission only brings a vehicle from the air to a place of its own.

    It lands at its end, within 10 m of where the vehicle took off, of its pad, or of a pad for any;
    it pauses nowhere, and its path, from where the vehicle is, is the straight one or a detour.
    """
    here = vehicle.position.value
    if vehicle.is_flying.value is not True or here is None or not mission.land_at_end:
        return False
    if any(waypoint.loiter_s is not None for waypoint in mission.waypoints):
        return False
    path = [here, *(_place(waypoint) for waypoint in mission.waypoints)]
    places = _own_places(vehicle, airspace)
    if not any(horizontal_distance_m(path[-1], place) <= NEAR_PAD_M for place in places):
        return False
    flown_m = sum(horizontal_distance_m(a, b) for a, b in pairwise(path))
    return flown_m <= LONGEST_DETOUR * horizontal_distance_m(here, path[-1]) + DETOUR_M


def _own_places(vehicle: VehicleState, airspace: PreparedAirspace) -> list[LatLon]:
    pads = [
        pad.place
        for pad in airspace.airspace.landing_pads
        if pad.serial is None or pad.serial == vehicle.serial
    ]
    if vehicle.profile is not None and vehicle.profile.pad is not None:
        pads.append(vehicle.profile.pad)
    took_off = home(vehicle)
    return [_place(pad) for pad in pads] + ([] if took_off is None else [took_off])


def _place(point: GeoPoint | Waypoint) -> LatLon:
    return LatLon(point.latitude_deg, point.longitude_deg)
