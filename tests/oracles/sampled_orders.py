"""What orders and intents make vehicles fly, as `sampled_flights` writes it."""

from dataclasses import dataclass
from math import hypot

import numpy as np
from tests.oracles.sampled_flights import (
    ALL_HEIGHTS_M,
    BRAKING_MPS2,
    CLIMB_MPS,
    REACTION_S,
    STANDING_MPS,
    START_DELAY_S,
    STEP_M,
    Aircraft,
    Flight,
    FloatArray,
)

HOLDS_S = 30.0
FREE_S = 5.0
STICK_S = 5.0
RETURN_MPS = 10.0
UNDER_WAY_MPS = 2.0
UNKNOWN_CLIMB_M = 500.0
CORRIDOR_M = 10.0


@dataclass(frozen=True, slots=True, eq=False)
class Route:
    """A mission: (N, 3) waypoints as east, north, up; speeds flown from each, waits, corners."""

    points_m: FloatArray
    speeds_mps: FloatArray
    waits_s: FloatArray
    radii_m: FloatArray
    curved: bool
    land_at_end: bool


def ordered_mission(aircraft: Aircraft, route: Route) -> Flight:
    """It stops first, and begins with its first waypoint, at once or some seconds late."""
    flight = Flight(aircraft)
    flight.begins_late_s = START_DELAY_S
    start_mps = None
    if hypot(*aircraft.velocity_mps[:2]) >= STANDING_MPS:
        flight.brakes(REACTION_S)
        start_mps = 0.0
    return _fly(flight, route, 0, start_mps)


def on_mission(aircraft: Aircraft, route: Route, passed: int) -> Flight:
    """It is under way to a waypoint; one that stands before the first may begin late."""
    flight = Flight(aircraft)
    if passed == 0 and np.abs(aircraft.velocity_mps).max() < STANDING_MPS:
        flight.begins_late_s = START_DELAY_S
    return _fly(flight, route, passed, None)


def ordered_goto(aircraft: Aircraft, target_m: FloatArray, speed_mps: float) -> Flight:
    """Straight to a place, held there until it is judged anew."""
    flight = _go(Flight(aircraft), target_m, speed_mps)
    flight.stays(HOLDS_S)
    return flight


def on_goto(aircraft: Aircraft, target_m: FloatArray, speed_mps: float) -> Flight:
    """Straight to a place, and there forever."""
    flight = _go(Flight(aircraft), target_m, speed_mps)
    flight.stays()
    return flight


def ordered_hold(aircraft: Aircraft) -> Flight:
    """Braked after the reaction, and held until it is judged anew."""
    flight = Flight(aircraft)
    flight.brakes(REACTION_S)
    flight.stays(HOLDS_S)
    return flight


def ordered_stick(
    aircraft: Aircraft, velocity_mps: FloatArray, up_m: float, timeout_s: float
) -> Flight:
    """A velocity (2,) flown from now on, kept for its time and the reaction's, and braked."""
    flight = Flight(aircraft)
    if aircraft.age_s > 0.0:
        flown_m = aircraft.age_s * aircraft.velocity_mps[:2]
        flight.goes(flight.place_m + flown_m, aircraft.age_s, (flight.low_m, flight.high_m))
    flight.widens((up_m, up_m))
    _reach_velocity(flight, velocity_mps)
    band_m = (flight.low_m, flight.high_m)
    flight.goes(flight.place_m + timeout_s * velocity_mps, timeout_s, band_m)
    flight.brakes(REACTION_S, np.array([*velocity_mps, 0.0]))
    return flight


def on_stick(aircraft: Aircraft) -> Flight:
    """Its velocity for as long as a stick may last, then braked; where it stands it stays."""
    flight = Flight(aircraft)
    east_north_m = STICK_S * aircraft.velocity_mps[:2]
    rise_m = STICK_S * float(aircraft.velocity_mps[2])
    band_m = (flight.low_m + rise_m, flight.high_m + rise_m)
    flight.goes(flight.place_m + east_north_m, STICK_S, band_m)
    flight.brakes(0.0)
    flight.stays()
    return flight


def on_hold(aircraft: Aircraft) -> Flight:
    """Braking already, then standing."""
    flight = Flight(aircraft)
    flight.brakes(0.0)
    flight.stays()
    return flight


def on_landing(aircraft: Aircraft) -> Flight:
    """Braking already, then sinking."""
    flight = Flight(aircraft)
    flight.brakes(0.0)
    flight.sinks()
    return flight


