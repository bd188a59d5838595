"""A site's air made ready for many questions."""

from collections.abc import Iterable
from copy import copy
from dataclasses import dataclass, replace
from math import isfinite
from typing import NamedTuple

import numpy as np

from recon.geo import Box, Footprints, Polygon, Surface
from recon.model.airspace import Airspace, Zone, ZoneKind
from recon.model.arrays import BoolArray, FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class PreparedZone:
    """A zone and its polygon."""

    zone: Zone
    polygon: Polygon


def prepared_zone(zone: Zone) -> PreparedZone:
    """Return a zone prepared for many questions; raises `ValueError` for an invalid polygon."""
    return PreparedZone(zone, Polygon(zone.region))


class Cylinder(NamedTuple):
    """A circle on the ground and a band of heights, up_m of the frame."""

    east_m: float
    north_m: float
    radius_m: float
    low_m: float
    high_m: float

    @property
    def box(self) -> Box:
        """The box round the circle."""
        east_m, north_m, radius_m = self[:3]
        return Box(east_m - radius_m, north_m - radius_m, east_m + radius_m, north_m + radius_m)


class PreparedAirspace:
    """An airspace whose polygons and ground are prepared once; build one for each site, keep it.

    It does not change: `with_temporary_zones` returns another one, which shares what is prepared.

    Heights of the ground are up_m: ellipsoidal, minus that of the frame's origin. Without an
    elevation model the ground is flat at 0; with one, ground outside it is NaN, the
    highest of it +inf and the lowest -inf.
    Raises `ValueError` for an invalid polygon, an elevation model that is no surface, and for
    any of them without the frame whose metres they are in.
    """

    def __init__(self, airspace: Airspace) -> None:
        if airspace.frame is None and (
            airspace.boundary is not None or airspace.zones or airspace.elevation is not None
        ):
            raise ValueError("expected a frame for boundary, zones and elevation, got none")
        self.airspace = airspace
        boundary = airspace.boundary
        self.boundary = None if boundary is None else Polygon(boundary)
        self._site_zones = tuple(prepared_zone(zone) for zone in airspace.zones)
        self._take_zones(self._site_zones)
        self._ground = _ground(airspace)

    def with_temporary_zones(self, zones: Iterable[PreparedZone]) -> "PreparedAirspace":
        """Return the site's airspace with these zones besides its own, and no others.

        Boundary, ground and the site's zones are shared, not prepared again. Raises `ValueError`
        for zones without the frame whose metres they are in.
        """
        temporary = tuple(zones)
        if temporary and self.airspace.frame is None:
            raise ValueError("expected a frame for temporary zones, got none")
        changed = copy(self)
        own = tuple(prepared.zone for prepared in self._site_zones)
        added = tuple(prepared.zone for prepared in temporary)
        changed.airspace = replace(self.airspace, zones=(*own, *added))
        changed._take_zones((*self._site_zones, *temporary))
        return changed

    @property
    def temporary_zones(self) -> tuple[PreparedZone, ...]:
        """The zones besides the site's own."""
        return self.zones[len(self._site_zones) :]

    def _take_zones(self, zones: tuple[PreparedZone, ...]) -> None:
        self.zones = zones
        self._zones = {kind: _boxed(zones, kind) for kind in ZoneKind}
        self._boxes = {kind: _box_values(*boxed[1:]) for kind, boxed in self._zones.items()}

    @property
    def origin_height_m(self) -> float:
        """The ellipsoidal height that up_m counts from; 0 without a frame."""
        frame = self.airspace.frame
        return 0.0 if frame is None else frame.origin.ellipsoid_height_m

    def zones_near(
        self, kind: ZoneKind, footprints: Footprints, gap_m: float
    ) -> list[PreparedZone]:
        """Return the zones of a kind, in the site's order, that any footprint may be near to.

        The others' boxes are more than `gap_m` from the box round each footprint. What is not
        finite may be near to every zone.
        """
        zones, least_m, most_m = self._zones[kind]
        if not any(footprints.box.meets(box, gap_m) for box in self._boxes[kind]):
            return []
        if not footprints.is_finite.all():
            return list(zones)
        # Each for itself: the box round them all is often near, for vehicles fly all over a site.
        reaches = footprints.least_m <= (most_m + gap_m)[:, np.newaxis]
        reaches &= footprints.most_m >= (least_m - gap_m)[:, np.newaxis]
        is_near = (reaches[..., 0] & reaches[..., 1]).any(axis=1)
        return [zones[index] for index in np.flatnonzero(is_near)]

    def may_touch_zone(self, kinds: Iterable[ZoneKind], cylinder: Cylinder) -> bool:
        """Return whether a circle's box meets a box round a zone of these kinds: in doubt yes."""
        east_m, north_m, radius_m = cylinder[:3]
        if not (isfinite(east_m) and isfinite(north_m) and isfinite(radius_m)):
            return True
        around = cylinder.box
        return any(around.meets(box, 0.0) for kind in kinds for box in self._boxes[kind])

    def is_surely_above(self, box: Box, low_m: float, height_m: float) -> bool:
        """Return whether what is in a box, and no lower than `low_m`, is nowhere less than a height
        above ground, whatever ground of the site is below it: in doubt not."""
        if self._ground is None:
            return low_m - height_m >= 0.0
        return self._ground.covers(box) and low_m - height_m >= self._ground.highest_of_all_m

    def is_surely_below(self, box: Box, high_m: float, height_m: float) -> bool:
        """Return the same of what is no higher than `high_m`, and nowhere more above ground."""
        if self._ground is None:
            return high_m - height_m <= 0.0
        return self._ground.covers(box) and high_m - height_m <= self._ground.lowest_of_all_m

    def is_surely_between_heights(self, cylinder: Cylinder) -> bool:
        """Return whether a cylinder keeps the height limits whatever ground of the site is below
        it: in doubt not."""
        limits, box = self.airspace.limits, cylinder.box
        return self.is_surely_above(
            box, cylinder.low_m, limits.min_height_above_ground_m
        ) and self.is_surely_below(box, cylinder.high_m, limits.max_height_above_ground_m)

    def zones_of(self, kind: ZoneKind) -> tuple[PreparedZone, ...]:
        """Return the zones of one kind, in the site's order."""
        return self._zones[kind][0]

    def ground_up_m(self, points_m: FloatArray) -> FloatArray:
        """Return the ground's heights (N,) at (N, 2) east-north points."""
        return np.zeros(len(points_m)) if self._ground is None else self._ground.heights_m(points_m)

    def ground_within_up_m(self, triangles_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the lowest and highest ground (N,) under (N, 3, 2) triangles, exactly."""
        if self._ground is None:
            return np.zeros(len(triangles_m)), np.zeros(len(triangles_m))
        return self._ground.lowest_within_m(triangles_m), self._ground.highest_within_m(triangles_m)

    def is_ground_below(self, triangles_m: FloatArray, up_m: FloatArray) -> BoolArray:
        """Return under which of (N, 3, 2) triangles no ground is higher than `up_m` (N,)."""
        if self._ground is None:
            return np.asarray(up_m >= 0.0)
        return self._ground.is_below(triangles_m, up_m)

    def is_ground_above(self, triangles_m: FloatArray, up_m: FloatArray) -> BoolArray:
        """Return under which of (N, 3, 2) triangles no ground is lower than `up_m` (N,)."""
        if self._ground is None:
            return np.asarray(up_m <= 0.0)
        return self._ground.is_above(triangles_m, up_m)


def _boxed(
    zones: tuple[PreparedZone, ...], kind: ZoneKind
) -> tuple[tuple[PreparedZone, ...], FloatArray, FloatArray]:
    """The N zones of a kind and the boxes around them, (N, 2) each."""
    chosen = tuple(zone for zone in zones if zone.zone.kind is kind)
    outlines = [zone.zone.region.outline_m for zone in chosen]
    least_m = np.array([outline.min(axis=0) for outline in outlines]).reshape(len(chosen), 2)
    most_m = np.array([outline.max(axis=0) for outline in outlines]).reshape(len(chosen), 2)
    return chosen, least_m, most_m


def _box_values(least_m: FloatArray, most_m: FloatArray) -> list[Box]:
    """The same boxes for comparing one at a time."""
    return [Box(*box) for box in np.concatenate([least_m, most_m], axis=1).tolist()]


def _ground(airspace: Airspace) -> Surface | None:
    model, frame = airspace.elevation, airspace.frame
    if model is None or frame is None:
        return None
    return Surface(model.grid, model.ellipsoid_height_m - frame.origin.ellipsoid_height_m)


OPEN_AIRSPACE = PreparedAirspace(Airspace())
"""No site: no fence is known, the limits' defaults hold."""
