"""Shapes as a site takes them: closed, named once each, with no more corners than it holds."""

from collections.abc import Iterator
from math import cos, isfinite, radians
from typing import Any

from recon.fields.limits import (
    MOST_CORNERS,
    MOST_CORNERS_IN_ALL,
    MOST_FEATURES,
    MOST_NAMED,
    SIMPLIFIED_WITHIN_M,
)
from recon.fields.names import LONGEST, cleaned, each_once
from recon.fields.shape import FieldFileError, Found, Position, Shape
from recon.model.units import M_PER_DEG

DECIMALS = 8
"""Decimals of a degree: a millimetre."""


def tidied(found: Found, *, close_paths: bool) -> dict[str, Any]:
    """Return shapes as GeoJSON with their names, what is excluded and why, and warnings.

    Raises `FieldFileError` for more than a site can hold.
    """
    kept: list[tuple[Shape, dict[str, Any]]] = []
    for shape in found.shapes:
        geometry = _geometry(shape, found, close_paths=close_paths)
        if geometry is not None:
            kept.append((shape, geometry))
    if len(kept) > MOST_FEATURES:
        raise FieldFileError(
            f"expected at most {MOST_FEATURES} features, got {len(kept)}; export fewer fields"
        )
    corners = sum(len(ring) for _, geometry in kept for ring in _rings(geometry))
    if corners > MOST_CORNERS_IN_ALL:
        raise FieldFileError(
            f"expected at most {MOST_CORNERS_IN_ALL} corners in all features, got {corners}; "
            "export fewer fields, or simplify the shapes"
        )
    names = each_once(list(_names([shape for shape, _ in kept])))
    return {
        "features": [
            {"name": name, "geometry": geometry, "layer": each.layer, "attributes": each.attributes}
            for name, (each, geometry) in zip(names, kept, strict=True)
        ],
        "excluded": _excluded(found.excluded),
        "warnings": found.warnings,
        "is_fit_for_fences": found.is_fit_for_fences,
        "has_open_paths": found.has_open_paths,
    }


def _rings(geometry: dict[str, Any]) -> list[list[list[float]]]:
    coordinates: Any = geometry["coordinates"]
    return [[coordinates]] if geometry["type"] == "Point" else coordinates


def _names(shapes: list[Shape]) -> Iterator[str]:
    """Yield a name for each shape; the parts of one are numbered."""
    counts: dict[tuple[int, str], int] = {}
    for shape in shapes:
        key = shape.feature, shape.kind
        counts[key] = counts.get(key, 0) + 1
    parts: dict[tuple[int, str], int] = {}
    for shape in shapes:
        key, name = (shape.feature, shape.kind), cleaned(shape.name)
        parts[key] = parts.get(key, 0) + 1
        ending = f", part {parts[key]}" if name and counts[key] > 1 else ""
        yield name[: LONGEST - len(ending)] + ending


def _excluded(excluded: list[tuple[str, str]]) -> list[dict[str, str]]:
    named = [{"name": cleaned(name), "reason": why} for name, why in excluded[:MOST_NAMED]]
    rest = len(excluded) - len(named)
    return named if not rest else [*named, {"name": "", "reason": f"{rest} more shapes"}]


def _geometry(shape: Shape, found: Found, *, close_paths: bool) -> dict[str, Any] | None:
    """Return a shape as GeoJSON; None if it is excluded, with the reason added."""
    places = [place for ring in shape.rings for place in ring]
    off = next((place for place in places if not _is_on_earth(place)), None)
    if off is not None or not places:
        found.exclude(
            shape.name, f"expected longitudes and latitudes on the globe, got {_shown(off)}"
        )
        return None
    if shape.kind == "point":
        return {"type": "Point", "coordinates": _written(shape.rings[0][:1])[0]}
    if shape.kind == "path" and not _is_area(shape, found, close_paths=close_paths):
        return None
    rings = [_without_repeats(ring) for ring in shape.rings]
    if len(rings[0]) < 3:
        found.exclude(shape.name, f"{len(rings[0])} different corners: an area has three and more")
        return None
    if shape.kind == "path":
        found.warnings.append(f"{cleaned(shape.name) or 'a path'}: the path is taken as an area")
    holes = [ring for ring in rings[1:] if len(ring) >= 3]
    if len(holes) < len(rings) - 1:
        found.exclude(shape.name, "a hole with fewer than three corners")
    rings = [rings[0], *holes]
    if sum(map(len, rings)) >= MOST_CORNERS:
        rings = _simplified(shape.name, rings, found)
    if sum(map(len, rings)) >= MOST_CORNERS:
        reason = f"more than {MOST_CORNERS} corners: simplify it in the program that drew it"
        found.exclude(shape.name, reason)
        return None
    return {"type": "Polygon", "coordinates": [_written([*ring, ring[0]]) for ring in rings]}


def _is_area(path: Shape, found: Found, *, close_paths: bool) -> bool:
    """Return whether a path is taken as an area: it ends where it begins, or it was asked for."""
    (places,) = path.rings
    if close_paths or (len(places) > 3 and places[0][:2] == places[-1][:2]):
        return True
    found.has_open_paths = True
    found.exclude(
        path.name, f"a path of {len(places)} points, not an area: close paths to take it as one"
    )
    return False


def _is_on_earth(place: Position) -> bool:
    longitude, latitude = place[:2]
    return isfinite(longitude) and abs(longitude) <= 180.0 and abs(latitude) <= 90.0


def _shown(off: Position | None) -> str:
    if off is None:
        return "none"
    is_swapped = abs(off[0]) <= 90.0 and abs(off[1]) <= 180.0
    hint = "; latitude and longitude look swapped: the longitude is first" if is_swapped else ""
    return f"{off[0]:.6g}, {off[1]:.6g}{hint}"


def _without_repeats(ring: list[Position]) -> list[Position]:
    """Return a ring's corners, without the last where it is the first again."""
    corners = [place[:2] for place in ring]
    kept = [now for now, before in zip(corners, [None, *corners], strict=False) if now != before]
    while len(kept) > 1 and kept[0] == kept[-1]:
        kept.pop()
    return kept


def _simplified(name: str, rings: list[list[Position]], found: Found) -> list[list[Position]]:
    import shapely

    east_m = M_PER_DEG * cos(radians(rings[0][0][1]))
    scaled = [[(x * east_m, y * M_PER_DEG) for x, y in ring] for ring in rings]
    thin = shapely.simplify(shapely.Polygon(scaled[0], scaled[1:]), SIMPLIFIED_WITHIN_M)
    fewer = [
        [(x / east_m, y / M_PER_DEG) for x, y in ring.coords[:-1]]
        for ring in (thin.exterior, *thin.interiors)
    ]
    before, after = (sum(map(len, each)) for each in (rings, fewer))
    found.warnings.append(
        f"{cleaned(name) or 'an area'}: {before} corners are simplified to {after}, within "
        f"{SIMPLIFIED_WITHIN_M * 100:g} cm"
    )
    return fewer


def _written(places: list[Position]) -> list[list[float]]:
    return [[round(x, DECIMALS), round(y, DECIMALS)] for x, y in places]