def on_return(aircraft: Aircraft) -> Flight:
    """Climb to the go-home height unless higher, fly home, sink."""
    flight = Flight(aircraft)
    towards_mps, top_m = flight.towards_mps(aircraft.home_m), go_home_top_m(aircraft)
    if towards_mps >= UNDER_WAY_MPS:
        flight.widens((top_m, top_m))
    else:
        flight.brakes(0.0)
    if top_m > flight.high_m:
        low_m = flight.low_m
        climb_s = (top_m - flight.high_m) / CLIMB_MPS
        flight.goes(flight.place_m, climb_s, (low_m, top_m))
        if aircraft.go_home_m is not None:
            flight.low_m = top_m
    speeds_mps = (towards_mps, max(RETURN_MPS, towards_mps), 0.0)
    band_m = (flight.low_m, flight.high_m)
    seconds = flight.flies_to(aircraft.home_m, band_m, speeds_mps)
    flight.goes(aircraft.home_m, seconds, band_m)
    flight.sinks()
    return flight


def without_command(aircraft: Aircraft) -> Flight:
    """Standing it stays; else it uses its speed in any direction for 5 s, and stops."""
    flight = Flight(aircraft)
    speed_mps, up_mps = hypot(*aircraft.velocity_mps[:2]), float(aircraft.velocity_mps[2])
    reach_m = 0.0
    if max(speed_mps, abs(up_mps)) >= STANDING_MPS:
        flight.widens((flight.low_m + FREE_S * up_mps, flight.high_m + FREE_S * up_mps))
        reach_m = speed_mps * (FREE_S + REACTION_S) + speed_mps**2 / (2.0 * BRAKING_MPS2)
        flight.grows(reach_m, FREE_S)
    flight.stays(radius_m=reach_m)
    return flight


def hidden(aircraft: Aircraft, known_mps: float) -> list[FloatArray]:
    """Where a vehicle with lost telemetry may be, at all times: volumes as (N, 9) samples.

    Its circle at the largest, its route home, and the column of its landing there.
    """
    rise_m = max(0.0, float(aircraft.velocity_mps[2])) * min(aircraft.age_s, 10.0)
    top_m = float(aircraft.here_m[2]) + rise_m
    if aircraft.goes_home:
        top_m = max(top_m, go_home_top_m(aircraft))
    mps = max(hypot(*aircraft.velocity_mps[:2]), known_mps, 2.0)
    largest_m = max(150.0, mps * REACTION_S + mps**2 / (2.0 * BRAKING_MPS2))
    here_m = aircraft.here_m[np.newaxis, :2]
    volumes = [_always(here_m, -ALL_HEIGHTS_M, top_m, largest_m)]
    if aircraft.goes_home:
        path_m = aircraft.home_m - here_m[0]
        share = np.linspace(0.0, 1.0, 2 + int(np.hypot(*path_m) / STEP_M))
        line_m = here_m + share[:, np.newaxis] * path_m
        volumes.append(_always(line_m, float(aircraft.here_m[2]), top_m, CORRIDOR_M))
        home_m = aircraft.home_m[np.newaxis]
        volumes.append(_always(home_m, -ALL_HEIGHTS_M, top_m, CORRIDOR_M))
    return volumes


def go_home_top_m(aircraft: Aircraft) -> float:
    """How high the route home is: the go-home height unless already higher."""
    here_m = float(aircraft.here_m[2])
    if aircraft.go_home_m is None:
        return here_m + UNKNOWN_CLIMB_M
    return max(here_m, aircraft.go_home_m)


def _always(places_m: FloatArray, low_m: float, high_m: float, radius_m: float) -> FloatArray:
    row = [-1e6, 1e6, 0.0, 0.0, low_m, high_m, radius_m, 0.0, 0.0]
    samples = np.tile(np.array(row), (len(places_m), 1))
    samples[:, 2:4] = places_m
    return samples


def _go(flight: Flight, target_m: FloatArray, speed_mps: float) -> Flight:
    band_m = (float(target_m[2]), float(target_m[2]))
    flight.widens(band_m)
    both_m = (flight.low_m, flight.high_m)
    speeds_mps = (flight.towards_mps(target_m[:2]), speed_mps, 0.0)
    flight.goes(target_m[:2], flight.flies_to(target_m[:2], both_m, speeds_mps), both_m)
    flight.low_m, flight.high_m = band_m
    return flight


def _reach_velocity(flight: Flight, velocity_mps: FloatArray) -> None:
    """From the present velocity to another with 2.5 m/s2: a parabola; or its chord and bow."""
    before_mps = flight.aircraft.velocity_mps[:2]
    change_mps = velocity_mps - before_mps
    takes_s = float(np.hypot(*change_mps)) / BRAKING_MPS2
    if takes_s < 0.05:
        return
    start_m, end_m = flight.place_m, flight.place_m + takes_s * (before_mps + velocity_mps) / 2.0
    gone_s = np.linspace(0.0, takes_s, 2 + int(takes_s * 10.0))[:, np.newaxis]
    curve_m = start_m + gone_s * before_mps + gone_s**2 / (2.0 * takes_s) * change_mps
    bands_m = np.full(len(gone_s), flight.low_m), np.full(len(gone_s), flight.high_m)
    at_s = flight.time_s + gone_s[:, 0]
    bow_m = float(np.hypot(*change_mps)) * takes_s / 8.0
    chord_m = start_m + gone_s / takes_s * (end_m - start_m)
    carried_m = np.hypot(*(curve_m - chord_m).T)
    flight.instants(at_s, curve_m, bands_m, possible=False, carried_m=carried_m)
    flight.instants(at_s, chord_m, bands_m, bow_m, certain=False)
    flight.place_m, flight.time_s = end_m, flight.time_s + takes_s


