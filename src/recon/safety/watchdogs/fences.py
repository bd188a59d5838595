"""Looks ahead for the boundary and for zones: alarms, and stops what is about to leave or enter.

It checks where each vehicle is, and the path it will go in 1.25 times the time in which
it would cover its stopping distance: straight on, or along its commanded path. A vehicle that
is about to go out, or into a keep-out zone, is held. One that is there already raises an alarm,
and held only while it goes deeper. A landing or return is not stopped, and a vehicle under
pilot control only raises an alarm.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from recon.geo import Footprints, Polygon
from recon.model.airspace import ZoneKind
from recon.model.arrays import BoolArray, FloatArray, IntArray
from recon.model.failsafe_matrix import FailsafeCondition
from recon.model.geo import LocalFrame
from recon.model.severity import Severity
from recon.safety.airspace import PreparedAirspace, PreparedZone
from recon.safety.datum import places_m
from recon.safety.heights import height_text, stays_above, stays_below, zone_datum
from recon.safety.prediction.motion import VehicleMotion
from recon.safety.prediction.trajectory import ALL_HEIGHTS_M
from recon.safety.watchdogs.reach import last_known_place, near_limits, path_ahead_s
from recon.safety.watchdogs.traffic_picture import Finding, TrafficPicture, WatchedVehicle

NEAR_HOME_M = 15.0
"""Takeoffs and landings are low by nature: a vehicle this near to its home is on one."""

FENCE, ZONE, HEIGHT = "fence_ahead", "zone_ahead", "height_limit"

DEEPER_M = 0.5
"""A vehicle on the wrong side may drift this much before it counts as going deeper."""


@dataclass(frozen=True, slots=True, eq=False)
class PathAhead:
    """Present and predicted positions of N vehicles, (N, 2) in the site's frame, and the heights
    between, (N,) up metres. `ahead` are the hulls of the ways, from (N, 3, 2) `triangles_m`."""

    here_m: FloatArray
    there_m: FloatArray
    triangles_m: FloatArray
    ahead: Footprints
    low_m: FloatArray
    high_m: FloatArray
    is_near_home: BoolArray


def fences(picture: TrafficPicture) -> Iterator[Finding]:
    """Find vehicles that are, or will soon be, outside the site's limits."""
    frame = picture.airspace.airspace.frame
    if frame is None:
        return
    reaches, settings = picture.reaches, picture.settings
    if reaches is not None:
        near = near_limits(reaches, picture.airspace, frame, settings, picture.prediction)
        picture = picture.only(near)
    if not picture.flying:
        return
    path = path_ahead(picture, frame)
    if picture.airspace.boundary is not None:
        yield from _boundary(picture, path, picture.airspace.boundary)
    for zone in picture.airspace.zones_near(ZoneKind.KEEP_OUT, path.ahead, 0.0):
        yield from _keep_out(picture, path, zone)
    for zone in picture.airspace.zones_near(ZoneKind.HEIGHT, path.ahead, 0.0):
        yield from _heights(picture, path, zone)
    yield from _limits(picture, path)


def _boundary(picture: TrafficPicture, path: PathAhead, fence: Polygon) -> Iterator[Finding]:
    for index in np.flatnonzero(~fence.holds(path.ahead)):
        inside_m, later_m = _depths_m(path, fence, int(index))
        is_out = inside_m < 0.0
        if is_out:
            text = f"is {-inside_m:.0f} m outside the site's boundary"
            stops = later_m < inside_m - DEEPER_M
        else:
            text, stops = "is about to leave the site's boundary", True
        yield _found(picture, int(index), FENCE, text, is_bad=is_out, stops=stops)


