"""Temporary zones as keep-out zones of the airspace, and what may be drawn as one."""

from collections.abc import Iterator
from math import cos, pi

import numpy as np

from recon.geo import region_fault
from recon.model.airspace import HeightDatum, Region, Zone, ZoneKind
from recon.model.geo import LatLon, LocalFrame
from recon.model.temporary_zone import Circle, DrawnZone, TemporaryZone
from recon.safety.airspace import PreparedZone, prepared_zone
from recon.safety.datum import places_m

MOST_ZONES = 32
"""Most zones in force at the same time: the watchdogs check all of them ten times a second."""

MOST_CORNERS = 64
"""A person draws fewer; a finer outline costs time in every judgement."""

LEAST_RADIUS_M = 1.0
MOST_RADIUS_M = 2_000.0
"""Largest radius: more than a drone in sight can reach. To clear more sky, stop all."""
MOST_ACROSS_M = 2.0 * MOST_RADIUS_M
FARTHEST_M = 10_000.0
"""Largest distance from the site's origin: farther is an error, such as swapped coordinates."""

HIGHEST_M = 1_000.0
"""Largest height above ground: twice what DJI's aircraft can fly."""

LEAST_LASTS_S = 10.0
MOST_LASTS_S = 86_400.0
"""A day: what lasts longer belongs to the site's folder."""

MOST_REASON = 200
"""Characters: a reason is read in one line of an alarm."""

CIRCLE_CORNERS = 32
"""The polygon round a circle is 0.5 % larger at most, never smaller."""


def drawn_fault(drawn: DrawnZone, frame: LocalFrame) -> str | None:
    """Return why a zone cannot be drawn, and what to change; None when it can."""
    return next(_faults(drawn, frame), None)


def prepared_temporary_zone(zone: TemporaryZone, frame: LocalFrame) -> PreparedZone:
    """Return a zone in force as a keep-out zone of the site.

    Raises `ValueError` for one with a `drawn_fault`.
    """
    drawn = zone.drawn
    has_heights = drawn.floor_m is not None or drawn.ceiling_m is not None
    return prepared_zone(
        Zone(
            zone.name,
            ZoneKind.KEEP_OUT,
            drawn_region(drawn, frame),
            drawn.floor_m,
            drawn.ceiling_m,
            HeightDatum.GROUND if has_heights else None,
        )
    )


def drawn_region(drawn: DrawnZone, frame: LocalFrame) -> Region:
    """Return its outline in the site's frame; a circle as the polygon round it."""
    shape = drawn.shape
    if not isinstance(shape, Circle):
        return Region(places_m(frame, shape.corners))
    turns = 2.0 * pi * np.arange(CIRCLE_CORNERS) / CIRCLE_CORNERS
    radius_m = shape.radius_m / cos(pi / CIRCLE_CORNERS)
    round_m = radius_m * np.stack([np.sin(turns), np.cos(turns)], axis=1)
    return Region(places_m(frame, [shape.centre])[0] + round_m)


def _faults(drawn: DrawnZone, frame: LocalFrame) -> Iterator[str]:
    """Yield faults; only the first is used, as later checks may rely on its absence."""
    if not 0 < len(drawn.reason.strip()) <= MOST_REASON:
        yield f"a reason of 1 to {MOST_REASON} characters is needed, for those who read the alarm"
    yield from _height_faults(drawn)
    lasts_s = drawn.lasts_s
    if lasts_s is not None and not LEAST_LASTS_S <= lasts_s <= MOST_LASTS_S:
        yield (
            f"it would last {lasts_s:g} s: {LEAST_LASTS_S:g} to {MOST_LASTS_S:g} s are possible, "
            "or no end at all"
        )
    shape = drawn.shape
    if isinstance(shape, Circle):
        yield from _circle_faults(shape, frame)
    else:
        yield from _outline_faults(shape.corners, drawn, frame)


def _height_faults(drawn: DrawnZone) -> Iterator[str]:
    for name, height_m in (("floor", drawn.floor_m), ("ceiling", drawn.ceiling_m)):
        if height_m is not None and not 0.0 <= height_m <= HIGHEST_M:
            yield f"its {name} is {height_m:g} m: 0 to {HIGHEST_M:g} m above ground are possible"
    floor_m, ceiling_m = drawn.floor_m, drawn.ceiling_m
    if ceiling_m is not None and not (floor_m or 0.0) < ceiling_m:
        yield f"its ceiling of {ceiling_m:g} m is not above its floor of {floor_m or 0.0:g} m"


def _circle_faults(circle: Circle, frame: LocalFrame) -> Iterator[str]:
    if not LEAST_RADIUS_M <= circle.radius_m <= MOST_RADIUS_M:
        yield (
            f"its radius is {circle.radius_m:g} m: {LEAST_RADIUS_M:g} to {MOST_RADIUS_M:g} m are "
            "possible; to clear more, use the all stop"
        )
    yield from _place_faults((circle.centre,), frame)


def _outline_faults(
    corners: tuple[LatLon, ...], drawn: DrawnZone, frame: LocalFrame
) -> Iterator[str]:
    if not 3 <= len(corners) <= MOST_CORNERS:
        yield f"it has {len(corners)} corners: 3 to {MOST_CORNERS} are possible"
    else:
        yield from _place_faults(corners, frame)
        yield from _region_faults(drawn_region(drawn, frame))


def _region_faults(region: Region) -> Iterator[str]:
    fault = region_fault(region)
    if fault is not None:
        yield f"its outline cannot be used: {fault}"
    across_m = float((region.outline_m.max(axis=0) - region.outline_m.min(axis=0)).max())
    if across_m > MOST_ACROSS_M:
        yield (
            f"it is {across_m:.0f} m across: {MOST_ACROSS_M:g} m at most are possible; to clear "
            "more, use the all stop"
        )


def _place_faults(places: tuple[LatLon, ...], frame: LocalFrame) -> Iterator[str]:
    if not all(place.is_valid() for place in places):
        yield "a place of it is not on the globe: latitude -90 to 90, longitude -180 to 180 degrees"
    far_m = float(np.hypot(*places_m(frame, places).T).max())
    if far_m > FARTHEST_M:
        yield (
            f"it is {far_m / 1000:.1f} km from the site's origin: {FARTHEST_M / 1000:g} km at most "
            "are possible; check latitude and longitude"
        )
