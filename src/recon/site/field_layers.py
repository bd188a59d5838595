"""The layers of a field, from its outlines: regions, a boundary around them, pads at their edge."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo import enu_from_geo, geojson_geometry
from recon.model.airspace import SiteLayer
from recon.model.arrays import FloatArray
from recon.model.errors import SiteError
from recon.model.geo import LocalFrame
from recon.site.drawing import DrawnFeature

LEAST_MARGIN_M, USUAL_MARGIN_M, MOST_MARGIN_M = 20.0, 30.0, 300.0
"""Margin from field to boundary: the least one has room for a pad 10 m from crop and boundary."""
FARTHEST_PAD_M = 15.0
"""Pads are halfway to the boundary, and no farther than this from the crop."""
PADS_APART_M = 25.0
"""The gate wants 18 m between two that climb; the rest is for position errors."""
CORNERS_WITHIN_M = 1.0
"""The boundary's corners are simplified by this much at most."""
LONGEST_CORNER = 2.0
"""A sharp corner of the boundary is cut off at twice the margin."""
SQUARE_M = 200.0
"""Side of the field that stands for one without an outline: 4 ha."""


@dataclass(frozen=True, slots=True, eq=False)
class FieldLayers:
    """The layers of a field, and how far a drone flies in it."""

    features: tuple[DrawnFeature, ...]
    farthest_m: float
    """From a pad to the farthest corner of the boundary."""


def square_field(frame: LocalFrame) -> dict[str, Any]:
    """Return a square around the origin as GeoJSON: the field of a person who has no file."""
    half_m = SQUARE_M / 2.0
    return _geojson(frame, shapely.box(-half_m, -half_m, half_m, half_m))


def field_layers(
    frame: LocalFrame,
    regions: Mapping[str, Mapping[str, Any]],
    vehicles: Mapping[str, str],
    margin_m: float,
) -> FieldLayers:
    """Return regions, boundary and pads; `regions` are GeoJSON polygons by name.

    `vehicles` are names by serial: each gets a pad. Raises `SiteError` for a margin out of range,
    and where there is no room for the pads.
    """
    if not LEAST_MARGIN_M <= margin_m <= MOST_MARGIN_M:
        raise SiteError(
            f"expected a margin of {LEAST_MARGIN_M:g} to {MOST_MARGIN_M:g} m, got {margin_m:g} m"
        )
    field = shapely.union_all([_shape_m(frame, geometry) for geometry in regions.values()])
    boundary = shapely.simplify(_around(field, margin_m), CORNERS_WITHIN_M)
    pads_m = _pads_m(field, min(margin_m / 2.0, FARTHEST_PAD_M), len(vehicles))
    features = (
        DrawnFeature(SiteLayer.BOUNDARY, _geojson(frame, boundary), {"name": "boundary"}),
        *(
            DrawnFeature(SiteLayer.SURVEY_REGIONS, geometry, {"name": name})
            for name, geometry in regions.items()
        ),
        *(
            _pad(frame, serial, name, place_m)
            for (serial, name), place_m in zip(vehicles.items(), pads_m, strict=True)
        ),
    )
    corners = shapely.points(shapely.get_coordinates(boundary))
    farthest_m = max(
        (shapely.distance(corners, shapely.Point(at)).max() for at in pads_m), default=0.0
    )
    return FieldLayers(features, float(farthest_m))


def _geojson(frame: LocalFrame, shape_m: shapely.Geometry) -> dict[str, Any]:
    """Return a shape as it is read from a file: lists, not tuples."""
    geometry: dict[str, Any] = json.loads(json.dumps(geojson_geometry(frame, shape_m)))
    return geometry


def _shape_m(frame: LocalFrame, geometry: Mapping[str, Any]) -> shapely.Geometry:
    def east_north_m(lon_lat: FloatArray) -> FloatArray:
        ground_m = frame.origin.ellipsoid_height_m
        return enu_from_geo(frame, lon_lat[:, 1], lon_lat[:, 0], ground_m)[:, :2]

    shape = shapely.force_2d(shapely.geometry.shape(geometry))
    return shapely.make_valid(shapely.transform(shape, east_north_m))


def _around(field: shapely.Geometry, margin_m: float) -> shapely.Polygon:
    """Return one outline at a distance from all of a field, without holes.

    Fields that lie farther apart share the hull around them: a site has one boundary.
    """
    area = shapely.buffer(field, margin_m, join_style="mitre", mitre_limit=LONGEST_CORNER)
    if not isinstance(area, shapely.Polygon):
        area = shapely.convex_hull(area)
    return shapely.Polygon(area.exterior)


def _pads_m(field: shapely.Geometry, off_m: float, count: int) -> Sequence[tuple[float, float]]:
    """Return places off the crop, 25 m from each other: in a row along the longest edge if there is
    room, then on around the field."""
    edge = _around(field, off_m).exterior
    corners_m = shapely.get_coordinates(edge)
    lengths_m = np.hypot(*np.diff(corners_m, axis=0).T)
    longest = int(lengths_m.argmax())
    middle_m = float(lengths_m[:longest].sum() + lengths_m[longest] / 2.0)
    # From the middle of the longest edge to both sides, a metre at a time.
    reach_m = edge.length / 2.0
    offsets_m = sorted(np.arange(-reach_m, reach_m).tolist(), key=abs)
    chosen: list[tuple[float, tuple[float, float]]] = []
    for offset_m in offsets_m:
        if len(chosen) == count:
            break
        place = edge.interpolate((middle_m + offset_m) % edge.length)
        if all(np.hypot(place.x - x, place.y - y) >= PADS_APART_M for _, (x, y) in chosen):
            chosen.append((offset_m, (place.x, place.y)))
    if len(chosen) < count:
        raise SiteError(
            f"expected at most {len(chosen)} vehicles, got {count}: the field's edge has no room "
            f"for more pads {PADS_APART_M:g} m apart"
        )
    return [place_m for _, place_m in sorted(chosen)]


def _pad(frame: LocalFrame, serial: str, name: str, place_m: tuple[float, float]) -> DrawnFeature:
    geometry = _geojson(frame, shapely.Point(place_m))
    altitude_m = frame.origin.ellipsoid_height_m
    properties = {"name": name, "serial": serial, "altitude_m": altitude_m}
    return DrawnFeature(SiteLayer.LANDING_PADS, geometry, properties)
