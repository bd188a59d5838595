"""GeoJSON, and the plans of QGroundControl, which are JSON too."""

import json
from collections.abc import Mapping
from typing import Any

from recon.fields.airspace_zones import read_zone
from recon.fields.json_shapes import GEOMETRIES, add_geometry, circle
from recon.fields.names import name_among
from recon.fields.shape import FieldFileError, Found, Position

WGS84 = frozenset(
    {
        *("urn:ogc:def:crs:OGC:1.3:CRS84", "urn:ogc:def:crs:OGC::CRS84", "OGC:CRS84"),
        *("urn:ogc:def:crs:EPSG::4326", "EPSG:4326"),
    }
)
"""Names of WGS84 that programs write; the longitude comes first under each."""


def read_json(data: bytes) -> tuple[Found, str | None]:
    """Return what a file holds, and the CRS of its coordinates where it is not WGS84.

    Raises `FieldFileError`.
    """
    try:
        document = json.loads(data)
    except json.JSONDecodeError as problem:
        place = f"line {problem.lineno}, column {problem.colno}"
        raise FieldFileError(f"expected valid JSON, got invalid JSON at {place}") from problem
    except (ValueError, RecursionError) as problem:
        raise FieldFileError("expected JSON in UTF-8 that is not nested deeply, got other") from (
            problem
        )
    if not isinstance(document, dict):
        raise FieldFileError("expected a JSON object, got another value")
    if document.get("fileType") == "Plan":
        return _plan(document), None
    return _geojson(document)


def _geojson(document: dict[str, Any]) -> tuple[Found, str | None]:
    kind, features = document.get("type"), document.get("features")
    # ED-269 has features without a type of its own.
    is_list = kind in ("FeatureCollection", None)
    if not is_list:
        features = [document]
    if not (isinstance(features, list) and (is_list or kind in {"Feature", *GEOMETRIES})):
        raise FieldFileError(
            f"expected GeoJSON (a FeatureCollection, Feature or geometry) or a plan of "
            f"QGroundControl, got {str(kind)[:40]!a}"
        )
    found = Found()
    for number, feature in enumerate(features, start=1):
        _read_feature(number, feature, found)
    return found, _crs(document)


def _crs(document: Mapping[str, Any]) -> str | None:
    crs = document.get("crs")
    if crs is None:
        return None
    properties = crs.get("properties") if isinstance(crs, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else crs
    if not isinstance(name, str):
        raise FieldFileError("expected the name of a coordinate reference system, got none")
    return None if name in WGS84 else name


def _read_feature(number: int, feature: object, found: Found) -> None:
    if not isinstance(feature, dict):
        found.exclude(f"feature {number}", "no GeoJSON feature")
        return
    is_bare = feature.get("type") in GEOMETRIES
    properties = feature.get("properties")
    name = name_among(properties) if isinstance(properties, dict) and not is_bare else ""
    geometry = feature if is_bare else feature.get("geometry")
    found.begin_feature()
    try:
        if is_bare or not read_zone(feature, number, found):
            add_geometry(geometry, name, found)
    except (TypeError, ValueError, KeyError, IndexError, AttributeError, OverflowError):
        found.exclude(name or f"feature {number}", "coordinates that cannot be read")


def _plan(document: dict[str, Any]) -> Found:
    """Return the fence, the areas of surveys and the rally points of a plan."""
    found = Found()
    parts = (("geoFence", _read_fence), ("mission", _read_mission), ("rallyPoints", _read_rally))
    for key, read in parts:
        part = document.get(key)
        try:
            read(part if isinstance(part, dict) else {}, found)
        except (TypeError, ValueError, KeyError, IndexError, AttributeError, OverflowError):
            found.exclude(key, "a part of the plan that cannot be read")
    return found


def _read_fence(fence: Mapping[str, Any], found: Found) -> None:
    for number, each in enumerate(fence.get("polygons", []), start=1):
        found.begin_feature()
        found.add(_fence_name(each, number), "polygon", [_turned(each["polygon"])])
    for number, each in enumerate(fence.get("circles", []), start=1):
        found.begin_feature()
        round_one = each["circle"]
        latitude_deg, longitude_deg = round_one["center"]
        ring = list(
            circle(latitude_deg, longitude_deg, round_one["radius"], is_inside=each["inclusion"])
        )
        found.add(f"{_fence_name(each, number)}, circle", "polygon", [ring])


def _fence_name(fence: Mapping[str, Any], number: int) -> str:
    return f"fence {number}" if fence["inclusion"] else f"keep out {number}"


def _read_mission(mission: Mapping[str, Any], found: Found) -> None:
    waypoints: list[Position] = []
    for number, item in enumerate(mission.get("items", []), start=1):
        kind = item.get("complexItemType") if item.get("type") == "ComplexItem" else None
        if kind is None:
            latitude, longitude = item["params"][4:6]
            if latitude and longitude:
                waypoints.append((float(longitude), float(latitude)))
            continue
        found.begin_feature()
        area = item.get("polygon")
        if area:
            found.add(f"{str(kind)[:40]} {number}", "polygon", [_turned(area)])
        elif item.get("polyline"):
            found.add(f"{str(kind)[:40]} {number}", "path", [_turned(item["polyline"])])
        else:
            found.exclude(f"{str(kind)[:40]} {number}", "an item without an area")
    if waypoints:
        found.begin_feature()
        found.add("waypoints", "path", [waypoints])


def _read_rally(rally: Mapping[str, Any], found: Found) -> None:
    for number, point in enumerate(rally.get("points", []), start=1):
        found.begin_feature()
        found.add(f"rally point {number}", "point", [_turned([point])])


def _turned(points: Any) -> list[Position]:
    """Return positions that are written with the latitude first."""
    return [(float(point[1]), float(point[0])) for point in points]
