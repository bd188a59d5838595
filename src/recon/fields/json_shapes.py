"""GeoJSON geometries, and circles, which GeoJSON does not have."""

from collections.abc import Iterator
from math import cos, pi, radians, sin
from typing import Any

from recon.fields.shape import Attributes, Found, Position
from recon.model.units import M_PER_DEG

GEOMETRIES = frozenset(
    {
        *("Polygon", "MultiPolygon", "LineString", "MultiLineString", "Point", "MultiPoint"),
        "GeometryCollection",
    }
)
CIRCLE_CORNERS = 72


def add_geometry(
    geometry: object,
    name: str,
    found: Found,
    layer: str | None = None,
    attributes: Attributes | None = None,
) -> None:
    """Take a GeoJSON geometry's polygons, paths and points.

    Raises what Python raises for coordinates that are none.
    """
    if not isinstance(geometry, dict) or geometry.get("type") not in GEOMETRIES:
        found.exclude(name, "no shape")
        return
    kind: str = geometry["type"]
    if kind == "GeometryCollection":
        for part in geometry["geometries"]:
            add_geometry(part, name, found, layer, attributes)
        return
    parts, more = geometry["coordinates"], (layer, attributes)
    for part in parts if kind.startswith("Multi") else [parts]:
        match kind.removeprefix("Multi"):
            case "Polygon":
                found.add(name, "polygon", [_positions(ring) for ring in part], *more)
            case "LineString":
                found.add(name, "path", [_positions(part)], *more)
            case "Point":
                found.add(name, "point", [_positions([part])], *more)


def _positions(points: Any) -> list[Position]:
    return [(float(point[0]), float(point[1])) for point in points]


def circle(
    latitude_deg: float, longitude_deg: float, radius_m: float, *, is_inside: bool
) -> Iterator[Position]:
    """Yield corners on the safe side: inside a circle to stay in, outside one to keep out of."""
    reach_deg = radius_m / M_PER_DEG / (1.0 if is_inside else cos(pi / CIRCLE_CORNERS))
    for corner in range(CIRCLE_CORNERS):
        turn = 2.0 * pi * corner / CIRCLE_CORNERS
        east_deg = reach_deg * sin(turn) / cos(radians(latitude_deg))
        yield longitude_deg + east_deg, latitude_deg + reach_deg * cos(turn)
