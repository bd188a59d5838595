"""What a site's air leaves for the way home: which heights, and where they are shut."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf

import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.guidance.fleet_return.flight import EastNorth
from recon.guidance.fleet_return.settings import FleetReturnSettings
from recon.model.airspace import Airspace, HeightDatum, Region, Zone, ZoneKind


@dataclass(frozen=True, slots=True, eq=False)
class Shut:
    """A region that is shut from `low_up_m` to `high_up_m`, either of which may be infinite.

    `is_shut_to_columns`: also to climbing and sinking on the spot, as a keep-out zone is; least
    heights do not hold for takeoff and landing.
    """

    name: str
    area: shapely.Geometry
    low_up_m: float
    high_up_m: float
    is_shut_to_columns: bool


@dataclass(frozen=True, slots=True, eq=False)
class WayHome:
    """The heights that layers may have, what is shut between them, and where the site ends.

    `lowest_up_m` above `highest_up_m`: there is no room for a layer. `boundary` None: no fence.
    `margin_m` is kept to the boundary and to what is shut.
    """

    lowest_up_m: float
    highest_up_m: float
    shut: tuple[Shut, ...]
    boundary: shapely.Geometry | None
    margin_m: float


OPEN_WAY_M = 10.0
"""The layers lie above a zone whose edge is this near to the hull of all vehicles and pads."""


def way_home(
    airspace: Airspace,
    ground_up_m: tuple[float, float],
    places_m: Sequence[EastNorth],
    settings: FleetReturnSettings,
) -> WayHome:
    """Return what holds for ways between these places (vehicles' and pads').

    `ground_up_m` is the lowest and the highest ground on the ways. A zone near the hull of the
    places is flown over where its top leaves room under the ceiling. Every other zone is flown
    around, however far away it is: a detour may leave the hull.
    """
    limits = airspace.limits
    margin_m = limits.boundary_margin_m + settings.detour_slack_m
    low_ground_m, high_ground_m = ground_up_m
    highest_m = low_ground_m + limits.max_height_above_ground_m - settings.ceiling_margin_m
    least_m = max(limits.min_height_above_ground_m, settings.lowest_layer_m)
    near = shapely.buffer(shapely.MultiPoint(places_m).convex_hull, margin_m + OPEN_WAY_M)
    origin_m = 0.0 if airspace.frame is None else airspace.frame.origin.ellipsoid_height_m
    shut = tuple(
        piece
        for zone in airspace.zones
        for piece in _shut_by(zone, origin_m, ground_up_m, settings)
    )
    tops_m = [
        piece.high_up_m
        for piece in shut
        if piece.high_up_m <= highest_m and shapely.intersects(piece.area, near)
    ]
    return WayHome(
        lowest_up_m=max([high_ground_m + least_m, *tops_m]),
        highest_up_m=highest_m,
        shut=shut,
        boundary=None if airspace.boundary is None else _area(airspace.boundary),
        margin_m=margin_m,
    )


def _shut_by(
    zone: Zone, origin_m: float, ground_up_m: tuple[float, float], settings: FleetReturnSettings
) -> Iterator[Shut]:
    """What a zone shuts; of uneven ground the side that is safe counts."""
    low_ground_m, high_ground_m = ground_up_m
    area = _area(zone.region)
    is_wgs84 = zone.datum is HeightDatum.WGS84

    def up_m(height_m: float | None, ground_m: float, otherwise_m: float) -> float:
        if height_m is None:
            return otherwise_m
        return height_m - origin_m if is_wgs84 else height_m + ground_m

    if zone.kind is ZoneKind.KEEP_OUT:
        low_m = up_m(zone.floor_m, low_ground_m, -inf) - settings.zone_margin_m
        high_m = up_m(zone.ceiling_m, high_ground_m, inf) + settings.zone_margin_m
        yield Shut(zone.name, area, low_m, high_m, is_shut_to_columns=True)
        return
    margin_m = settings.ceiling_margin_m
    if zone.floor_m is not None:
        floor_m = up_m(zone.floor_m, high_ground_m, -inf) + margin_m
        yield Shut(zone.name, area, -inf, floor_m, is_shut_to_columns=False)
    if zone.ceiling_m is not None:
        ceiling_m = up_m(zone.ceiling_m, low_ground_m, inf) - margin_m
        yield Shut(zone.name, area, ceiling_m, inf, is_shut_to_columns=False)


def _area(region: Region) -> shapely.Geometry:
    return shapely.Polygon(region.outline_m, list(region.holes_m))
