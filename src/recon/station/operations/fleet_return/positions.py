"""Positions of vehicles and pads, as the fleet return's plan needs them."""

from collections.abc import Sequence
from math import dist

import numpy as np

from recon.guidance.fleet_return import (
    CalledVehicle,
    Hovering,
    Pad,
    Separation,
)
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.vehicle import VehicleState
from recon.safety.datum import home_enu_m, places_m, takeoff_up_m, vehicle_enu_m
from recon.safety.separation_minima import gate_minima
from recon.station.operations.settings import ReturnSettings
from recon.station.state.station import Station

AROUND_M = 50.0
"""Ground this far around all positions and pads counts: detours leave the straight lines."""


def in_the_air(station: Station, frame: LocalFrame) -> dict[str, Hovering]:
    """Return the last known position of everything that flies, or may; by serial, or by link.

    Vehicles without any known position are left out: the gate refuses all motion because of them.
    """
    flying = {
        serial: vehicle
        for serial, vehicle in station.fleet.vehicles.items()
        if vehicle.is_flying.value is not False
    }
    for link in station.fleet.unbound_links():
        if link.own_state.is_flying.value is True:
            flying[f"link {link.id}"] = link.own_state
    known = [(k, v, v.position.value) for k, v in flying.items() if v.position.value is not None]
    spots = places_m(frame, [position for _, _, position in known if position is not None])
    found: dict[str, Hovering] = {}
    for (key, vehicle, _), (east_m, north_m) in zip(known, spots, strict=True):
        base_m = takeoff_up_m(station.airspace, vehicle)
        height_m = vehicle.height_above_takeoff_m.value
        if base_m is not None and height_m is not None:
            place_m = float(east_m), float(north_m), base_m + height_m
            found[key] = Hovering(key, vehicle.display_name, place_m)
    return found


def returning(station: Station, serial: str, frame: LocalFrame) -> CalledVehicle | str:
    """Return a vehicle as the plan needs it, or a sentence about what is unknown."""
    vehicle = station.fleet.vehicles[serial]
    found = vehicle_enu_m(station.airspace, vehicle, frame)
    takeoff_m = takeoff_up_m(station.airspace, vehicle)
    pad = _pad(station, vehicle, frame)
    if found is None or takeoff_m is None or pad is None:
        return (
            "its position or takeoff point is unknown, and its heights count from there; give it a "
            "pad in the site's file"
        )
    place_m = float(found[0]), float(found[1]), float(found[2])
    battery = vehicle.battery_fraction.value
    return CalledVehicle(serial, vehicle.display_name, place_m, takeoff_m, pad, battery)


def ground_up_m(station: Station, vehicles: Sequence[CalledVehicle]) -> tuple[float, float]:
    """Return the lowest and the highest ground on and around the paths of these vehicles."""
    spots = [v.place_m[:2] for v in vehicles] + [v.pad.east_north_m for v in vehicles]
    lowest_m, highest_m = station.airspace.ground_within_up_m(_box(spots))
    return float(np.min(lowest_m)), float(np.max(highest_m))


def separation(station: Station, settings: ReturnSettings) -> Separation:
    """Return how far apart the plan keeps vehicles: the gate's minima and some slack."""
    gate = gate_minima(station.airspace.airspace.limits, station.settings.safety)
    return Separation(
        gate.horizontal_m + settings.plan.horizontal_slack_m,
        gate.vertical_m + settings.plan.vertical_slack_m,
    )


def is_same_pad(one: Pad, other: Pad, settings: ReturnSettings) -> bool:
    """Return whether two pads are so near that only one vehicle can stand there."""
    return dist(one.east_north_m, other.east_north_m) < settings.same_pad_m


def _pad(station: Station, vehicle: VehicleState, frame: LocalFrame) -> Pad | None:
    """Its own pad, from the site's layer or its profile; else its takeoff point."""
    for pad in station.airspace.airspace.landing_pads:
        if pad.serial is not None and pad.serial == vehicle.serial:
            return _pad_at(station, pad.name, pad.place, frame)
    if vehicle.profile is not None and vehicle.profile.pad is not None:
        return _pad_at(station, "of its own", vehicle.profile.pad, frame)
    home_m = home_enu_m(station.airspace, vehicle, frame)
    if home_m is None:
        return None
    return Pad("at its takeoff point", float(home_m[0]), float(home_m[1]), float(home_m[2]))


def _pad_at(station: Station, name: str, point: GeoPoint, frame: LocalFrame) -> Pad:
    (east_m, north_m), *_ = places_m(frame, [point])
    origin_m = frame.origin.ellipsoid_height_m
    is_site = station.airspace.airspace.frame is not None
    up_m = point.ellipsoid_height_m - origin_m if is_site else 0.0
    return Pad(name, float(east_m), float(north_m), up_m)


def _box(
    points: Sequence[tuple[float, float]],
) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Two triangles that cover all points and the ground around them, (2, 3, 2)."""
    low = np.min(points, axis=0) - AROUND_M
    high = np.max(points, axis=0) + AROUND_M
    return np.array([[low, (high[0], low[1]), high], [low, high, (low[0], high[1])]])