def _keep_out(picture: TrafficPicture, path: PathAhead, zone: PreparedZone) -> Iterator[Finding]:
    indices = np.flatnonzero(~zone.polygon.is_clear_of(path.ahead))
    name = zone.zone.name
    # A person drew it for what is there now: no site leaves that to an alarm.
    row = None if zone in picture.airspace.temporary_zones else FailsafeCondition.GEOFENCE
    for index in indices[_has_its_heights(picture.airspace, path, zone, indices)]:
        inside_m, later_m = _depths_m(path, zone.polygon, int(index))
        is_in = inside_m >= 0.0
        if is_in:
            text = f"is in the keep-out zone {name!r}"
            stops = later_m > inside_m + DEEPER_M
        else:
            text, stops = f"is about to enter the keep-out zone {name!r}", True
        yield _found(
            picture, int(index), ZONE, text, about=name, is_bad=is_in, stops=stops, row=row
        )


def _heights(picture: TrafficPicture, path: PathAhead, zone: PreparedZone) -> Iterator[Finding]:
    """Yield alarms about heights, without a hold: hovering too low or too high is no better.

    An unknown height is neither.
    """
    airspace, name, datum = picture.airspace, zone.zone.name, zone_datum(zone.zone)
    indices = np.flatnonzero(~zone.polygon.is_clear_of(path.ahead) & _is_height_known(path))
    triangles_m = path.triangles_m[indices]
    floor_m, ceiling_m = zone.zone.floor_m, zone.zone.ceiling_m
    if ceiling_m is not None:
        is_over = ~stays_below(airspace, triangles_m, path.high_m[indices], ceiling_m, datum)
        text = f"is too high, or soon will be: at most {height_text(ceiling_m, datum)} in {name!r}"
        for index in indices[is_over]:
            yield _found(picture, int(index), HEIGHT, text, about=name)
    if floor_m is not None:
        is_under = ~stays_above(airspace, triangles_m, path.low_m[indices], floor_m, datum)
        text = f"is too low, or soon will be: at least {height_text(floor_m, datum)} in {name!r}"
        for index in indices[is_under & ~_may_be_low(picture, path)[indices]]:
            yield _found(picture, int(index), HEIGHT, text, about=name)


def _limits(picture: TrafficPicture, path: PathAhead) -> Iterator[Finding]:
    """The site's own least and greatest height; outside the elevation model it is too high."""
    airspace, limits = picture.airspace, picture.airspace.airspace.limits
    most_m, least_m = limits.max_height_above_ground_m, limits.min_height_above_ground_m
    is_known = _is_height_known(path)
    is_over = is_known & ~stays_below(airspace, path.triangles_m, path.high_m, most_m)
    for index in np.flatnonzero(is_over):
        text = f"is higher above ground than {most_m:g} m, or soon will be"
        yield _found(picture, int(index), HEIGHT, text)
    is_under = ~stays_above(airspace, path.triangles_m, path.low_m, least_m)
    for index in np.flatnonzero(is_under & ~is_over & is_known & ~_may_be_low(picture, path)):
        text = f"is lower above ground than {least_m:g} m, or soon will be"
        yield _found(picture, int(index), HEIGHT, text)


def _is_height_known(path: PathAhead) -> BoolArray:
    return np.asarray(path.high_m < 0.5 * ALL_HEIGHTS_M)


def _has_its_heights(
    airspace: PreparedAirspace, path: PathAhead, zone: PreparedZone, indices: IntArray
) -> BoolArray:
    """Which of these vehicles' paths have a height that is the zone's."""
    datum, ceiling_m, floor_m = zone_datum(zone.zone), zone.zone.ceiling_m, zone.zone.floor_m
    triangles_m = path.triangles_m[indices]
    is_over = is_under = np.zeros(len(indices), dtype=np.bool_)
    if ceiling_m is not None:
        is_over = stays_above(airspace, triangles_m, path.low_m[indices], ceiling_m, datum)
    if floor_m is not None:
        is_under = stays_below(airspace, triangles_m, path.high_m[indices], floor_m, datum)
    return np.asarray(~(is_over | is_under))


def _may_be_low(picture: TrafficPicture, path: PathAhead) -> BoolArray:
    """Who takes off or lands."""
    is_coming_down = [watched.is_coming_down for watched in picture.flying]
    return np.asarray(path.is_near_home | is_coming_down)


