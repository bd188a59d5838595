"""The vehicle in its place: fence, home, pad, ground and clock."""

from math import floor, isnan

import numpy as np

from recon.geo.distance import horizontal_distance_m
from recon.model.geo import GeoPoint, LatLon
from recon.model.units import ns_to_seconds
from recon.model.vehicle import VehicleState
from recon.safety.check import Check, Point
from recon.safety.datum import NEAR_PAD_M, home, is_ground_assumed_flat, places_m
from recon.safety.situation import Situation

FENCE = Point("fence", "Fence")
GROUND = Point("ground", "Ground")
HOME = Point("home", "Home")
PAD = Point("pad", "Pad's altitude")
CLOCK = Point("clock", "Clock")


def fence(_vehicle: VehicleState, situation: Situation) -> Check:
    """The site has a boundary."""
    airspace = situation.airspace.airspace
    if airspace.boundary is None:
        return FENCE.fails("no boundary is loaded", "name one in site.toml under [layers]")
    return FENCE.ok(f"the boundary and {len(airspace.zones)} zones are loaded")


def ground(_vehicle: VehicleState, situation: Situation) -> Check:
    """An elevation model is loaded."""
    if is_ground_assumed_flat(situation.airspace):
        return GROUND.attention(
            "flat ground assumed: no elevation model is loaded",
            "mind slopes and mounds, or name an elevation model in site.toml",
        )
    return GROUND.ok("by the elevation model")


def home_place(vehicle: VehicleState, situation: Situation) -> Check:
    """The home point is known."""
    base, pad = home(vehicle), _pad(vehicle, situation)
    if base is None:
        return HOME.unknown(
            "home unknown: takeoff not observed, and no pad",
            "write its pad into site.toml, or let its pilot land it and take off again",
        )
    if vehicle.is_flying.value is not False and vehicle.takeoff_point is None:
        return HOME.attention(
            "assumed at its pad: takeoff not observed", "confirm the home point with the pilot"
        )
    if pad is not None and horizontal_distance_m(base, _place(pad)) > NEAR_PAD_M:
        far_m = horizontal_distance_m(base, _place(pad))
        return HOME.attention(
            f"{far_m:.0f} m from its pad", "it comes back to where it takes off: is that free?"
        )
    return HOME.ok("where it takes off")


def pad_altitude(vehicle: VehicleState, situation: Situation) -> Check:
    """The pad's altitude agrees with the ground there."""
    pad, frame = _pad(vehicle, situation), situation.airspace.airspace.frame
    if pad is None:
        return PAD.ok("no pad: heights count from the ground at takeoff")
    if frame is None or is_ground_assumed_flat(situation.airspace):
        return PAD.attention(
            "not compared with the ground: no elevation model is loaded",
            "compare the pad's altitude in site.toml with a map's, ellipsoidal both",
        )
    up_m = float(situation.airspace.ground_up_m(places_m(frame, [_place(pad)]))[0])
    ground_m = up_m + frame.origin.ellipsoid_height_m
    if isnan(ground_m):
        return PAD.attention("the elevation model has no ground at the pad", "check its extent")
    off_m = pad.ellipsoid_height_m - ground_m
    if abs(off_m) > situation.settings.preflight.pad_ground_m:
        return PAD.fails(
            f"the pad is {off_m:+.1f} m from the elevation model's ground",
            "correct the pad's altitude, or the model's datum, in site.toml",
        )
    return PAD.ok(f"{off_m:+.1f} m from the elevation model's ground")


def clock(_vehicle: VehicleState, situation: Situation) -> Check:
    """The computer's clock was set, and has not been set anew since."""
    reading, settings = situation.facts.clock, situation.settings.preflight
    if reading is None:
        return CLOCK.unknown("the computer's clock has not been read", "wait a second")
    clock_s = ns_to_seconds(reading.wall_ns)
    if clock_s < settings.earliest_clock_s:
        return CLOCK.fails(
            f"the computer's clock shows {_date(clock_s)}", "set it, and start the station anew"
        )
    set_s = ns_to_seconds(reading.set_by_ns)
    if abs(set_s) > settings.clock_set_s:
        return CLOCK.attention(
            f"the computer's clock was set by {set_s:+.1f} s since the start",
            "times in the record count from before: start the station anew between flights",
        )
    return CLOCK.ok(f"{_date(clock_s)} UTC")


def _pad(vehicle: VehicleState, situation: Situation) -> GeoPoint | None:
    """The vehicle's own pad, by its profile or the site's layer."""
    if vehicle.profile is not None and vehicle.profile.pad is not None:
        return vehicle.profile.pad
    pads = situation.airspace.airspace.landing_pads
    return next((p.place for p in pads if p.serial == vehicle.serial), None)


def _place(point: GeoPoint) -> LatLon:
    return LatLon(point.latitude_deg, point.longitude_deg)


def _date(seconds: float) -> str:
    return str(np.datetime64(floor(seconds / 60.0), "m")).replace("T", " ")