def _fly(flight: Flight, route: Route, passed: int, start_mps: float | None) -> Flight:
    """The rest of a route; between here and its first waypoint every height is possible."""
    count, legs, reached_s = len(route.points_m), [], []
    for index in range(passed, count):
        point_m = route.points_m[index]
        band_m = (float(point_m[2]), float(point_m[2]))
        speed_mps = float(route.speeds_mps[max(0, index - 1)])
        is_through = route.curved and index + 1 < count
        end_mps = min(speed_mps, float(route.speeds_mps[index])) if is_through else 0.0
        if start_mps is None:
            start_mps = flight.towards_mps(point_m[:2])
        if index == 0:
            flight.widens(band_m)
        over_m = (flight.low_m, flight.high_m) if index == 0 else band_m
        seconds = flight.flies_to(point_m[:2], over_m, (start_mps, speed_mps, end_mps))
        far_m = float(np.hypot(*(point_m[:2] - flight.place_m)))
        legs.append((flight.time_s, seconds / max(far_m, 1e-3)))
        reached_s.append(flight.time_s + seconds)
        flight.goes(point_m[:2], seconds, over_m, _beside_m(route, index))
        flight.low_m, flight.high_m = band_m
        start_mps = end_mps
        if route.waits_s[index] > 0.0:
            flight.stays(float(route.waits_s[index]))
    for index in range(max(1, passed), count - 1):
        if route.curved:
            (from_s, before), (_, after) = legs[index - passed : index - passed + 2]
            _round(flight, route, index, (from_s, reached_s[index - passed]), (before, after))
    if route.land_at_end:
        flight.sinks()
    else:
        flight.stays()
    return flight


def _reach_m(route: Route, corner: int) -> tuple[float, float]:
    """How far from a corner its curve begins, however the radius is read; and the corner's sine."""
    before_m, corner_m, after_m = route.points_m[corner - 1 : corner + 2, :2]
    back_m, on_m = before_m - corner_m, after_m - corner_m
    lengths_m = float(np.hypot(*back_m)), float(np.hypot(*on_m))
    sine = abs(float(back_m[0] * on_m[1] - back_m[1] * on_m[0])) / (lengths_m[0] * lengths_m[1])
    inner = np.arctan2(sine * lengths_m[0] * lengths_m[1], float(back_m @ on_m))
    radius_m = float(route.radii_m[corner])
    as_arc_m = radius_m / max(float(np.tan(inner / 2.0)), 1e-9)
    return min(max(radius_m, as_arc_m), *lengths_m), sine


def _beside_m(route: Route, index: int) -> float:
    """How far beside the leg to a waypoint the corners at its ends may lead."""
    beside_m = 0.0
    for corner in (index - 1, index):
        if route.curved and 0 < corner < len(route.points_m) - 1:
            reach_m, sine = _reach_m(route, corner)
            beside_m = max(beside_m, 0.5 * reach_m * sine)
    return beside_m


def _round(
    flight: Flight,
    route: Route,
    corner: int,
    times_s: tuple[float, float],
    seconds_per_m: tuple[float, float],
) -> None:
    """The curve itself, as far as it is still ahead, at the times that its legs are flown.

    `times_s`: when the leg to the corner begins and when the corner would be reached.
    """
    reach_m, _sine = _reach_m(route, corner)
    before_m, corner_m, after_m = route.points_m[corner - 1 : corner + 2]
    back_m, on_m = before_m - corner_m, after_m - corner_m
    back_share = reach_m / float(np.hypot(*back_m[:2]))
    on_share = reach_m / float(np.hypot(*on_m[:2]))
    along = np.linspace(0.0, 1.0, 3 + int(2.0 * reach_m / STEP_M))[:, np.newaxis]
    curve_m = corner_m + (1.0 - along) ** 2 * back_share * back_m + along**2 * on_share * on_m
    begins_s, corner_s = times_s
    enters_s = corner_s - reach_m * seconds_per_m[0]
    leaves_s = corner_s + reach_m * seconds_per_m[1]
    at_s = np.interp(along[:, 0], [0.0, 0.5, 1.0], [enters_s, corner_s, leaves_s])
    ahead = at_s >= begins_s
    height_m = curve_m[ahead, 2]
    flight.instants(at_s[ahead], curve_m[ahead, :2], (height_m, height_m), possible=False)