def _depths_m(path: PathAhead, polygon: Polygon, index: int) -> tuple[float, float]:
    """How far inside a vehicle is now and at the end of its path; negative outside."""
    both_m = np.stack([path.here_m[index], path.there_m[index]])
    now_m, later_m = polygon.distance_to_edge_m(both_m)
    return float(now_m), float(later_m)


def _found(
    picture: TrafficPicture,
    index: int,
    rule: str,
    text: str,
    *,
    about: str = "",
    is_bad: bool = False,
    stops: bool = False,
    row: FailsafeCondition | None = FailsafeCondition.GEOFENCE,
) -> Finding:
    watched = picture.flying[index]
    severity = Severity.CRITICAL if is_bad else Severity.ERROR
    if stops and watched.hold_outcome:
        text = f"{text}; {watched.name} {watched.hold_outcome}"
    finding = watched.finding(rule, severity, text, about=f":{about}" if about else "")
    is_due = picture.lasted_s(finding.key) >= picture.settings.confirm_s
    may_be_held = watched.may_be_held_for(row)
    if not (stops and is_due and may_be_held) or watched.is_coming_down:
        return finding
    if watched.was_held_within_s(picture.now_ns, picture.settings.hold_again_s):
        return finding
    return replace(finding, holds=watched.state.serial)


def path_ahead(picture: TrafficPicture, frame: LocalFrame) -> PathAhead:
    """Return the paths of a picture's flying vehicles, of which there must be one.

    Each ends at the first sample that is not before `path_ahead_s`.
    """
    motions = [_motion(watched) for watched in picture.flying]
    settings, prediction = picture.settings, picture.prediction
    ends_s = [path_ahead_s(motion.speed_mps, settings, prediction) for motion in motions]
    last = np.searchsorted(picture.ahead.times_s, ends_s)
    here_m = places_m(frame, [last_known_place(motion.state) for motion in motions])
    last_known_m = _last_known_m(motions)
    at_m = _at_m(picture, np.stack([np.zeros_like(last), (last + 1) // 2, last], axis=1))
    # Exact at the vehicles' last positions, and from there on in the plane, which suffices.
    triangles_m = here_m[:, np.newaxis] + at_m - last_known_m[:, np.newaxis]
    flies, rows = picture.ahead.as_it_flies, np.arange(len(motions))
    return PathAhead(
        here_m=triangles_m[:, 0],
        there_m=triangles_m[:, 2],
        triangles_m=triangles_m,
        ahead=Footprints(triangles_m),
        low_m=np.minimum(flies.low_m[rows, 0], flies.low_m[rows, last]),
        high_m=np.maximum(flies.high_m[rows, 0], flies.high_m[rows, last]),
        is_near_home=_is_near_home(motions),
    )


def _motion(watched: WatchedVehicle) -> VehicleMotion:
    """The motion that every vehicle flying in contact has."""
    assert watched.motion is not None
    return watched.motion


def _last_known_m(motions: Sequence[VehicleMotion]) -> FloatArray:
    return np.array([(motion.east_m, motion.north_m) for motion in motions])


def _at_m(picture: TrafficPicture, index: IntArray) -> FloatArray:
    """Where each vehicle is at M of the moments (N, M): (N, M, 2) in the plane."""
    flies, rows = picture.ahead.as_it_flies, np.arange(len(index))[:, np.newaxis]
    return np.stack([flies.east_m[rows, index], flies.north_m[rows, index]], axis=2)


def _is_near_home(motions: Sequence[VehicleMotion]) -> BoolArray:
    homes_m = np.array([motion.home_m or (np.nan, np.nan) for motion in motions])
    east_m, north_m = (_last_known_m(motions) - homes_m).T
    # For an unknown home the comparison is False.
    return np.asarray(np.hypot(east_m, north_m) <= NEAR_HOME_M)
