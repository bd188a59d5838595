"""Whether an aircraft goes home as the site asks: its height, its path, its landing.

The ICD carries neither the go-home height nor the home point that are set in an aircraft, so both
are judged by what telemetry shows while it goes home: ordered, or as its own failsafe. A
fleet return flies a mission, and is judged as one. What is asked: the go-home height of its profile
unless it began higher, straight to the home that the station believes, a landing there.

`deviations` is a plain condition of a vehicle's state; `prediction` asks `seen_height_m` and
`is_off_track`, so that others are kept apart from where the vehicle flies, not from where it was
asked to.
"""

from collections.abc import Iterator
from math import cos, hypot, radians
from typing import NamedTuple

from recon.fleet.airborne import LANDING_MODES
from recon.fleet.go_home import is_under_way
from recon.geo.distance import horizontal_distance_m, offset_north_east_m
from recon.model.severity import Severity
from recon.model.units import ns_to_seconds
from recon.model.vehicle import GoHomeFlight, VehicleState
from recon.safety.datum import home
from recon.safety.settings import GoHomeSettings

SETTINGS = GoHomeSettings()

HEIGHT, TRACK, PROGRESS, LANDING = "height", "track", "progress", "landing"
"""The kinds of deviation."""


class GoHomeDeviation(NamedTuple):
    """One path in which a flight home differs: a sentence without the vehicle's name, and how long
    it must last before it is an alarm."""

    kind: str
    severity: Severity
    text: str
    after_s: float


def deviations(
    vehicle: VehicleState, now_ns: int, settings: GoHomeSettings = SETTINGS
) -> Iterator[GoHomeDeviation]:
    """Yield in what a vehicle's flight home differs from what the site asks; nothing without one,
    or without a home to compare with."""
    flight, far_m = vehicle.go_home, home_distance_m(vehicle)
    if flight is None or far_m is None:
        return
    if vehicle.flight_mode.value in LANDING_MODES:
        yield from _lands_elsewhere(vehicle, far_m, settings)
        return
    if far_m <= settings.near_home_m:
        return
    yield from _height(vehicle, flight, settings)
    if is_off_track(vehicle, settings):
        text = (
            f"goes home, expected straight to its home {far_m:.0f} m away; seen more than "
            f"{settings.off_track_m:g} m beside that way, or turned away from it. The home point "
            "set in the aircraft may be elsewhere: hold it, and have its pilot check the home point"
        )
        yield GoHomeDeviation(TRACK, Severity.CRITICAL, text, settings.off_track_s)
    waits_s = ns_to_seconds(now_ns - flight.progress_at_ns)
    if waits_s > settings.no_progress_s:
        text = (
            f"goes home, expected nearer to home or higher every {settings.no_progress_s:g} s; "
            f"seen {far_m:.0f} m from home without progress for {waits_s:.0f} s. Wind or an "
            "obstacle may stop it: have its pilot steer it, or land it"
        )
        yield GoHomeDeviation(PROGRESS, Severity.ERROR, text, 0.0)


def asked_height_m(vehicle: VehicleState) -> float | None:
    """Return the height above takeoff that its flight home is asked to keep; None: not known."""
    flight, profile = vehicle.go_home, vehicle.profile
    asked_m = None if profile is None else profile.go_home_height_m
    if flight is None or asked_m is None:
        return None
    return asked_m if flight.start_height_m is None else max(asked_m, flight.start_height_m)


def seen_height_m(vehicle: VehicleState, settings: GoHomeSettings = SETTINGS) -> float | None:
    """Return the height above takeoff at which it goes home, once telemetry shows another one than
    is asked; None while it does not."""
    flight, far_m = vehicle.go_home, home_distance_m(vehicle)
    asked_m, height_m = asked_height_m(vehicle), vehicle.height_above_takeoff_m.value
    if flight is None or asked_m is None or height_m is None:
        return None
    if not _is_level(vehicle, flight, settings):
        return None
    if far_m is None or far_m <= settings.near_home_m:
        return None
    return height_m if abs(height_m - asked_m) > settings.height_off_m else None


def is_off_track(vehicle: VehicleState, settings: GoHomeSettings = SETTINGS) -> bool:
    """Return whether it goes home and is beside the straight path to the home that the station
    believes, or turns away from it."""
    flight = vehicle.go_home
    if flight is None or flight.level_from is None or not _is_level(vehicle, flight, settings):
        return False
    place, there, velocity = vehicle.position.value, home(vehicle), vehicle.velocity_ned.value
    if place is None or there is None or velocity is None:
        return False
    north_m, east_m = offset_north_east_m(place, there)
    far_m, speed_mps = hypot(north_m, east_m), hypot(velocity.north_mps, velocity.east_mps)
    if far_m <= settings.near_home_m:
        return False
    along_mps = (north_m * velocity.north_mps + east_m * velocity.east_mps) / far_m
    if along_mps < cos(radians(settings.off_track_deg)) * speed_mps:
        return True
    path_north_m, path_east_m = offset_north_east_m(flight.level_from, there)
    across_m = abs(path_north_m * east_m - path_east_m * north_m) / hypot(path_north_m, path_east_m)
    return across_m > settings.off_track_m


def home_distance_m(vehicle: VehicleState) -> float | None:
    """Return how far it is from the home that the station believes; None when either is unknown."""
    place, there = vehicle.position.value, home(vehicle)
    return None if place is None or there is None else horizontal_distance_m(place, there)


def _height(
    vehicle: VehicleState, flight: GoHomeFlight, settings: GoHomeSettings
) -> Iterator[GoHomeDeviation]:
    asked_m, height_m = asked_height_m(vehicle), vehicle.height_above_takeoff_m.value
    if asked_m is None or height_m is None:
        return
    figures = f"expected {asked_m:.0f} m above takeoff, seen {height_m:.0f} m"
    todo = "hold it or clear its way, and check the height set in the aircraft"
    if height_m > asked_m + settings.height_off_m:
        text = f"goes home too high: {figures}. Other vehicles' layers may be there: {todo}"
        yield GoHomeDeviation(HEIGHT, Severity.ERROR, text, settings.off_height_s)
    elif _is_level(vehicle, flight, settings) and height_m < asked_m - settings.height_off_m:
        text = (
            f"goes home too low: {figures}. Zones and other vehicles' layers may be in its way: "
            f"{todo}"
        )
        yield GoHomeDeviation(HEIGHT, Severity.CRITICAL, text, settings.off_height_s)


def _lands_elsewhere(
    vehicle: VehicleState, far_m: float, settings: GoHomeSettings
) -> Iterator[GoHomeDeviation]:
    place = vehicle.position.value
    pad = None if vehicle.profile is None else vehicle.profile.pad_place
    if place is not None and pad is not None:
        far_m = min(far_m, horizontal_distance_m(place, pad))
    if far_m > settings.lands_within_m:
        text = (
            f"lands {far_m:.0f} m from home, expected within {settings.lands_within_m:g} m. Its "
            "home point may be elsewhere, or its battery low: keep persons clear there; its "
            "pilot must take over"
        )
        yield GoHomeDeviation(LANDING, Severity.CRITICAL, text, 0.5)


def _is_level(vehicle: VehicleState, flight: GoHomeFlight, settings: GoHomeSettings) -> bool:
    """Whether it flies home and no longer brakes from its former flight nor climbs."""
    velocity, at_ns = vehicle.velocity_ned.value, vehicle.core_received_at_ns
    if velocity is None or at_ns is None:
        return False
    return is_under_way(vehicle, flight, at_ns) and -velocity.down_mps < settings.climb_mps
